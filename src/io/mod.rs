//! Readers of volume files.

use std::path::Path;

use crate::error::{Error, Result};
use crate::scene::RawDescription;
use crate::volume::Volume;

/// How to read.
#[derive(Clone, Debug, Default)]
pub struct ReadOptions {
    /// Of a headerless file.
    pub raw: Option<RawDescription>,
}

/// Reads a volume.
pub fn read(path: &Path, _options: &ReadOptions) -> Result<Volume> {
    std::fs::metadata(path).map_err(|e| Error::io(path, e))?;
    Err(Error::volume(path, "not a volume"))
}
