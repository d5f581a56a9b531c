//! A file on disk, read forward, whose errors name it.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Cursor, ErrorKind, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use flate2::bufread::MultiGzDecoder;

use crate::error::{Error, Result};

/// Large enough that decompression is not bound by system calls.
const BUFFER_BYTES: usize = 1 << 16;

/// First bytes of every gzip file (RFC 1952, 2.3.1).
pub(super) const GZIP_MAGIC: &[u8] = &[0x1f, 0x8b];

/// An open regular file, its length and how far it has been read.
pub(super) struct Source {
    path: PathBuf,
    len: u64,
    position: u64,
    data: Data,
}

enum Data {
    File(BufReader<File>),
    /// A member of an archive.
    Bytes(Cursor<Vec<u8>>),
}

impl Source {
    /// Opens a regular file.
    pub(super) fn open(path: &Path) -> Result<Self> {
        let io = |e| Error::io(path, e);
        // Asked before opening: opening a pipe would wait for its writer.
        let meta = std::fs::metadata(path).map_err(|e| cannot_open(path, e))?;
        if !meta.is_file() {
            let what = if meta.is_dir() {
                "a folder"
            } else {
                "not a regular file"
            };
            return Err(Error::volume(
                path,
                format!("this is {what}; a volume file is needed"),
            ));
        }
        Ok(Self {
            path: path.to_path_buf(),
            len: meta.len(),
            position: 0,
            data: Data::File(BufReader::with_capacity(
                BUFFER_BYTES,
                File::open(path).map_err(io)?,
            )),
        })
    }

    /// A file that is in memory; `path` is what messages call it.
    pub(super) fn from_bytes(path: &Path, bytes: Vec<u8>) -> Self {
        Self {
            path: path.to_path_buf(),
            len: bytes.len() as u64,
            position: 0,
            data: Data::Bytes(Cursor::new(bytes)),
        }
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Bytes not read yet.
    pub(super) fn remaining(&self) -> u64 {
        self.len.saturating_sub(self.position)
    }

    /// Skips bytes that must be there.
    pub(super) fn advance(&mut self, bytes: u64, why: &str) -> Result<()> {
        if bytes > self.remaining() {
            return Err(self.bad(format!(
                "{why} skips {bytes} bytes, but only {} are left of the file's {}",
                self.remaining(),
                self.len
            )));
        }
        self.position += bytes;
        let start = SeekFrom::Start(self.position);
        match &mut self.data {
            Data::File(file) => file.seek(start),
            Data::Bytes(bytes) => bytes.seek(start),
        }
        .map_err(|e| Error::io(&self.path, e))?;
        Ok(())
    }

    /// The next line without its end, `None` at the end of the file. `budget` counts down the bytes of the
    /// header.
    pub(super) fn line(&mut self, budget: &mut u64) -> Result<Option<String>> {
        let mut line = Vec::new();
        let allowed = *budget;
        let got = self
            .by_ref()
            .take(allowed)
            .read_until(b'\n', &mut line)
            .map_err(|e| Error::io(&self.path, e))? as u64;
        *budget -= got;
        if line.last() != Some(&b'\n') && *budget == 0 && self.remaining() > 0 {
            return Err(self.bad("the header does not end within the limit for headers".into()));
        }
        if line.is_empty() {
            return Ok(None);
        }
        Ok(Some(
            String::from_utf8_lossy(&line)
                .trim_end_matches(['\n', '\r'])
                .to_owned(),
        ))
    }

    /// Passes over a line of any length; false at the end of the file.
    pub(super) fn skip_line(&mut self) -> Result<bool> {
        let skipped = self.skip_until(b'\n');
        Ok(skipped.map_err(|e| Error::io(&self.path, e))? > 0)
    }

    pub(super) fn bad(&self, message: String) -> Error {
        bad(&self.path, message)
    }
}

impl Read for Source {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        let got = match &mut self.data {
            Data::File(file) => file.read(out)?,
            Data::Bytes(bytes) => bytes.read(out)?,
        };
        self.position += got as u64;
        Ok(got)
    }
}

impl BufRead for Source {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        match &mut self.data {
            Data::File(file) => file.fill_buf(),
            Data::Bytes(bytes) => bytes.fill_buf(),
        }
    }

    fn consume(&mut self, bytes: usize) {
        self.position += bytes as u64;
        match &mut self.data {
            Data::File(file) => file.consume(bytes),
            Data::Bytes(inner) => inner.consume(bytes),
        }
    }
}

/// Longest message about a file, in characters: damaged headers are quoted, and can be megabytes long.
const MAX_MESSAGE_CHARS: usize = 1000;

/// An [`Error::Volume`] of bounded length.
pub(super) fn bad(path: &Path, mut message: String) -> Error {
    if let Some((end, _)) = message.char_indices().nth(MAX_MESSAGE_CHARS) {
        message.truncate(end);
        message.push('…');
    }
    Error::volume(path, message)
}

/// Names the file in what a read or a decoder said. Decoders report damage as `InvalidData` or `InvalidInput`.
pub(super) fn read_error(path: &Path, error: io::Error) -> Error {
    match error.kind() {
        ErrorKind::UnexpectedEof => {
            Error::volume(path, format!("the compressed data ends early: {error}"))
        }
        ErrorKind::InvalidData | ErrorKind::InvalidInput => {
            Error::volume(path, format!("the data is damaged: {error}"))
        }
        _ => Error::io(path, error),
    }
}

/// A path that leads nowhere is the caller's to mend, whatever keeps it from leading somewhere: links in a circle, names
/// that are too long, bytes that no name has.
fn cannot_open(path: &Path, error: io::Error) -> Error {
    let error = Error::io(path, error);
    if error.is_bad_input() {
        return error;
    }
    bad(path, format!("cannot open it: {error}"))
}

/// Up to `most` bytes from the start of a file; none of a folder.
pub(super) fn head(path: &Path, most: usize) -> Result<Vec<u8>> {
    if path.is_dir() {
        return Ok(Vec::new());
    }
    let mut head = Vec::new();
    Source::open(path)?
        .take(most as u64)
        .read_to_end(&mut head)
        .map_err(|e| Error::io(path, e))?;
    Ok(head)
}

/// Up to `most` bytes from the start of what a file, or part of one, holds once it is decompressed.
pub(super) fn gunzipped_head(head: &[u8], most: usize) -> Vec<u8> {
    let mut plain = Vec::new();
    if head.starts_with(GZIP_MAGIC) {
        // The head of a file breaks off in the middle: what comes before that is what is wanted.
        let _ = MultiGzDecoder::new(head)
            .take(most as u64)
            .read_to_end(&mut plain);
    } else {
        plain.extend(head.iter().take(most));
    }
    plain
}
