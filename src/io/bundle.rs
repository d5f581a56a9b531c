//! Files that make a volume together: those of a folder, or of an archive.

use std::borrow::Cow;
use std::fs::File;
use std::io::{Read, Seek as _, SeekFrom};
use std::path::{Path, PathBuf};

use super::Limits;
use super::source::bad;
use crate::error::{Error, Result};

/// Folders inside folders that are looked into.
const MAX_DEPTH: usize = 16;

/// Named files, in natural order of their names: `slice2` comes before `slice10`.
pub(super) struct Bundle {
    path: PathBuf,
    members: Vec<Member>,
}

/// One file of a [`Bundle`].
pub(super) struct Member {
    name: String,
    data: Data,
}

enum Data {
    File(PathBuf),
    Bytes(Vec<u8>),
}

impl Bundle {
    pub(super) fn new(path: &Path, mut members: Vec<Member>) -> Self {
        members.sort_by_cached_key(|member| natural_key(&member.name));
        Self {
            path: path.to_path_buf(),
            members,
        }
    }

    /// The files of a folder and of those in it. Links to folders are not followed, so that there is no cycle.
    pub(super) fn folder(path: &Path, limits: &Limits) -> Result<Self> {
        let mut members = Vec::new();
        collect(path, "", 0, limits, &mut members)?;
        Ok(Self::new(path, members))
    }

    /// The files directly beside `file`, itself included.
    pub(super) fn beside(file: &Path, limits: &Limits) -> Result<Self> {
        let folder = match file.parent() {
            Some(parent) if parent != Path::new("") => parent,
            _ => Path::new("."),
        };
        let mut members = Vec::new();
        collect(folder, "", MAX_DEPTH, limits, &mut members)?;
        Ok(Self::new(folder, members))
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    pub(super) fn members(&self) -> &[Member] {
        &self.members
    }

    /// What a message calls a file of this bundle.
    pub(super) fn path_of(&self, member: &Member) -> PathBuf {
        match &member.data {
            Data::File(path) => path.clone(),
            Data::Bytes(_) => self.path.join(&member.name),
        }
    }
}

impl Member {
    /// A file of an archive.
    pub(super) fn unpacked(name: String, bytes: Vec<u8>) -> Self {
        Self {
            name,
            data: Data::Bytes(bytes),
        }
    }

    /// Path from the root of the bundle, with `/`.
    pub(super) fn name(&self) -> &str {
        &self.name
    }

    /// The file itself, when it is one on disk.
    pub(super) fn file(&self) -> Option<&Path> {
        match &self.data {
            Data::File(path) => Some(path),
            Data::Bytes(_) => None,
        }
    }

    /// Bytes of the file; 0 of what cannot be read.
    pub(super) fn len(&self) -> u64 {
        match &self.data {
            Data::File(path) => std::fs::metadata(path).map_or(0, |meta| meta.len()),
            Data::Bytes(bytes) => bytes.len() as u64,
        }
    }

    /// Up to `most` bytes from the start; none of what cannot be read.
    pub(super) fn head(&self, most: usize) -> Vec<u8> {
        match &self.data {
            Data::File(path) => head(path, most).unwrap_or_default(),
            Data::Bytes(bytes) => bytes.iter().take(most).copied().collect(),
        }
    }

    /// The whole file.
    pub(super) fn bytes(&self, limits: &Limits) -> Result<Cow<'_, [u8]>> {
        let path = match &self.data {
            Data::Bytes(bytes) => return Ok(Cow::Borrowed(bytes)),
            Data::File(path) => path,
        };
        Ok(Cow::Owned(whole_file(path, limits)?))
    }

