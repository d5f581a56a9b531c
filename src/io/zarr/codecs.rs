//! Codecs of chunks. Whatever a chunk unpacks to, no more is kept than its shape allows.
//!
//! The `zarrs` crate is not used: its gzip and Zstandard codecs unpack without a bound.

use std::io::{self, ErrorKind, Read};
use std::path::Path;

use bzip2::bufread::MultiBzDecoder;
use flate2::bufread::{MultiGzDecoder, ZlibDecoder};
use serde_json::Value;

use super::metadata::{Named, numbers};
use crate::error::Result;
use crate::io::source::bad;
use crate::io::{blosc, text};
use crate::scene::Endian;

/// What turns a chunk's bytes into elements.
pub(super) struct Codecs {
    /// For each axis as stored, slowest first, the axis of the array.
    pub(super) order: Vec<usize>,
    pub(super) endian: Endian,
    /// In the order of writing.
    pack: Vec<Pack>,
    /// Chunks inside the chunk, in place of elements.
    pub(super) shard: Option<Box<Shard>>,
}

/// The `sharding_indexed` codec.
pub(super) struct Shard {
    pub(super) chunk: Vec<u64>,
    pub(super) codecs: Codecs,
    pub(super) index: Codecs,
    pub(super) index_at_start: bool,
}

#[derive(Clone, Copy, PartialEq)]
enum Pack {
    Blosc,
    Gzip,
    Zlib,
    Bzip2,
    Zstd,
    /// One block after its length, as `numcodecs` writes it.
    Lz4,
    Crc32c,
}

const PACKS: &[(&str, Pack)] = &[
    ("blosc", Pack::Blosc),
    ("gzip", Pack::Gzip),
    ("zstd", Pack::Zstd),
    ("zlib", Pack::Zlib),
    ("bz2", Pack::Bzip2),
    ("lz4", Pack::Lz4),
    ("crc32c", Pack::Crc32c),
    ("numcodecs.zlib", Pack::Zlib),
    ("numcodecs.bz2", Pack::Bzip2),
    ("numcodecs.lz4", Pack::Lz4),
];

/// Bytes of a CRC-32C at the end.
const CRC_BYTES: usize = 4;

impl Codecs {
    pub(super) fn version2(
        path: &Path,
        compressor: &Value,
        first_fastest: bool,
        axes: usize,
        endian: Endian,
    ) -> Result<Self> {
        let mut order: Vec<usize> = (0..axes).collect();
        if first_fastest {
            order.reverse();
        }
        let pack = match compressor.get("id").and_then(Value::as_str) {
            Some(name) => vec![text::one_of(path, "compressor", name, PACKS)?],
            None if compressor.is_null() => Vec::new(),
            None => return Err(bad(path, format!("compressor {compressor} has no id"))),
        };
        Ok(Self {
            order,
            endian,
            pack,
            shard: None,
        })
    }

    pub(super) fn version3(path: &Path, chain: &[Named], axes: usize) -> Result<Self> {
        Self::chain(path, chain, axes, true)
    }

    fn chain(path: &Path, chain: &[Named], axes: usize, may_shard: bool) -> Result<Self> {
        let mut codecs = Self {
            order: (0..axes).collect(),
            endian: Endian::Little,
            pack: Vec::new(),
            shard: None,
        };
        let refuse = |what: &str| Err(bad(path, format!("codecs: {what}")));
        let mut to_bytes = false;
        for codec in chain {
            match codec.name.as_str() {
                "transpose" if !to_bytes => {
                    let order = numbers(&codec.configuration, "order");
                    let order: Vec<usize> = order.iter().map(|&axis| axis as usize).collect();
                    let mut sorted = order.clone();
                    sorted.sort_unstable();
                    if codecs.order != sorted {
                        return refuse("one transpose, of all axes, is read");
                    }
                    codecs.order = order;
                }
                "bytes" if !to_bytes => {
                    let endian = codec.configuration.get("endian").and_then(Value::as_str);
                    let orders = [("little", Endian::Little), ("big", Endian::Big)];
                    let endian = endian.unwrap_or("little");
                    codecs.endian = text::one_of(path, "codecs: endian", endian, &orders)?;
                    to_bytes = true;
                }
                "sharding_indexed" if !to_bytes && may_shard => {
                    codecs.shard = Some(Box::new(Shard::new(path, &codec.configuration, axes)?));
                    to_bytes = true;
                }
                name if to_bytes => {
                    codecs.pack.push(text::one_of(path, "codecs", name, PACKS)?);
                }
                name => return refuse(&format!("{name:?} is not read here")),
            }
        }
        let compressors = codecs.pack.iter().filter(|&&pack| pack != Pack::Crc32c);
        if !to_bytes || compressors.count() > 1 || codecs.shard.is_some() && !codecs.pack.is_empty()
        {
            return refuse("bytes and one compressor, or sharding_indexed alone, are read");
        }
        Ok(codecs)
    }

