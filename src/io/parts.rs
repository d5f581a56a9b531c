//! Data in several files beside their header, each coded on its own.

use std::io::{self, ErrorKind, Read};
use std::path::{Path, PathBuf};

use super::bundle::check_count;
use super::element::Element;
use super::payload::{Coding, read_full};
use super::source::{Source, bad};
use super::{Limits, detached};
use crate::error::{Error, Result};

/// Widest number in a file name.
const MAX_DIGITS: usize = 32;

/// The names that a pattern stands for: `%d`, or `%03d` with zeros in front, from `min` to `max` by `step`.
pub(super) fn numbered(
    header: &Path,
    key: &str,
    pattern: &str,
    [min, max, step]: [i64; 3],
    limits: &Limits,
) -> Result<Vec<String>> {
    let refuse = |why: String| Err(bad(header, format!("{key} {pattern:?}: {why}")));
    let parts = pattern.split_once('%').and_then(|(before, rest)| {
        let (format, after) = rest.split_once('d')?;
        let zeros = format.starts_with('0');
        let width: usize = if format.is_empty() {
            0
        } else {
            format.parse().ok()?
        };
        (width <= MAX_DIGITS && !after.contains('%')).then_some((before, zeros, width, after))
    });
    let Some((before, zeros, width, after)) = parts else {
        return refuse("one number like %d or %03d is needed".into());
    };
    let span = i128::from(max) - i128::from(min);
    if step == 0 || (span < 0) != (step < 0) && span != 0 {
        return refuse(format!("{min} to {max} by {step} are no numbers of files"));
    }
    let count = span / i128::from(step) + 1;
    if count > limits.max_files as i128 {
        return refuse(format!("{count} files; the limit is {}", limits.max_files));
    }
    let name = |i: i128| {
        let number = i128::from(min) + i * i128::from(step);
        match zeros {
            true => format!("{before}{number:0width$}{after}"),
            false => format!("{before}{number:width$}{after}"),
        }
    };
    Ok((0..count).map(name).collect())
}

/// The names on the lines that are left of a header.
pub(super) fn listed(header: &mut Source, limits: &Limits) -> Result<Vec<String>> {
    let mut names = Vec::new();
    let mut budget = limits.max_header_bytes;
    while let Some(line) = header.line(&mut budget)? {
        let name = line.trim();
        if !name.is_empty() {
            check_count(header.path(), names.len(), limits)?;
            names.push(name.to_owned());
        }
    }
    Ok(names)
}

/// Where the files that a header names are; each must be there, inside of the header's folder.
pub(super) fn files(header: &Path, key: &str, names: &[String]) -> Result<Vec<PathBuf>> {
    if names.is_empty() {
        return Err(bad(
            header,
            format!("{key}: LIST names no file on the lines after it"),
        ));
    }
    let find = |name: &String| {
        let path = detached::path(header, key, name)?;
        match path.is_file() {
            true => Ok(path),
            false => Err(bad(
                header,
                format!(
                    "{key}: {name:?}, one of {} files, is not there",
                    names.len()
                ),
            )),
        }
    };
    names.iter().map(find).collect()
}

/// Opens a file where its voxels begin.
type Open = Box<dyn Fn(&Path) -> Result<Box<dyn Read>>>;

/// Reads files one after the other, of which each holds the same number of bytes.
pub(super) struct Parts {
    files: std::vec::IntoIter<PathBuf>,
    bytes_of_each: u64,
    open: Open,
    current: Box<dyn Read>,
    /// Bytes of the current file that are still to come.
    left: u64,
}

impl Parts {
    /// Of files that hold `bytes` in all once they are decoded. `to_data` goes to where the data of a file begin, given
    /// their number of bytes, and tells how many to skip of what `decoder` then reads.
    pub(super) fn new(
        header: &Path,
        files: Vec<PathBuf>,
        bytes: u64,
        (coding, element): (Coding, Element),
        to_data: impl Fn(&mut Source, u64) -> Result<u64> + 'static,
        decoder: impl Fn(Source) -> Box<dyn Read> + 'static,
    ) -> Result<Self> {
        let count = files.len() as u64;
        let bytes_of_each = bytes.checked_div(count).unwrap_or(0);
        if bytes_of_each == 0 || !bytes.is_multiple_of(count) {
            return Err(bad(
                header,
                format!("{bytes} bytes of voxels do not lie in {count} files of one size"),
            ));
        }
        let open = move |path: &Path| {
            let mut source = Source::open(path)?;
            let skip = to_data(&mut source, bytes_of_each)?;
            coding.check_length(
                &source,
                [skip, bytes_of_each],
                element,
                "the voxels of one of several files",
            )?;
            let mut reader = decoder(source);
            let skipped = io::copy(&mut reader.by_ref().take(skip), &mut io::sink());
            skipped.map_err(|e| Error::io(path, e))?;
            Ok(reader)
        };
        // What the files cannot hold is refused before room is made for it.
        for file in &files {
            open(file)?;
        }
        Ok(Self {
            files: files.into_iter(),
            bytes_of_each,
            open: Box::new(open),
            current: Box::new(io::empty()),
            left: 0,
        })
    }
}

impl Read for Parts {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        if self.left == 0 {
            let Some(file) = self.files.next() else {
                return Ok(0);
            };
            let damaged = |e: Error| io::Error::new(ErrorKind::InvalidData, e.to_string());
            self.current = (self.open)(&file).map_err(damaged)?;
            self.left = self.bytes_of_each;
        }
        let most = out
            .len()
            .min(usize::try_from(self.left).unwrap_or(usize::MAX));
        let got = read_full(&mut self.current, out.get_mut(..most).unwrap_or_default())?;
        self.left -= got as u64;
        Ok(got)
    }
}
