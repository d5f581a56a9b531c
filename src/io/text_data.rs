//! Voxels written as text, turned into bytes.

use std::io::{self, BufRead, ErrorKind, Read};

use super::element::Element;

/// Longer than any number.
const MAX_TOKEN_BYTES: usize = 64;

/// Numbers separated by white space or commas, as bytes of a type in the machine's order.
pub(super) struct AsciiDecoder<R> {
    text: R,
    element: Element,
    /// Bytes of the last number, and how many of them are handed out.
    value: Vec<u8>,
    given: usize,
}

impl<R: BufRead> AsciiDecoder<R> {
    pub(super) fn new(text: R, element: Element) -> Self {
        Self {
            text,
            element,
            value: Vec::new(),
            given: 0,
        }
    }

    /// The next word; empty at the end.
    fn token(&mut self) -> io::Result<String> {
        let mut token = Vec::new();
        while let Some(&byte) = self.text.fill_buf()?.first() {
            self.text.consume(1);
            let separates = byte.is_ascii_whitespace() || byte == b',';
            if separates && !token.is_empty() {
                break;
            }
            if !separates {
                token.push(byte);
            }
            if token.len() > MAX_TOKEN_BYTES {
                break;
            }
        }
        Ok(String::from_utf8_lossy(&token).into_owned())
    }
}

impl<R: BufRead> Read for AsciiDecoder<R> {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        if self.given == self.value.len() {
            let token = self.token()?;
            if token.is_empty() {
                return Ok(0);
            }
            self.value = bytes_of(&token, self.element).ok_or_else(|| {
                io::Error::new(
                    ErrorKind::InvalidData,
                    format!("{token:?} is not a number of type {}", self.element),
                )
            })?;
            self.given = 0;
        }
        let mut pending = self.value.get(self.given..).unwrap_or_default();
        let got = pending.read(out)?;
        self.given += got;
        Ok(got)
    }
}

/// A number's bytes in the machine's order.
pub(super) fn bytes_of(token: &str, element: Element) -> Option<Vec<u8>> {
    macro_rules! parse {
        ($t:ty) => {
            token.parse::<$t>().ok()?.to_ne_bytes().to_vec()
        };
    }
    Some(match element {
        Element::U8 => parse!(u8),
        Element::I8 => parse!(i8),
        Element::U16 => parse!(u16),
        Element::I16 => parse!(i16),
        Element::U32 => parse!(u32),
        Element::I32 => parse!(i32),
        Element::U64 => parse!(u64),
        Element::I64 => parse!(i64),
        Element::F16 => parse!(half::f16),
        Element::F32 => parse!(f32),
        Element::F64 => parse!(f64),
    })
}

/// Hexadecimal digits, two per byte; white space between them is ignored.
pub(super) struct HexDecoder<R> {
    text: R,
}

impl<R: BufRead> HexDecoder<R> {
    pub(super) fn new(text: R) -> Self {
        Self { text }
    }

    fn digit(&mut self) -> io::Result<Option<u8>> {
        while let Some(&byte) = self.text.fill_buf()?.first() {
            self.text.consume(1);
            if byte.is_ascii_whitespace() {
                continue;
            }
            return match char::from(byte).to_digit(16) {
                Some(digit) => Ok(Some(digit as u8)),
                None => Err(io::Error::new(
                    ErrorKind::InvalidData,
                    format!("{:?} is not a hexadecimal digit", char::from(byte)),
                )),
            };
        }
        Ok(None)
    }
}

impl<R: BufRead> Read for HexDecoder<R> {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        let mut got = 0;
        for byte in out {
            let (Some(high), Some(low)) = (self.digit()?, self.digit()?) else {
                break;
            };
            *byte = high << 4 | low;
            got += 1;
        }
        Ok(got)
    }
}
