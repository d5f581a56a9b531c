//! Readers of volume files: NRRD, NIfTI, MetaImage and headerless (RAW) data.
//!
//! A file is recognised by what it holds; its name is only a hint in messages. Voxels are decoded straight into
//! the array that the [`Volume`] keeps, in the file's own precision. Placement is converted to millimetres, LPS.
//! A new format is one module with a `recognise` and a `read`, and one line in [`FORMATS`].
#![deny(clippy::indexing_slicing)]

mod detached;
mod element;
mod grid;
mod metaimage;
mod narrow;
mod nifti;
mod nrrd;
mod payload;
mod raw;
mod source;
mod text;
mod text_data;

use std::path::Path;

use crate::error::{Error, Result};
use crate::scene::RawDescription;
use crate::volume::Volume;

/// What a caller may say about a file before it is read.
#[derive(Clone, Default)]
pub struct ReadOptions<'a> {
    /// What the header would have said. When given, the file is read as headerless, whatever it looks like.
    pub raw: Option<RawDescription>,
    /// The largest volume that is accepted.
    pub limits: Limits,
    /// Called now and then with the bytes of voxels read so far and in all.
    pub progress: Option<&'a dyn Fn(u64, u64)>,
}

/// What a header may ask for before it is called damaged or too large.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Most voxels.
    pub max_voxels: u64,
    /// Most bytes of voxels, as stored in the file (uncompressed).
    pub max_bytes: u64,
    /// Most bytes of a text header.
    pub max_header_bytes: u64,
}

impl Default for Limits {
    /// 16 Gi voxels, 16 GiB of them, 4 MiB of header.
    fn default() -> Self {
        Self {
            max_voxels: 16 << 30,
            max_bytes: 16 << 30,
            max_header_bytes: 4 << 20,
        }
    }
}

/// A kind of file that describes itself.
pub struct Format {
    /// What the format is called.
    pub name: &'static str,
    /// Usual endings of its files, without the dot. They decide nothing.
    pub extensions: &'static [&'static str],
    /// Whether a file is of this format, from its first [`HEAD_BYTES`] bytes (none for a folder) and its path.
    recognise: fn(&[u8], &Path) -> bool,
    read: fn(&Path, &ReadOptions<'_>) -> Result<Volume>,
}

/// How much of a file [`Format`]s are recognised by.
pub const HEAD_BYTES: usize = 4096;

/// Every format that is recognised by content, in the order of asking.
pub const FORMATS: &[Format] = &[nrrd::FORMAT, nifti::FORMAT, metaimage::FORMAT];

/// Reads a volume file.
///
/// # Errors
/// [`Error::Volume`] when the file is damaged, not of a known format, not one 3-D scalar grid, of a voxel type
/// that cannot be kept exactly, or larger than the limits; [`Error::Io`] when it cannot be opened or read;
/// [`Error::OutOfMemory`] when the voxels do not fit in host memory; [`Error::Invalid`] for a wrong
/// [`RawDescription`].
pub fn read(path: &Path, options: &ReadOptions<'_>) -> Result<Volume> {
    if let Some(description) = &options.raw {
        return raw::read(path, description, options);
    }
    let head = source::head(path, HEAD_BYTES)?;
    match FORMATS
        .iter()
        .find(|format| (format.recognise)(&head, path))
    {
        Some(format) => (format.read)(path, options),
        None => Err(unrecognised(path)),
    }
}

fn unrecognised(path: &Path) -> Error {
    let name = path.to_string_lossy().to_lowercase();
    let misnamed = FORMATS
        .iter()
        .find(|f| {
            f.extensions
                .iter()
                .any(|e| name.ends_with(&format!(".{e}")))
        })
        .map(|f| format!("its name says {}, its content does not; ", f.name))
        .unwrap_or_default();
    let known: Vec<String> = FORMATS
        .iter()
        .map(|f| format!("{} (.{})", f.name, f.extensions.join(", .")))
        .collect();
    Error::volume(
        path,
        format!(
            "not a volume of a known format: {misnamed}read are {}. A headerless file needs volume.raw in \
             the scene, for example {{\"size\": [256, 256, 128], \"type\": \"u16\", \"spacing\": [1, 1, 1], \
             \"endian\": \"little\", \"offset\": 0}}",
            known.join(", ")
        ),
    )
}
