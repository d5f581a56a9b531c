//! A look at what the directories of a TIFF file claim, before a decoder believes it: the decoder makes room for
//! as many values as an entry counts, before it reads them.
//!
//! Format: *TIFF Revision 6.0*, section 2; BigTIFF as in the *BigTIFF Design* of libtiff.

use std::io::{self, Read, Seek, SeekFrom};
use std::path::Path;

use crate::error::Result;
use crate::io::source::bad;

/// Bytes of a value of each type, by its number; 0 of those that do not exist.
const TYPE_BYTES: [u64; 19] = [0, 1, 1, 2, 4, 8, 1, 1, 2, 4, 8, 4, 8, 4, 0, 0, 8, 8, 8];

/// Least bytes of a directory without entries, and of an entry.
const DIRECTORY_BYTES: u64 = 6;
const ENTRY_BYTES: u64 = 12;

/// Refuses a file with an entry that claims more values than the file has bytes for. What cannot be followed ends the
/// look, as it will end the decoder.
pub(super) fn check(path: &Path, file: &mut (impl Read + Seek)) -> Result<()> {
    match longest_claim(file) {
        Ok(Some((claimed, len))) => Err(bad(
            path,
            format!("an entry of a directory claims {claimed} bytes, the file has {len}"),
        )),
        _ => Ok(()),
    }
}

/// The first claim that is larger than the file, and the file's length.
fn longest_claim(file: &mut (impl Read + Seek)) -> io::Result<Option<(u64, u64)>> {
    let len = file.seek(SeekFrom::End(0))?;
    file.seek(SeekFrom::Start(0))?;
    let order: [u8; 4] = bytes(file)?;
    let layout = Layout {
        big_endian: order.starts_with(b"MM"),
        wide: order.contains(&43),
    };
    if layout.wide {
        let _: [u8; 4] = bytes(file)?;
    }
    // Directories share no bytes: more of them than the file has room for go in a circle.
    let mut walked = 0u64;
    while walked <= len {
        let directory = layout.offset(file)?;
        if directory == 0 {
            break;
        }
        file.seek(SeekFrom::Start(directory))?;
        let entries = if layout.wide {
            layout.offset(file)?
        } else {
            layout.short(file)?.into()
        };
        walked = walked.saturating_add(DIRECTORY_BYTES);
        for _ in 0..entries {
            walked = walked.saturating_add(ENTRY_BYTES);
            let _tag = layout.short(file)?;
            let kind = layout.short(file)?;
            let count = layout.offset(file)?;
            let _value = layout.offset(file)?;
            let size = TYPE_BYTES.get(usize::from(kind)).copied().unwrap_or(0);
            let claimed = count.saturating_mul(size);
            if claimed > len {
                return Ok(Some((claimed, len)));
            }
        }
    }
    Ok(None)
}

struct Layout {
    big_endian: bool,
    /// BigTIFF: 64 bits for counts and offsets.
    wide: bool,
}

impl Layout {
    fn short(&self, file: &mut impl Read) -> io::Result<u16> {
        let short = bytes(file)?;
        Ok(if self.big_endian {
            u16::from_be_bytes(short)
        } else {
            u16::from_le_bytes(short)
        })
    }

    /// A count or an offset.
    fn offset(&self, file: &mut impl Read) -> io::Result<u64> {
        Ok(match (self.wide, self.big_endian) {
            (true, true) => u64::from_be_bytes(bytes(file)?),
            (true, false) => u64::from_le_bytes(bytes(file)?),
            (false, true) => u32::from_be_bytes(bytes(file)?).into(),
            (false, false) => u32::from_le_bytes(bytes(file)?).into(),
        })
    }
}

fn bytes<const N: usize>(file: &mut impl Read) -> io::Result<[u8; N]> {
    let mut bytes = [0; N];
    file.read_exact(&mut bytes)?;
    Ok(bytes)
}
