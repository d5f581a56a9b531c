//! Readers of volume files; [`FORMATS`] lists them.
//!
//! A file is recognised by what it holds; its name is only a hint in messages. Voxels are decoded straight into
//! the array that the [`Volume`] keeps, in the file's own precision. Placement is converted to millimetres, LPS.
//! A new format is one module with a [`Format`], and one line in [`FORMATS`].
#![deny(clippy::indexing_slicing)]

#[cfg(feature = "archives")]
mod archive;
#[cfg(feature = "blosc")]
mod blosc;
#[cfg_attr(
    not(feature = "formats"),
    allow(dead_code, reason = "each reader of several files is a feature")
)]
mod bundle;
mod components;
mod decoded;
mod detached;
#[cfg(feature = "dicom")]
mod dicom;
mod element;
mod fits;
mod formats;
mod grid;
#[cfg(feature = "dicom")]
mod jpeg_size;
mod metaimage;
mod named_raw;
mod narrow;
mod nifti;
mod nrrd;
mod numpy;
#[cfg(feature = "archives")]
mod packed;
mod parts;
mod payload;
#[cfg(feature = "image-stacks")]
mod pictures;
mod raw;
mod refused;
mod reorder;
#[cfg(feature = "image-stacks")]
mod slices;
mod source;
mod text;
mod text_data;
#[cfg(feature = "image-stacks")]
mod tiff;
mod transparent;
mod units;
#[cfg(feature = "vdb")]
mod vdb;
mod vti;
#[cfg(any(feature = "dicom", feature = "image-stacks"))]
mod watched;
#[cfg(feature = "archives")]
mod xz_claims;
#[cfg(feature = "zarr")]
mod zarr;

use std::path::Path;

use bundle::Bundle;
pub use formats::{FORMATS, Format};

use crate::error::{Error, Result};
use crate::scene::{LabelSource, RawDescription, VolumeColor, VolumeSource};
use crate::volume::{LabelMap, Volume};

/// What a caller may say about a file before it is read.
#[derive(Clone, Default)]
pub struct ReadOptions<'a> {
    /// What the header would have said. When given, the file is read as headerless, whatever it looks like.
    pub raw: Option<RawDescription>,
    /// Which series of a DICOM folder: its UID, its number, or the start of its description. Default: the largest.
    /// Which grid of an OpenVDB file, which image of an OME-Zarr: its name. Default: the first. Which file of an archive of
    /// several volumes: its name; there is no default.
    pub series: Option<String>,
    /// Which volume of a file that holds several, from 0. Default: the first.
    pub timestep: Option<u32>,
    /// Which component of a voxel that has several, from 0. Default: the first; all of colours.
    pub channel: Option<u32>,
    /// Whether voxels that are colours of 8 bits are read so, or as one number. Default: as colours, unless a channel is
    /// asked for.
    pub color: Option<VolumeColor>,
    /// Which resolution of a file that has several, from 0, the finest. Default: the finest within the limits.
    pub level: Option<u32>,
    /// Refuse what would have to be resampled or guessed.
    pub strict: bool,
    /// The largest volume that is accepted.
    pub limits: Limits,
    /// Called now and then with the bytes of voxels read so far and in all.
    pub progress: Option<&'a dyn Fn(u64, u64)>,
}

impl From<&VolumeSource> for ReadOptions<'_> {
    /// What a scene says, with default limits.
    fn from(source: &VolumeSource) -> Self {
        Self {
            raw: source.raw.clone(),
            series: source.series.clone(),
            timestep: source.timestep,
            channel: source.channel,
            color: source.color,
            level: source.level,
            strict: source.strict,
            ..Self::default()
        }
    }
}

impl From<&LabelSource> for ReadOptions<'_> {
    /// What a scene says, with default limits.
    fn from(source: &LabelSource) -> Self {
        Self {
            series: source.series.clone(),
            channel: source.channel,
            ..Self::default()
        }
    }
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
    /// Most bytes of an archive's unpacked files.
    pub max_archive_bytes: u64,
    /// Most files of a folder or an archive.
    pub max_files: usize,
}