    /// Elements, as stored, from what lies under a chunk's key. `len` bytes are needed.
    pub(super) fn unpack(&self, packed: &[u8], len: usize) -> io::Result<Vec<u8>> {
        let mut bytes = packed.to_vec();
        for (i, pack) in self.pack.iter().enumerate().rev() {
            // Before the compressor, every step has a length that is known.
            let checks = self.pack.iter().take(i).filter(|&&p| p == Pack::Crc32c);
            let len = len + CRC_BYTES * checks.count();
            bytes = pack.unpack(bytes, len)?;
        }
        if bytes.len() == len {
            return Ok(bytes);
        }
        Err(invalid(format!(
            "a chunk has {} bytes where {len} are needed",
            bytes.len()
        )))
    }
}

impl Shard {
    fn new(path: &Path, configuration: &Value, axes: usize) -> Result<Self> {
        let chain = |key: &str, axes| -> Result<Codecs> {
            let list = configuration.get(key).cloned().unwrap_or_default();
            let list: Vec<Named> = serde_json::from_value(list)
                .map_err(|e| bad(path, format!("codecs: {key}: {e}")))?;
            Codecs::chain(path, &list, axes, false)
        };
        let location = configuration.get("index_location").and_then(Value::as_str);
        let locations = [("start", true), ("end", false)];
        let location = location.unwrap_or("end");
        let index = chain("index_codecs", axes + 1)?;
        if index.pack.iter().any(|&pack| pack != Pack::Crc32c) {
            return Err(bad(path, "codecs: a compressed index is not read".into()));
        }
        Ok(Self {
            chunk: numbers(configuration, "chunk_shape"),
            codecs: chain("codecs", axes)?,
            index,
            index_at_start: text::one_of(path, "index_location", location, &locations)?,
        })
    }

    /// Bytes of an index of `count` chunks, as stored.
    pub(super) fn index_bytes(&self, count: usize) -> Option<usize> {
        let entries = count.checked_mul(16)?;
        entries.checked_add(CRC_BYTES * self.index.pack.len())
    }
}

impl Pack {
    fn unpack(self, bytes: Vec<u8>, len: usize) -> io::Result<Vec<u8>> {
        match self {
            Self::Blosc => blosc::decompress(&bytes, len),
            Self::Gzip => exactly(MultiGzDecoder::new(&bytes[..]), len),
            Self::Zlib => exactly(ZlibDecoder::new(&bytes[..]), len),
            Self::Bzip2 => exactly(MultiBzDecoder::new(&bytes[..]), len),
            Self::Zstd => exactly(blosc::zstd_reader(&bytes)?, len),
            Self::Lz4 => {
                let (claim, block) = bytes
                    .split_first_chunk()
                    .ok_or_else(|| invalid("a chunk is cut short"))?;
                if u32::from_le_bytes(*claim) as usize != len {
                    return Err(invalid("a chunk claims another length than its shape has"));
                }
                let mut out = vec![0; len];
                blosc::lz4(block, &mut out).map(|()| out)
            }
            Self::Crc32c => {
                let (data, check) = bytes
                    .split_last_chunk()
                    .ok_or_else(|| invalid("a chunk is cut short"))?;
                if crc32c::crc32c(data) != u32::from_le_bytes(*check) {
                    return Err(invalid("a chunk's CRC-32C is wrong"));
                }
                Ok(data.to_vec())
            }
        }
    }
}

/// All that a decoder gives, which must be `len` bytes.
fn exactly(mut decoder: impl Read, len: usize) -> io::Result<Vec<u8>> {
    let mut out = Vec::new();
    decoder
        .by_ref()
        .take(len as u64 + 1)
        .read_to_end(&mut out)?;
    if out.len() == len {
        return Ok(out);
    }
    Err(invalid(format!(
        "a chunk unpacks to {} {} bytes",
        if out.len() > len {
            "more than"
        } else {
            "fewer than"
        },
        len
    )))
}

fn invalid(message: impl Into<String>) -> io::Error {
    io::Error::new(ErrorKind::InvalidData, message.into())
}
