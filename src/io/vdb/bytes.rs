//! Little-endian numbers and texts of a file in memory, one after the other.

use std::path::Path;

use glam::{DVec3, I64Vec3};

use crate::error::{Error, Result};
use crate::io::element::Stored;
use crate::io::source::bad;

/// Longest name or type, in bytes.
const MAX_TEXT_BYTES: usize = 1 << 16;

/// A place in a file.
#[derive(Clone, Copy)]
pub(super) struct Bytes<'a> {
    path: &'a Path,
    all: &'a [u8],
    at: usize,
}

impl<'a> Bytes<'a> {
    pub(super) fn new(path: &'a Path, all: &'a [u8]) -> Self {
        Self { path, all, at: 0 }
    }

    pub(super) fn position(&self) -> usize {
        self.at
    }

    pub(super) fn path(&self) -> &'a Path {
        self.path
    }

    /// The same file, from another place.
    pub(super) fn from(&self, position: i64) -> Result<Self> {
        match usize::try_from(position) {
            Ok(at) if at <= self.all.len() => Ok(Self { at, ..*self }),
            _ => Err(self.bad(format!(
                "points to byte {position}; the file has {}",
                self.all.len()
            ))),
        }
    }

    pub(super) fn take(&mut self, count: usize) -> Result<&'a [u8]> {
        let taken = self.all.get(self.at..).and_then(|rest| rest.get(..count));
        let taken = taken.ok_or_else(|| {
            self.bad(format!(
                "{count} bytes are needed, the file has {}: it is cut short or damaged",
                self.all.len()
            ))
        })?;
        self.at += count;
        Ok(taken)
    }

    /// The next number, in the machine's byte order.
    pub(super) fn number<T: Stored>(&mut self) -> Result<T> {
        let bytes = self.take(size_of::<T>())?;
        Ok(from_little_endian(bytes))
    }

    /// A length and as many bytes of text.
    pub(super) fn text(&mut self) -> Result<String> {
        let len = self.number::<u32>()? as usize;
        if len > MAX_TEXT_BYTES {
            return Err(self.bad(format!("a name of {len} bytes; {MAX_TEXT_BYTES} are read")));
        }
        Ok(String::from_utf8_lossy(self.take(len)?).into_owned())
    }

    pub(super) fn coordinates(&mut self) -> Result<I64Vec3> {
        let mut next = || self.number::<i32>().map(i64::from);
        Ok(I64Vec3::new(next()?, next()?, next()?))
    }

    pub(super) fn vector(&mut self) -> Result<DVec3> {
        let mut next = || self.number::<f64>();
        Ok(DVec3::new(next()?, next()?, next()?))
    }

    pub(super) fn bad(&self, message: String) -> Error {
        bad(self.path, format!("at byte {}: {message}", self.at))
    }
}

/// A number from its bytes; 0 of too few.
pub(super) fn from_little_endian<T: Stored>(bytes: &[u8]) -> T {
    let value: T = bytemuck::try_pod_read_unaligned(bytes).unwrap_or_else(|_| T::zeroed());
    if cfg!(target_endian = "big") {
        value.swapped()
    } else {
        value
    }
}
