//! Files that appear whole or not at all.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

use super::folder_of;
use crate::error::{Error, Result};

/// Tells apart the temporary files of one process.
static SERIAL: AtomicU32 = AtomicU32::new(0);

/// Lets `fill` write a temporary file in the folder of `path`, then renames it to `path`.
///
/// # Errors
/// What `fill` returns, or [`Error::Io`]; the temporary file is gone then.
pub(super) fn write(
    path: &Path,
    fill: impl FnOnce(&mut BufWriter<File>) -> Result<()>,
) -> Result<()> {
    let io = |e| Error::io(path, e);
    let (temporary, file) = Temporary::create(path).map_err(io)?;
    let mut writer = BufWriter::new(file);
    fill(&mut writer)?;
    let file = writer.into_inner().map_err(|e| io(e.into_error()))?;
    // Without this a power cut soon after the rename could leave an empty file under the final name.
    file.sync_all().map_err(io)?;
    fs::rename(&temporary.path, path).map_err(io)
}

/// Checks that [`write()`] can begin at `path`: makes its temporary file, and removes it.
///
/// # Errors
/// [`Error::Io`].
pub(super) fn check(path: &Path) -> Result<()> {
    Temporary::create(path)
        .map(drop)
        .map_err(|e| Error::io(path, e))
}

/// Writes a file of known content.
///
/// # Errors
/// [`Error::Io`]; the file is then not there (or as it was before).
pub fn write_bytes(path: &Path, bytes: &[u8]) -> Result<()> {
    write(path, |file| {
        file.write_all(bytes).map_err(|e| Error::io(path, e))
    })
}

/// Removed when dropped, unless it was renamed away.
struct Temporary {
    path: PathBuf,
}

impl Temporary {
    /// An empty file in the folder of `path`.
    fn create(path: &Path) -> io::Result<(Self, File)> {
        let serial = SERIAL.fetch_add(1, Ordering::Relaxed);
        let mut name = std::ffi::OsString::from(".");
        name.push(path.file_name().unwrap_or_default());
        name.push(format!(".{}-{serial}.tmp", std::process::id()));
        let path = folder_of(path).join(name);
        let file = OpenOptions::new()
            .write(true)
            .create_new(true)
            .open(&path)?;
        Ok((Self { path }, file))
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        // After the rename there is nothing to remove; before it, the first error is the one to report.
        let _ = fs::remove_file(&self.path);
    }
}
