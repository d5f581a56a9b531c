//! The bytes of an array.

use std::io::Read;
use std::path::Path;

use flate2::read::ZlibDecoder;

use super::find;
use super::markup::Element as Tag;
use crate::error::{Error, Result};
use crate::io::payload::{Coding, MAX_DEFLATE_RATIO, reserve};
use crate::io::source::{bad, read_error};
use crate::io::text;
use crate::scene::Endian;

/// How lengths before data are stored.
#[derive(Clone, Copy)]
struct Lengths {
    bytes: usize,
    endian: Endian,
}

impl Lengths {
    /// The length at place `i` of a list.
    fn get(self, list: &[u8], i: usize) -> Option<usize> {
        let at = list.get(i.checked_mul(self.bytes)?..)?.get(..self.bytes)?;
        let fold = |value: u64, &byte: &u8| value << 8 | u64::from(byte);
        let value = match self.endian {
            Endian::Little => at.iter().rev().fold(0, fold),
            Endian::Big => at.iter().fold(0, fold),
        };
        usize::try_from(value).ok()
    }
}

/// The bytes of an array that decode to `wanted` bytes, and how they are coded.
pub(super) fn array(
    path: &Path,
    file: &Tag<'_>,
    array: &Tag<'_>,
    appended: &[u8],
    wanted: u64,
    endian: Endian,
) -> Result<(Vec<u8>, Coding)> {
    let cut = || {
        bad(
            path,
            "the data are cut short, or their lengths are wrong".into(),
        )
    };
    let format = array.attribute("format").unwrap_or("ascii");
    if format == "ascii" {
        return Ok((
            array.inside().ok_or_else(cut)?.as_bytes().to_vec(),
            Coding::Ascii,
        ));
    }
    let lengths = Lengths {
        bytes: match file.attribute("header_type") {
            Some(kind) => text::one_of(path, "header_type", kind, &[("UInt32", 4), ("UInt64", 8)])?,
            None => 4,
        },
        endian,
    };
    let compressed = match file.attribute("compressor") {
        None | Some("") => false,
        Some(name) => text::one_of(path, "compressor", name, &[("vtkZLibDataCompressor", true)])?,
    };
    let (encoded, raw) = match format {
        "binary" => (array.inside().ok_or_else(cut)?.trim().as_bytes(), false),
        "appended" => {
            let offset = array.attribute("offset").unwrap_or("0");
            let offset: usize = offset
                .parse()
                .map_err(|_| bad(path, format!("offset {offset:?} is not a number of bytes")))?;
            let tag_end = find(appended, b">").ok_or_else(cut)?;
            let tag = String::from_utf8_lossy(appended.get(..tag_end).unwrap_or_default());
            let raw = tag.contains("\"raw\"") || tag.contains("'raw'");
            let after = appended.get(tag_end..).unwrap_or_default();
            let start = find(after, b"_").ok_or_else(cut)?;
            let data = after.get(start.saturating_add(1).saturating_add(offset)..);
            (data.ok_or_else(cut)?, raw)
        }
        other => {
            return Err(bad(
                path,
                format!("format {other:?} is not read; valid are ascii, binary, appended"),
            ));
        }
    };
    let bytes = if compressed {
        inflated(path, encoded, raw, lengths, wanted)?
    } else {
        let decoded;
        let all = if raw {
            encoded
        } else {
            decoded = base64(encoded);
            &decoded
        };
        let length = lengths.get(all, 0).ok_or_else(cut)?;
        let data = all.get(lengths.bytes..).unwrap_or_default();
        data.get(..length).ok_or_else(cut)?.to_vec()
    };
    Ok((bytes, Coding::Raw))
}

/// Blocks that are compressed each on its own: their number, their size, the size of the last, the compressed sizes.
fn inflated(
    path: &Path,
    encoded: &[u8],
    raw: bool,
    lengths: Lengths,
    wanted: u64,
) -> Result<Vec<u8>> {
    let cut = || {
        bad(
            path,
            "the compressed data are cut short, or their lengths are wrong".into(),
        )
    };
    let blocks = if raw {
        lengths.get(encoded, 0)
    } else {
        lengths.get(
            &base64(
                encoded
                    .get(..lengths.bytes.div_ceil(3) * 4)
                    .unwrap_or_default(),
            ),
            0,
        )
    }
    .ok_or_else(cut)?;
    let table_bytes = blocks
        .checked_add(3)
        .and_then(|n| n.checked_mul(lengths.bytes))
        .filter(|&n| n <= encoded.len())
        .ok_or_else(cut)?;
    let (table, data) = if raw {
        let (table, data) = encoded.split_at_checked(table_bytes).ok_or_else(cut)?;
        (table.to_vec(), data.to_vec())
    } else {
        // The table and the blocks are encoded one after the other.
        let end = table_bytes.div_ceil(3) * 4;
        let (table, data) = encoded.split_at_checked(end).ok_or_else(cut)?;
        (base64(table), base64(data))
    };
    if wanted / MAX_DEFLATE_RATIO > data.len() as u64 {
        return Err(cut());
    }
    let mut bytes = reserve(usize::try_from(wanted).map_err(|_| cut())?)?;
    let mut rest = data.as_slice();
    for block in 0..blocks {
        let length = lengths.get(&table, 3 + block).ok_or_else(cut)?;
        let (packed, after) = rest.split_at_checked(length).ok_or_else(cut)?;
        rest = after;
        let left = wanted - bytes.len() as u64;
        ZlibDecoder::new(packed)
            .take(left)
            .read_to_end(&mut bytes)
            .map_err(|e| read_error(path, e))?;
    }
    if (bytes.len() as u64) < wanted {
        return Err(Error::volume(
            path,
            format!("the blocks hold {} bytes of {wanted}", bytes.len()),
        ));
    }
    Ok(bytes)
}

/// Bytes of base64 text (RFC 4648, 4), up to the first character that is none of its alphabet but space.
fn base64(text: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3);
    let (mut bits, mut held) = (0u32, 0);
    for &c in text {
        let digit = match c {
            b'A'..=b'Z' => c - b'A',
            b'a'..=b'z' => c - b'a' + 26,
            b'0'..=b'9' => c - b'0' + 52,
            b'+' => 62,
            b'/' => 63,
            _ if c.is_ascii_whitespace() => continue,
            _ => break,
        };
        bits = bits << 6 | u32::from(digit);
        held += 6;
        if held >= 8 {
            held -= 8;
            bytes.push((bits >> held) as u8);
        }
    }
    bytes
}
