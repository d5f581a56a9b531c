//! Archives, unpacked into memory: no name in one can lead anywhere. `packed` alone writes members to disk.
//!
//! ZIP (PKWARE, *APPNOTE.TXT*) with stored and deflated members, and POSIX tar, plain, gzip or xz; gzip and xz of one
//! file.

use std::fs::File;
use std::io::{BufReader, Read, Seek as _};
use std::path::Path;

use flate2::read::MultiGzDecoder;
use lzma_rust2::XzReader;

use super::bundle::{Bundle, Member, check_count};
use super::source::{GZIP_MAGIC, bad, gunzipped_head, read_error};
use super::{Limits, xz_claims};
use crate::error::{Error, Result};

/// An archive that unpacks to more than this many times its size, and to more than [`FREE_BYTES`], is a bomb.
const MAX_RATIO: u64 = 250;
/// What any archive may unpack to.
const FREE_BYTES: u64 = 64 << 20;

const XZ_MAGIC: &[u8] = b"\xfd7zXZ\0";
/// Where a tar header names its format, and how.
const USTAR: (usize, &[u8]) = (257, b"ustar");
/// Bytes of a tar header.
const TAR_BLOCK: u64 = 512;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Zip,
    Tar,
    TarGz,
    /// One file.
    Gzip,
    /// Of one file, or of a tar archive: what it is takes memory to know.
    Xz,
}

impl Kind {
    /// What the start of a file says.
    pub(super) fn of(head: &[u8]) -> Option<Self> {
        if head.starts_with(b"PK\x03\x04") || head.starts_with(b"PK\x05\x06") {
            Some(Self::Zip)
        } else if is_tar(head) {
            Some(Self::Tar)
        } else if head.starts_with(XZ_MAGIC) {
            Some(Self::Xz)
        } else if head.starts_with(GZIP_MAGIC) {
            let tar = is_tar(&gunzipped_head(head, 512));
            Some(if tar { Self::TarGz } else { Self::Gzip })
        } else {
            None
        }
    }

    /// Unpacks every regular file.
    pub(super) fn unpack(self, path: &Path, limits: &Limits) -> Result<Bundle> {
        let file = File::open(path).map_err(|e| Error::io(path, e))?;
        let packed = file.metadata().map_err(|e| Error::io(path, e))?.len();
        let mut file = BufReader::new(file);
        let allowed = packed
            .saturating_mul(MAX_RATIO)
            .max(FREE_BYTES)
            .min(limits.max_archive_bytes);
        let mut unpacked = Unpacked {
            path,
            limits,
            allowed,
            left: allowed,
            members: Vec::new(),
        };
        match self {
            Self::Zip => unpacked.zip(file)?,
            Self::Tar => unpacked.tar(file)?,
            Self::TarGz => unpacked.tar(MultiGzDecoder::new(file))?,
            Self::Gzip => unpacked.one(MultiGzDecoder::new(file))?,
            Self::Xz => {
                xz_claims::check(path, &mut file)?;
                file.rewind().map_err(|e| Error::io(path, e))?;
                unpacked.tar_or_one(XzReader::new(file, true))?;
            }
        }
        Ok(Bundle::new(path, unpacked.members))
    }
}

fn is_tar(head: &[u8]) -> bool {
    head.get(USTAR.0..).is_some_and(|h| h.starts_with(USTAR.1))
}

/// An archive on its way into memory.
struct Unpacked<'a> {
    path: &'a Path,
    limits: &'a Limits,
    allowed: u64,
    left: u64,
    members: Vec<Member>,
}

impl Unpacked<'_> {
    fn zip(&mut self, file: BufReader<File>) -> Result<()> {
        let damaged = |e| bad(self.path, format!("the ZIP archive is damaged: {e}"));
        let mut archive = zip::ZipArchive::new(file).map_err(damaged)?;
        for i in 0..archive.len() {
            let member = archive.by_index(i).map_err(damaged)?;
            if member.is_file() {
                let (name, size) = (member.name().to_owned(), Some(member.size()));
                self.take(name, size, member)?;
            }
        }
        Ok(())
    }

    fn tar(&mut self, stream: impl Read) -> Result<()> {
        let mut archive = tar::Archive::new(stream);
        let path = self.path;
        for entry in archive.entries().map_err(|e| read_error(path, e))? {
            let entry = entry.map_err(|e| tar_error(path, e))?;
            if entry.header().entry_type().is_file() {
                let name = String::from_utf8_lossy(&entry.path_bytes()).into_owned();
                let size = Some(entry.size());
                self.take(name, size, entry)?;
            }
        }
        Ok(())
    }

    fn tar_or_one(&mut self, mut stream: impl Read) -> Result<()> {
        let mut start = Vec::new();
        stream
            .by_ref()
            .take(TAR_BLOCK)
            .read_to_end(&mut start)
            .map_err(|e| tar_error(self.path, e))?;
        let tar = is_tar(&start);
        let whole = start.as_slice().chain(stream);
        if tar {
            self.tar(whole)
        } else {
            self.one(whole)
        }
    }

    /// A compressed file, called as the archive is but for its last ending.
    fn one(&mut self, file: impl Read) -> Result<()> {
        let name = self.path.file_stem().unwrap_or_default();
        self.take(name.to_string_lossy().into_owned(), None, file)
    }

    /// Reads one member, of a size that is claimed.
    fn take(&mut self, name: String, size: Option<u64>, member: impl Read) -> Result<()> {
        check_count(self.path, self.members.len(), self.limits)?;
        let too_much = |allowed: u64| {
            bad(
                self.path,
                format!(
                    "it unpacks to more than {allowed} bytes, the limit for an archive of its size"
                ),
            )
        };
        if size.is_some_and(|size| size > self.left) {
            return Err(too_much(self.allowed));
        }
        // The claim is not believed before the bytes are there.
        let mut bytes = Vec::new();
        member
            .take(self.left + 1)
            .read_to_end(&mut bytes)
            .map_err(|e| tar_error(self.path, e))?;
        let read = bytes.len() as u64;
        if read > self.left {
            return Err(too_much(self.allowed));
        }
        if let Some(size) = size.filter(|&size| size != read) {
            return Err(bad(
                self.path,
                format!("{name:?} has {read} bytes; its header says {size}"),
            ));
        }
        bytes.shrink_to_fit();
        self.left -= read;
        self.members.push(Member::unpacked(name, bytes));
        Ok(())
    }
}

/// The readers of tar and xz report damage as errors of kind `Other`.
fn tar_error(path: &Path, error: std::io::Error) -> Error {
    match error.kind() {
        std::io::ErrorKind::Other => bad(path, format!("the archive is damaged: {error}")),
        _ => read_error(path, error),
    }
}
