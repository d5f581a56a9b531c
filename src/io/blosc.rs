//! Blosc buffers: blocks of shuffled bytes, each compressed on its own.
//!
//! Format: F. Alted, *Blosc chunk format* (version 1), <https://github.com/Blosc/c-blosc>, `README_CHUNK_FORMAT.rst`.
//! The C library is not used: it is compiled with all its codecs, one of them C++.

use std::io::{self, ErrorKind, Read};

use flate2::read::ZlibDecoder;

/// Bytes of the header.
const HEADER_BYTES: usize = 16;
const VERSION: u8 = 2;

const SHUFFLED: u8 = 0x01;
const COPIED: u8 = 0x02;
const BIT_SHUFFLED: u8 = 0x04;
const NOT_SPLIT: u8 = 0x10;

/// A block is split into one stream for each byte of its type, unless that has more bytes than this, or the streams
/// would be shorter than [`MIN_STREAM_BYTES`].
const MAX_SPLIT_TYPE: usize = 16;
const MIN_STREAM_BYTES: usize = 128;

struct Header {
    flags: u8,
    type_bytes: usize,
    block_bytes: usize,
}

/// Decompresses a buffer that must hold exactly `len` bytes.
///
/// # Errors
/// `InvalidData` for damage, another length, and codecs that are not read (BloscLZ, Snappy, Blosc 2).
pub(super) fn decompress(buffer: &[u8], len: usize) -> io::Result<Vec<u8>> {
    let &[version, _, flags, type_bytes, ref sizes @ ..] = buffer
        .first_chunk::<HEADER_BYTES>()
        .ok_or_else(|| bad("a Blosc buffer is shorter than its header"))?;
    let size = |i: usize| word(sizes, 4 * i).unwrap_or_default() as usize;
    if version > VERSION || flags & (SHUFFLED | BIT_SHUFFLED) == SHUFFLED | BIT_SHUFFLED {
        return Err(bad("a Blosc 2 buffer; those of Blosc 1 are read"));
    }
    if size(0) != len {
        return Err(bad(format!(
            "a Blosc buffer claims {} bytes where {len} are needed",
            size(0)
        )));
    }
    if flags & COPIED != 0 {
        return buffer
            .get(HEADER_BYTES..HEADER_BYTES + len)
            .map(<[u8]>::to_vec)
            .ok_or_else(cut_short);
    }
    let header = Header {
        flags,
        type_bytes: usize::from(type_bytes.max(1)),
        block_bytes: size(1),
    };
    if len > 0 && !(1..=len).contains(&header.block_bytes) {
        return Err(bad("a Blosc buffer has blocks longer than itself"));
    }
    let blocks = len.div_ceil(header.block_bytes.max(1));
    if buffer.len() < HEADER_BYTES + 4 * blocks {
        return Err(cut_short());
    }
    let mut out = Vec::new();
    out.try_reserve_exact(len)?;
    for block in 0..blocks {
        let bytes = header.block_bytes.min(len - out.len());
        let start = word(buffer, HEADER_BYTES + 4 * block).ok_or_else(cut_short)?;
        let streams = buffer.get(start as usize..).ok_or_else(cut_short)?;
        out.extend(header.block(streams, bytes)?);
    }
    Ok(out)
}

impl Header {
    fn block(&self, mut streams: &[u8], bytes: usize) -> io::Result<Vec<u8>> {
        let split = self.flags & NOT_SPLIT == 0
            && self.type_bytes <= MAX_SPLIT_TYPE
            && bytes == self.block_bytes
            && bytes / self.type_bytes >= MIN_STREAM_BYTES;
        let parts = if split { self.type_bytes } else { 1 };
        let mut shuffled = vec![0; bytes];
        for part in shuffled.chunks_mut((bytes / parts).max(1)) {
            let packed_bytes = word(streams, 0).ok_or_else(cut_short)? as usize;
            let packed = streams
                .get(4..)
                .and_then(|s| s.get(..packed_bytes))
                .ok_or_else(cut_short)?;
            self.stream(packed, part)?;
            streams = streams.get(4 + packed_bytes..).unwrap_or_default();
        }
        Ok(if self.flags & SHUFFLED != 0 {
            unshuffled(&shuffled, self.type_bytes)
        } else if self.flags & BIT_SHUFFLED != 0 {
            bit_unshuffled(shuffled, self.type_bytes)
        } else {
            shuffled
        })
    }

