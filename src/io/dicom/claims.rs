//! A look at what a DICOM object claims, before a parser believes it: the parser allocates the length of a value
//! before it reads it, and recurses into sequences. The look finds the pixels as well.

use std::io::{self, Cursor, Read, Seek};
use std::path::Path;

use dicom_encoding::TransferSyntaxIndex;
use dicom_encoding::transfer_syntax::TransferSyntax;
use dicom_object::FileMetaTable;
use dicom_parser::StatefulDecode;
use dicom_parser::dataset::LazyDataToken;
use dicom_parser::dataset::lazy_read::LazyDataSetReader;
use dicom_transfer_syntax_registry::TransferSyntaxRegistry;
use flate2::read::DeflateDecoder;

use super::super::Limits;
use super::super::source::{bad, read_error};
use super::PREAMBLE;
use super::frame::{PIXEL_DATA, chain};
use super::prefix::Start;
use crate::error::Result;

/// Sequences inside sequences. Structured reports, the deepest objects there are, stay below 20.
const MAX_DEPTH: usize = 64;
/// Deflated Explicit VR Little Endian (PS3.5, A.5).
const DEFLATED: &str = "1.2.840.10008.1.2.1.99";
/// Transfer syntaxes of pixels as they are (PS3.5, A.1 to A.3), and whether bytes are swapped.
const NATIVE: [(&str, bool); 3] = [
    ("1.2.840.10008.1.2", false),
    ("1.2.840.10008.1.2.1", false),
    ("1.2.840.10008.1.2.2", true),
];
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

/// Where uncompressed pixels lie in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct NativePixels {
    /// Of the first pixel, from the start of the file.
    pub(super) offset: u64,
    /// As claimed, and not more than the file has.
    pub(super) bytes: u64,
    pub(super) big_endian: bool,
}

/// Refuses an object that claims a value longer than the file, that nests too deep, or that is of an unknown
/// transfer syntax. Finds the pixels, where they are neither coded nor deflated.
pub(super) fn check(
    path: &Path,
    file: &Start<'_>,
    until: Until,
    limits: &Limits,
) -> Result<Option<NativePixels>> {
    let damaged = |what: String| bad(path, format!("the DICOM object is damaged: {what}"));
    let len = file.member().len();
    let mut head = Vec::new();
    let mut start = file.stream().take(MAX_META_BYTES as u64);
    start
        .read_to_end(&mut head)
        .map_err(|e| read_error(path, e))?;
    check_meta(&head, len).map_err(damaged)?;

    let mut stream = file.stream();
    let missing = stream.missing();
    let preamble = PREAMBLE.0 as u64;
    io::copy(&mut stream.by_ref().take(preamble), &mut io::sink())
        .map_err(|e| read_error(path, e))?;
    let meta = FileMetaTable::from_reader(&mut stream).map_err(|e| damaged(chain(&e)))?;
    let uid = meta.transfer_syntax();
    let Some(syntax) = TransferSyntaxRegistry.get(uid) else {
        let uid = super::quoted(uid);
        return Err(bad(path, format!("transfer syntax {uid:?} is unknown")));
    };
    let mut look = Look {
        longest: len,
        until,
        pixels: None,
    };
    if uid == DEFLATED {
        let inflated = inflate(path, stream, limits)?;
        look.longest = inflated.len() as u64;
        look.through(Cursor::new(inflated), syntax)
            .map_err(damaged)?;
        return Ok(None);
    }
    look.through(stream, syntax).map_err(damaged)?;
    let endian = NATIVE.iter().find(|(native, _)| *native == uid);
    Ok(look
        .pixels
        .zip(endian)
        .map(|((position, bytes), &(_, big_endian))| {
            let offset = position.saturating_sub(missing);
            NativePixels {
                offset,
                bytes: bytes.min(len.saturating_sub(offset)),
                big_endian,
            }
        }))
}

fn inflate(path: &Path, deflated: impl Read, limits: &Limits) -> Result<Vec<u8>> {
    let mut inflated = Vec::new();
    let most = limits.max_bytes.min(limits.max_archive_bytes);
    // What is cut short is looked at as far as it goes; the parser says what is missing.
    let _ = DeflateDecoder::new(deflated)
        .take(most.saturating_add(1))
        .read_to_end(&mut inflated);
    if inflated.len() as u64 > most {
        return Err(bad(
            path,
            format!("the deflated data set has more than {most} bytes, the limit"),
        ));
    }
    Ok(inflated)
}

/// A walk from value to value.
struct Look {
    longest: u64,
    until: Until,
    /// Where the value of `PixelData` begins, and its length.
    pixels: Option<(u64, u64)>,
}

impl Look {
    /// Skips every value unread. What the parser cannot read ends the look: it comes no further the next time, and says
    /// where it is.
    fn through(&mut self, data: impl Read + Seek, syntax: &TransferSyntax) -> Result<(), String> {
        let mut tokens = LazyDataSetReader::new_with_ts(data, syntax).map_err(|e| chain(&e))?;
        // Sequences and items that have begun and not ended.
        let mut open = 0usize;
        while let Some(Ok(token)) = tokens.advance() {
            match &token {
                LazyDataToken::ElementHeader(header) => {
                    self.check_claim(header.len.get())?;
                    if open == 0 && self.until == Until::PixelsEnd && header.tag > PIXEL_DATA {
                        break;
                    }
                }
                LazyDataToken::LazyValue { header, decoder } if open == 0 => {
                    if header.tag == PIXEL_DATA {
                        self.pixels = Some((decoder.position(), header.len.0.into()));
                    }
                    if self.until == Until::Pixels && header.tag >= PIXEL_DATA {
                        break;
                    }
                }
                LazyDataToken::LazyItemValue { len, .. } => self.check_claim(Some(*len))?,
                LazyDataToken::PixelSequenceStart if open == 0 && self.until == Until::Pixels => {
                    break;
                }
                LazyDataToken::SequenceStart { .. }
                | LazyDataToken::PixelSequenceStart
                | LazyDataToken::ItemStart { .. } => open += 1,
                // The parser takes it for granted that what ends has begun.
                LazyDataToken::ItemEnd if open <= 1 => {
                    return Err("an item ends outside of every sequence".into());
                }
                LazyDataToken::ItemEnd | LazyDataToken::SequenceEnd => {
                    open = open.saturating_sub(1);
                }
                _ => {}
            }
            // A sequence and its item.
            if open > 2 * MAX_DEPTH {
                return Err(format!("sequences nest deeper than {MAX_DEPTH}"));
            }
            if token.skip().is_err() {
                break;
            }
        }
        Ok(())
    }

    fn check_claim(&self, length: Option<u32>) -> Result<(), String> {
        match length.map(u64::from) {
            Some(claimed) if claimed > self.longest => Err(format!(
                "a value claims {claimed} bytes, the file has at most {}",
                self.longest
            )),
            _ => Ok(()),
        }
    }
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