    /// Something to read the file from, forward.
    pub(super) fn open(&self) -> Result<Box<dyn Read + '_>> {
        Ok(match &self.data {
            Data::Bytes(bytes) => Box::new(bytes.as_slice()),
            Data::File(path) => Box::new(std::io::BufReader::new(
                File::open(path).map_err(|e| Error::io(path, e))?,
            )),
        })
    }

    /// Fills `out` from a place of the file, without a buffer in between. Gives back how many bytes there are.
    pub(super) fn read_at(&self, offset: u64, out: &mut [u8]) -> Result<usize> {
        match &self.data {
            Data::Bytes(bytes) => {
                let start = usize::try_from(offset).unwrap_or(usize::MAX);
                let there = bytes.get(start..).unwrap_or_default();
                let got = there.len().min(out.len());
                for (out, &byte) in out.iter_mut().zip(there) {
                    *out = byte;
                }
                Ok(got)
            }
            Data::File(path) => {
                let mut read = || {
                    let mut file = File::open(path)?;
                    file.seek(SeekFrom::Start(offset))?;
                    super::payload::read_full(&mut file, out)
                };
                read().map_err(|e| Error::io(path, e))
            }
        }
    }
}

/// Up to `most` bytes from the start of a file.
fn head(path: &Path, most: usize) -> std::io::Result<Vec<u8>> {
    let mut head = Vec::with_capacity(most);
    File::open(path)?.take(most as u64).read_to_end(&mut head)?;
    Ok(head)
}

/// All bytes of a file, if they are no more than a volume may have.
pub(super) fn whole_file(path: &Path, limits: &Limits) -> Result<Vec<u8>> {
    let io = |e| Error::io(path, e);
    let file = File::open(path).map_err(io)?;
    let len = file.metadata().map_err(io)?.len();
    if len > limits.max_bytes {
        return Err(bad(
            path,
            format!("it has {len} bytes; the limit is {}", limits.max_bytes),
        ));
    }
    let mut bytes = super::payload::reserve(len as usize)?;
    file.take(len).read_to_end(&mut bytes).map_err(io)?;
    Ok(bytes)
}

fn collect(
    folder: &Path,
    prefix: &str,
    depth: usize,
    limits: &Limits,
    members: &mut Vec<Member>,
) -> Result<()> {
    let io = |e| Error::io(folder, e);
    for entry in std::fs::read_dir(folder).map_err(io)? {
        let entry = entry.map_err(io)?;
        let name = format!("{prefix}{}", entry.file_name().to_string_lossy());
        let kind = entry.file_type().map_err(io)?;
        if kind.is_dir() {
            if depth < MAX_DEPTH {
                collect(
                    &entry.path(),
                    &format!("{name}/"),
                    depth + 1,
                    limits,
                    members,
                )?;
            }
        } else if kind.is_file() || (kind.is_symlink() && entry.path().is_file()) {
            check_count(folder, members.len(), limits)?;
            members.push(Member {
                name,
                data: Data::File(entry.path()),
            });
        }
    }
    Ok(())
}

/// Refuses one more file than the limits allow.
pub(super) fn check_count(path: &Path, held: usize, limits: &Limits) -> Result<()> {
    if held < limits.max_files {
        return Ok(());
    }
    Err(bad(
        path,
        format!("it holds more than {} files, the limit", limits.max_files),
    ))
}

/// Splits a name so that runs of digits compare as numbers.
fn natural_key(name: &str) -> Vec<(String, u128, usize)> {
    let mut key = Vec::new();
    let mut rest = name;
    while !rest.is_empty() {
        let text_end = rest
            .find(|c: char| c.is_ascii_digit())
            .unwrap_or(rest.len());
        let (text, after) = rest.split_at(text_end);
        let digits_end = after
            .find(|c: char| !c.is_ascii_digit())
            .unwrap_or(after.len());
        let (digits, after) = after.split_at(digits_end);
        // Equal numbers of different lengths (1, 01) are told apart by their length.
        let number = digits.parse().unwrap_or(u128::MAX);
        key.push((text.to_owned(), number, digits.len()));
        rest = after;
    }
    key
}

#[cfg(test)]
mod tests {
    use super::natural_key;

    #[test]
    fn numbers_in_names_count() {
        let mut names = ["a10.png", "a9.png", "a1b2", "b", "a010.png", "a1.png"];
        names.sort_by_cached_key(|n| natural_key(n));
        assert_eq!(
            names,
            ["a1.png", "a1b2", "a9.png", "a10.png", "a010.png", "b"]
        );
    }
}