    fn stream(&self, packed: &[u8], out: &mut [u8]) -> io::Result<()> {
        if packed.len() == out.len() {
            out.copy_from_slice(packed);
            return Ok(());
        }
        match self.flags >> 5 {
            1 => lz4(packed, out),
            3 => ZlibDecoder::new(packed).read_exact(out),
            4 => zstd(packed, out),
            codec => Err(bad(format!(
                "Blosc codec {} is not read; LZ4, Zlib and Zstandard are",
                match codec {
                    0 => "BloscLZ",
                    2 => "Snappy",
                    _ => "of an unknown number",
                }
            ))),
        }
    }
}

/// An LZ4 block (not frame) that holds exactly as many bytes as `out`.
pub(super) fn lz4(packed: &[u8], out: &mut [u8]) -> io::Result<()> {
    match lz4_flex::block::decompress_into(packed, out) {
        Ok(got) if got == out.len() => Ok(()),
        Ok(_) => Err(cut_short()),
        Err(e) => Err(bad(format!("LZ4: {e}"))),
    }
}

/// One Zstandard frame (RFC 8878); what it holds after `out` is full is not looked at.
fn zstd(packed: &[u8], out: &mut [u8]) -> io::Result<()> {
    zstd_reader(packed)?.read_exact(out)
}

/// Reads one Zstandard frame (RFC 8878).
pub(super) fn zstd_reader<'a>(packed: &'a [u8]) -> io::Result<impl Read + use<'a>> {
    ruzstd::decoding::StreamingDecoder::new(packed)
        .map(Zstandard)
        .map_err(|e| bad(format!("Zstandard: {e}")))
}

/// The decoder calls damage [`io::ErrorKind::Other`].
struct Zstandard<R>(R);

impl<R: Read> Read for Zstandard<R> {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        let Self(decoder) = self;
        decoder
            .read(out)
            .map_err(|e| bad(format!("Zstandard: {e}")))
    }
}

/// Puts bytes that lie by their place in the element back beside each other.
fn unshuffled(bytes: &[u8], type_bytes: usize) -> Vec<u8> {
    let count = bytes.len() / type_bytes;
    let mut out = bytes.to_vec();
    for (place, plane) in bytes
        .chunks_exact(count.max(1))
        .take(type_bytes)
        .enumerate()
    {
        for (to, &from) in out.iter_mut().skip(place).step_by(type_bytes).zip(plane) {
            *to = from;
        }
    }
    out
}

/// The same of bits: plane after plane of one bit of every element. Counts that are no multiple of 8 stay as they are.
fn bit_unshuffled(bytes: Vec<u8>, type_bytes: usize) -> Vec<u8> {
    let count = bytes.len() / type_bytes;
    if !count.is_multiple_of(8) || count == 0 {
        return bytes;
    }
    let mut out = bytes.clone();
    let shuffled = count * type_bytes;
    if let Some(out) = out.get_mut(..shuffled) {
        out.fill(0);
    }
    for (plane, row) in bytes
        .chunks_exact(count / 8)
        .take(8 * type_bytes)
        .enumerate()
    {
        let (place, bit) = (plane / 8, plane % 8);
        let elements = out.iter_mut().skip(place).step_by(type_bytes);
        for (i, to) in elements.take(count).enumerate() {
            let from = row.get(i / 8).copied().unwrap_or_default();
            *to |= (from >> (i % 8) & 1) << bit;
        }
    }
    out
}

fn word(bytes: &[u8], at: usize) -> Option<u32> {
    let bytes = bytes.get(at..)?.first_chunk()?;
    Some(u32::from_le_bytes(*bytes))
}

fn bad(message: impl Into<String>) -> io::Error {
    io::Error::new(ErrorKind::InvalidData, message.into())
}

fn cut_short() -> io::Error {
    bad("compressed data is cut short or damaged")
}