impl Default for Limits {
    /// 16 Gi voxels, 16 GiB of them, 4 MiB of header; archives of 8 GiB, 200,000 files.
    fn default() -> Self {
        Self {
            max_voxels: 16 << 30,
            max_bytes: 16 << 30,
            max_header_bytes: 4 << 20,
            max_archive_bytes: 8 << 30,
            max_files: 200_000,
        }
    }
}

/// How much of a file [`Format`]s are recognised by.
const HEAD_BYTES: usize = 4096;

/// Reads a volume: a file, a folder of files, or an archive of them.
///
/// # Errors
/// [`Error::Volume`] when the file is damaged, not of a known format, not one 3-D scalar grid, of a voxel type
/// that cannot be kept exactly, or larger than the limits; [`Error::Io`] when it cannot be opened or read;
/// [`Error::OutOfMemory`] when the voxels do not fit in host memory; [`Error::Invalid`] for a wrong
/// [`RawDescription`].
///
/// [`Error::Volume`]: crate::error::Error::Volume
/// [`Error::Io`]: crate::error::Error::Io
/// [`Error::OutOfMemory`]: crate::error::Error::OutOfMemory
/// [`Error::Invalid`]: crate::error::Error::Invalid
pub fn read(path: &Path, options: &ReadOptions<'_>) -> Result<Volume> {
    if let Some(description) = &options.raw {
        return raw::read(path, description, options);
    }
    if path.is_dir() {
        return read_bundle(&Bundle::folder(path, &options.limits)?, options);
    }
    #[cfg(feature = "archives")]
    {
        let head = source::head(path, HEAD_BYTES)?;
        let plain = reader_of(&head, path).is_some();
        if let Some(archive) = archive::Kind::of(&head).filter(|_| !plain) {
            let bundle = archive.unpack(path, &options.limits)?;
            return match FORMATS.iter().find_map(|f| f.bundle_reader(&bundle)) {
                Some(read) => read(&bundle, options),
                None => packed::read(&bundle, options),
            };
        }
    }
    read_file(path, options)
}

/// The volume of a scene: read from its file, or computed.
///
/// # Errors
/// As [`read`] and [`crate::scene::Procedural::volume`].
pub fn volume_of(source: &VolumeSource, options: &ReadOptions<'_>) -> Result<Volume> {
    match &source.procedural {
        Some(procedural) => procedural.volume(),
        None => read(&source.path, options),
    }
}

/// Reads a label map: a volume with a whole number at each voxel.
///
/// # Errors
/// As [`read`], and [`Error::Volume`] for values that are no labels.
///
/// [`Error::Volume`]: crate::error::Error::Volume
pub fn read_labels(path: &Path, options: &ReadOptions<'_>) -> Result<LabelMap> {
    LabelMap::new(&read(path, options)?).map_err(|e| match e {
        Error::Invalid { message, .. } => Error::volume(path, message),
        other => other,
    })
}

/// Reads one file that is no archive.
fn read_file(path: &Path, options: &ReadOptions<'_>) -> Result<Volume> {
    let head = source::head(path, HEAD_BYTES)?;
    match reader_of(&head, path) {
        Some(Reader::Format(read)) => read(path, options),
        Some(Reader::Raw(name)) => named_raw::read(path, &name, options),
        None => Err(refused::why(path, &head).unwrap_or_else(|| formats::unrecognised(path))),
    }
}

/// How a file is read.
enum Reader {
    Format(formats::ReadFile),
    /// Headerless, of a name that says what it is.
    Raw(named_raw::Name),
}

/// By content, else by a name that describes it.
fn reader_of(head: &[u8], path: &Path) -> Option<Reader> {
    let format = formats::file_reader(head, path).map(Reader::Format);
    format.or_else(|| named_raw::Name::of(path).map(Reader::Raw))
}

fn read_bundle(bundle: &Bundle, options: &ReadOptions<'_>) -> Result<Volume> {
    match FORMATS.iter().find_map(|f| f.bundle_reader(bundle)) {
        Some(read) => read(bundle, options),
        None => Err(formats::unrecognised_bundle(bundle)),
    }
}
