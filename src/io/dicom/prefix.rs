//! Files without what PS3.10 puts in front of a data set.
//!
//! Old files begin with the file meta group, or with the data set itself, then Implicit VR Little Endian or, where the
//! value representations can be seen, Explicit VR Little Endian. What is missing is put in front of them.

use std::io::{self, Chain, Cursor, Read, Seek, SeekFrom};

use super::PREAMBLE;
use crate::io::bundle::Member;

/// What is read of a file at once: most headers end before.
const START_BYTES: usize = 1 << 14;
/// Elements of the identifying group that must follow each other.
const LEAST_ELEMENTS: usize = 3;

/// What a file begins with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Prefix {
    Whole,
    /// The file meta group comes first.
    NoPreamble,
    /// The data set comes first.
    None {
        explicit: bool,
    },
}

impl Prefix {
    /// `None` of what is no DICOM file.
    pub(super) fn of(head: &[u8]) -> Option<Self> {
        let preamble = head.get(PREAMBLE.0..);
        if preamble.is_some_and(|rest| rest.starts_with(PREAMBLE.1)) {
            return Some(Self::Whole);
        }
        if head.starts_with(&[2, 0, 0, 0, b'U', b'L', 4, 0]) {
            return Some(Self::NoPreamble);
        }
        [false, true]
            .into_iter()
            .find(|&explicit| identifies(head, explicit))
            .map(|explicit| Self::None { explicit })
    }

    /// What is missing in front.
    fn missing(self) -> Vec<u8> {
        let mut bytes = vec![0; PREAMBLE.0];
        bytes.extend(PREAMBLE.1);
        match self {
            Self::Whole => Vec::new(),
            Self::NoPreamble => bytes,
            Self::None { explicit } => {
                // Length of the group, then TransferSyntaxUID.
                let uid: &[u8] = match explicit {
                    true => b"1.2.840.10008.1.2.1\0",
                    false => b"1.2.840.10008.1.2\0",
                };
                bytes.extend([2, 0, 0, 0, b'U', b'L', 4, 0, 8 + uid.len() as u8, 0, 0, 0]);
                bytes.extend([2, 0, 0x10, 0, b'U', b'I', uid.len() as u8, 0]);
                bytes.extend(uid);
                bytes
            }
        }
    }
}

/// Whether the head begins with elements of group 8, in ascending order.
fn identifies(head: &[u8], explicit: bool) -> bool {
    let mut rest = head;
    let mut last = None;
    for _ in 0..LEAST_ELEMENTS {
        let Some((&[8, 0, low, high, a, b, c, d], after)) = rest.split_first_chunk::<8>() else {
            return false;
        };
        let element = u16::from_le_bytes([low, high]);
        if last.is_some_and(|last| element <= last) {
            return false;
        }
        last = Some(element);
        let length = if explicit {
            if !(a.is_ascii_uppercase() && b.is_ascii_uppercase()) {
                return false;
            }
            u32::from(u16::from_le_bytes([c, d]))
        } else {
            u32::from_le_bytes([a, b, c, d])
        };
        let Some(after) = after.get(length as usize..) else {
            return false;
        };
        rest = after;
    }
    true
}

/// How a DICOM file begins. It is read once, and looked at as often as need be.
pub(super) struct Start<'a> {
    member: &'a Member,
    bytes: Vec<u8>,
    prefix: Prefix,
}

impl<'a> Start<'a> {
    /// `None` of what is no DICOM file.
    pub(super) fn of(member: &'a Member) -> Option<Self> {
        let bytes = member.head(START_BYTES);
        let prefix = Prefix::of(&bytes)?;
        Some(Self {
            member,
            bytes,
            prefix,
        })
    }

    pub(super) fn member(&self) -> &'a Member {
        self.member
    }

    /// The file from its preamble on, whether that is there or not.
    pub(super) fn stream(&self) -> Prefixed<'_> {
        let missing = self.prefix.missing();
        let rest = Rest {
            member: self.member,
            skip: self.bytes.len() as u64,
            file: None,
        };
        Prefixed {
            missing: missing.len() as u64,
            stream: Cursor::new(missing).chain(&self.bytes[..]).chain(rest),
            position: 0,
        }
    }
}

/// A file after its start, opened when something of it is wanted.
struct Rest<'a> {
    member: &'a Member,
    skip: u64,
    file: Option<Box<dyn Read + 'a>>,
}

impl Read for Rest<'_> {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        if let Some(file) = &mut self.file {
            return file.read(out);
        }
        let mut file = self.member.open().map_err(io::Error::other)?;
        io::copy(&mut file.by_ref().take(self.skip), &mut io::sink())?;
        self.file.insert(file).read(out)
    }
}

/// A file with what was missing in front of it.
pub(super) struct Prefixed<'a> {
    stream: Chain<Chain<Cursor<Vec<u8>>, &'a [u8]>, Rest<'a>>,
    position: u64,
    missing: u64,
}

impl Prefixed<'_> {
    /// Bytes that are not in the file.
    pub(super) fn missing(&self) -> u64 {
        self.missing
    }
}

impl Read for Prefixed<'_> {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        let got = self.stream.read(out)?;
        self.position += got as u64;
        Ok(got)
    }
}

/// Parsers that skip values ask where they are, and read on.
impl Seek for Prefixed<'_> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        match to {
            SeekFrom::Current(0) => Ok(self.position),
            _ => Err(io::ErrorKind::Unsupported.into()),
        }
    }
}
