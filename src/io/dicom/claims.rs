//! A look at what a DICOM object claims, before a parser believes it: the parser allocates the length of a value
//! before it reads it, and recurses into sequences.

use std::io::{self, Read};
use std::path::Path;

use dicom_encoding::TransferSyntaxIndex;
use dicom_object::FileMetaTable;
use dicom_parser::dataset::{DataSetReader, DataToken};
use dicom_transfer_syntax_registry::TransferSyntaxRegistry;
use flate2::read::DeflateDecoder;

use super::super::bundle::Member;
use super::super::payload::MAX_DEFLATE_RATIO;
use super::super::source::{bad, read_error};
use super::PREAMBLE;
use super::frame::{PIXEL_DATA, chain};
use super::prefix;
use crate::error::Result;

/// Sequences inside sequences. Structured reports, the deepest objects there are, stay below 20.
const MAX_DEPTH: usize = 64;
/// Deflated Explicit VR Little Endian (PS3.5, A.5).
const DEFLATED: &str = "1.2.840.10008.1.2.1.99";
/// More than any file meta group takes.
const MAX_META_BYTES: usize = 1 << 16;
/// Value representations whose length has 16 bits (PS3.5, 7.1.2); that of others, unknown ones too, has 32.
const SHORT_LENGTHS: [&[u8; 2]; 21] = [
    b"AE", b"AS", b"AT", b"CS", b"DA", b"DS", b"DT", b"FD", b"FL", b"IS", b"LO", b"LT", b"PN",
    b"SH", b"SL", b"SS", b"ST", b"TM", b"UI", b"UL", b"US",
];

/// How far to look.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Until {
    /// To the pixels, without them.
    Pixels,
    /// To the end of the pixels.
    PixelsEnd,
}

/// Refuses an object that claims a value longer than the file, that nests too deep, or that is of an unknown
/// transfer syntax.
pub(super) fn check(path: &Path, member: &Member, until: Until) -> Result<()> {
    let damaged = |what: String| bad(path, format!("the DICOM object is damaged: {what}"));
    let len = member.len();
    let mut head = Vec::new();
    let mut start = prefix::open(member)?.take(MAX_META_BYTES as u64);
    start
        .read_to_end(&mut head)
        .map_err(|e| read_error(path, e))?;
    check_meta(&head, len).map_err(damaged)?;

    let mut stream = prefix::open(member)?;
    let preamble = PREAMBLE.0 as u64;
    io::copy(&mut stream.by_ref().take(preamble), &mut io::sink())
        .map_err(|e| read_error(path, e))?;
    let meta = FileMetaTable::from_reader(&mut stream).map_err(|e| damaged(chain(&e)))?;
    let uid = meta.transfer_syntax();
    let Some(syntax) = TransferSyntaxRegistry.get(uid) else {
        let uid = super::quoted(uid);
        return Err(bad(path, format!("transfer syntax {uid:?} is unknown")));
    };
    let (stream, longest): (Box<dyn Read + '_>, u64) = if uid == DEFLATED {
        let longest = len.saturating_mul(MAX_DEFLATE_RATIO);
        (Box::new(DeflateDecoder::new(stream)), longest)
    } else {
        (stream, len)
    };
    let tokens = DataSetReader::new_with_ts(stream, syntax).map_err(|e| damaged(chain(&e)))?;
    check_tokens(tokens, longest, until).map_err(damaged)
}

/// Tokens come before the values that they announce are read. What the parser cannot read ends the look: it comes no
/// further the next time, and says where it is.
fn check_tokens<E>(
    tokens: impl Iterator<Item = Result<DataToken, E>>,
    longest: u64,
    until: Until,
) -> Result<(), String> {
    let mut depth = 0usize;
    let mut in_pixels = false;
    for token in tokens.map_while(Result::ok) {
        let claimed = match &token {
            DataToken::ElementHeader(header) => header.len.get(),
            DataToken::ItemStart { len } if in_pixels => len.get(),
            _ => None,
        };
        if let Some(claimed) = claimed
            && u64::from(claimed) > longest
        {
            return Err(format!(
                "a value claims {claimed} bytes, the file has at most {longest}"
            ));
        }
        match token {
            DataToken::ElementHeader(header) if depth == 0 && header.tag >= PIXEL_DATA => break,
            DataToken::PixelSequenceStart if until == Until::Pixels => break,
            DataToken::PixelSequenceStart => in_pixels = true,
            DataToken::SequenceStart { .. } => depth += 1,
            DataToken::SequenceEnd if in_pixels => break,
            DataToken::SequenceEnd => depth = depth.saturating_sub(1),
            _ => {}
        }
        if depth > MAX_DEPTH {
            return Err(format!("sequences nest deeper than {MAX_DEPTH}"));
        }
    }
    Ok(())
}

/// The group before the data set, always explicit and little endian (PS3.10, 7.1).
fn check_meta(head: &[u8], file_len: u64) -> Result<(), String> {
    let start = PREAMBLE.0 + PREAMBLE.1.len();
    let mut rest = head.get(start..).unwrap_or_default();
    while let Some((&[2, 0, _, _, vr0, vr1, l0, l1], after)) = rest.split_first_chunk::<8>() {
        let (length, after) = if SHORT_LENGTHS.contains(&&[vr0, vr1]) {
            (u16::from_le_bytes([l0, l1]).into(), after)
        } else {
            let Some((length, after)) = after.split_first_chunk::<4>() else {
                break;
            };
            (u32::from_le_bytes(*length), after)
        };
        if u64::from(length) > file_len {
            return Err(format!(
                "a value of the file meta group claims {length} bytes, the file has {file_len}"
            ));
        }
        rest = after.get(length as usize..).unwrap_or_default();
    }
    Ok(())
}
