//! A look at the dictionaries that an xz file claims, before a decoder believes it: a decoder allocates what the
//! header of a block asks for, up to 4 GiB, and a file of a hundred bytes can ask.
//!
//! Format: *The .xz File Format* 1.2.1, sections 2 to 4; LZMA2 chunks as in the same project's *LZMA2* notes.

use std::io::{self, BufRead, Read};
use std::path::Path;

use super::source::bad;
use crate::error::Result;

/// What `xz -9` asks for.
const MAX_DICTIONARY_BYTES: u64 = 64 << 20;
/// Identifies LZMA2 in a list of filters (5.3.1).
const LZMA2: u64 = 0x21;
const STREAM_HEADER_BYTES: u64 = 12;
const STREAM_FOOTER_BYTES: u64 = 12;

/// Refuses a file with a block whose dictionary is larger than `xz` itself makes. Walks from chunk to chunk; what it
/// cannot follow ends the walk, as it will end the decoder.
pub(super) fn check(path: &Path, file: impl BufRead) -> Result<()> {
    let mut walk = Walk { file, read: 0 };
    let mut check_bytes = None;
    while let Ok(Some(next)) = walk.next_block(&mut check_bytes) {
        if next > MAX_DICTIONARY_BYTES {
            return Err(bad(
                path,
                format!(
                    "a block of this xz file asks for a dictionary of {next} bytes; at most {MAX_DICTIONARY_BYTES} are \
                     given"
                ),
            ));
        }
    }
    Ok(())
}

struct Walk<R> {
    file: R,
    read: u64,
}

impl<R: BufRead> Walk<R> {
    /// Passes over a block; its dictionary in bytes. `None` at the end of the file. `check_bytes` is the size of the check
    /// after each block of this stream, `None` between streams.
    fn next_block(&mut self, check_bytes: &mut Option<u64>) -> io::Result<Option<u64>> {
        loop {
            let Some(after) = *check_bytes else {
                let header: [u8; STREAM_HEADER_BYTES as usize] = self.bytes()?;
                let flags = header.get(7).copied().unwrap_or_default();
                *check_bytes = Some(check_size(flags & 0x0f));
                continue;
            };
            let start = self.read;
            let [size] = self.bytes()?;
            if size == 0 {
                self.skip_index(start)?;
                *check_bytes = None;
                if self.at_end()? {
                    return Ok(None);
                }
                continue;
            }
            let header = (u64::from(size) + 1) * 4;
            let dictionary = self.block_header()?;
            self.skip(header.saturating_sub(self.read - start))?;
            if dictionary > MAX_DICTIONARY_BYTES {
                return Ok(Some(dictionary));
            }
            while self.skip_chunk()? {}
            self.skip_padding(start)?;
            self.skip(after)?;
            return Ok(Some(dictionary));
        }
    }

    /// The dictionary that the filters of a block ask for (3.1.5).
    fn block_header(&mut self) -> io::Result<u64> {
        let [flags] = self.bytes()?;
        for present in [0x40, 0x80] {
            if flags & present != 0 {
                self.number()?;
            }
        }
        let mut dictionary = 0;
        for _ in 0..=flags & 0x03 {
            let (id, properties) = (self.number()?, self.number()?);
            if id == LZMA2 && properties == 1 {
                let [bits] = self.bytes()?;
                dictionary = dictionary.max(dictionary_bytes(bits));
            } else {
                self.skip(properties)?;
            }
        }
        Ok(dictionary)
    }

    /// False at the end of the block's chunks.
    fn skip_chunk(&mut self) -> io::Result<bool> {
        let [control] = self.bytes()?;
        let size = |bytes: [u8; 2]| u64::from(u16::from_be_bytes(bytes)) + 1;
        match control {
            0x00 => return Ok(false),
            0x01 | 0x02 => {
                let plain = size(self.bytes()?);
                self.skip(plain)?;
            }
            0x80.. => {
                self.skip(2)?;
                let packed = size(self.bytes()?);
                // New properties are a byte.
                self.skip(packed + u64::from(control >= 0xc0))?;
            }
            _ => return Err(io::ErrorKind::InvalidData.into()),
        }
        Ok(true)
    }

    fn skip_index(&mut self, start: u64) -> io::Result<()> {
        for _ in 0..self.number()? {
            self.number()?;
            self.number()?;
        }
        self.skip_padding(start)?;
        self.skip(4 + STREAM_FOOTER_BYTES)
    }

    /// To a multiple of four bytes.
    fn skip_padding(&mut self, start: u64) -> io::Result<()> {
        let over = (self.read - start) % 4;
        self.skip((4 - over) % 4)
    }

    /// Seven bits a byte, the lowest first (1.2).
    fn number(&mut self) -> io::Result<u64> {
        let mut value = 0;
        for place in 0..9 {
            let [byte] = self.bytes()?;
            value |= u64::from(byte & 0x7f) << (7 * place);
            if byte & 0x80 == 0 {
                return Ok(value);
            }
        }
        Err(io::ErrorKind::InvalidData.into())
    }

    fn bytes<const N: usize>(&mut self) -> io::Result<[u8; N]> {
        let mut bytes = [0; N];
        self.file.read_exact(&mut bytes)?;
        self.read += N as u64;
        Ok(bytes)
    }

    fn skip(&mut self, bytes: u64) -> io::Result<()> {
        let skipped = io::copy(&mut self.file.by_ref().take(bytes), &mut io::sink())?;
        self.read += skipped;
        if skipped < bytes {
            return Err(io::ErrorKind::UnexpectedEof.into());
        }
        Ok(())
    }

    /// Whether nothing but padding of streams is left; what is, is passed over.
    fn at_end(&mut self) -> io::Result<bool> {
        loop {
            let buffer = self.file.fill_buf()?;
            if buffer.is_empty() {
                return Ok(true);
            }
            let zeros = buffer.iter().take_while(|&&byte| byte == 0).count();
            let more = zeros < buffer.len();
            self.file.consume(zeros);
            self.read += zeros as u64;
            if more {
                return Ok(false);
            }
        }
    }
}

/// Bytes of a check (2.1.1.2).
fn check_size(kind: u8) -> u64 {
    match kind {
        0 => 0,
        1..=3 => 4,
        4..=6 => 8,
        7..=9 => 16,
        10..=12 => 32,
        _ => 64,
    }
}

/// Coded in six bits: powers of two and one and a half times those (5.3.1).
fn dictionary_bytes(bits: u8) -> u64 {
    let bits = u64::from(bits & 0x3f);
    (2 | (bits & 1)) << (bits / 2 + 11).min(40)
}
