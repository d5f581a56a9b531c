//! The table of formats.

use std::path::Path;

use super::bundle::Bundle;
use super::{ReadOptions, metaimage, nifti, nrrd};
use crate::error::{Error, Result};
use crate::volume::Volume;

/// Every format that is recognised by content, in the order of asking.
pub const FORMATS: &[Format] = &[
    // Known by the names of its files alone; others look into each.
    #[cfg(feature = "zarr")]
    super::zarr::FORMAT,
    nrrd::FORMAT,
    nifti::FORMAT,
    metaimage::FORMAT,
    #[cfg(feature = "dicom")]
    super::dicom::FORMAT,
    #[cfg(feature = "image-stacks")]
    super::pictures::FORMAT,
    #[cfg(feature = "image-stacks")]
    super::tiff::FORMAT,
    super::numpy::FORMAT,
    super::fits::FORMAT,
    super::vti::FORMAT,
    #[cfg(feature = "vdb")]
    super::vdb::FORMAT,
];

/// A kind of file, or of files that make a volume together.
pub struct Format {
    /// What the format is called.
    pub name: &'static str,
    /// Usual endings of its files, without the dot. They decide nothing.
    pub extensions: &'static [&'static str],
    /// What of it is read, in a few words.
    pub reads: &'static str,
    /// How one file of it is told and read.
    pub(super) file: Option<FileReader>,
    /// How a folder or archive of it is told and read.
    pub(super) bundle: Option<BundleReader>,
}

pub(super) type ReadFile = fn(&Path, &ReadOptions<'_>) -> Result<Volume>;
type ReadBundle = fn(&Bundle, &ReadOptions<'_>) -> Result<Volume>;

pub(super) struct FileReader {
    /// Whether a file is of this format, from its first [`HEAD_BYTES`](super::HEAD_BYTES) bytes and its path.
    pub(super) recognise: fn(&[u8], &Path) -> bool,
    pub(super) read: ReadFile,
}

pub(super) struct BundleReader {
    pub(super) recognise: fn(&Bundle) -> bool,
    pub(super) read: ReadBundle,
}

impl Format {
    /// Whether a folder or an archive of such files is read.
    pub const fn reads_folders(&self) -> bool {
        self.bundle.is_some()
    }

    /// Whether one file of it is enough.
    pub const fn reads_files(&self) -> bool {
        self.file.is_some()
    }

    pub(super) fn file_reader(&self, head: &[u8], path: &Path) -> Option<ReadFile> {
        let reader = self.file.as_ref()?;
        (reader.recognise)(head, path).then_some(reader.read)
    }

    pub(super) fn bundle_reader(&self, bundle: &Bundle) -> Option<ReadBundle> {
        let reader = self.bundle.as_ref()?;
        (reader.recognise)(bundle).then_some(reader.read)
    }
}

/// The reader of a file, from its first bytes and its path.
pub(super) fn file_reader(head: &[u8], path: &Path) -> Option<ReadFile> {
    FORMATS.iter().find_map(|f| f.file_reader(head, path))
}

pub(super) fn unrecognised(path: &Path) -> Error {
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

pub(super) fn unrecognised_bundle(bundle: &Bundle) -> Error {
    let known: Vec<&str> = FORMATS
        .iter()
        .filter(|f| f.reads_folders())
        .map(|f| f.name)
        .collect();
    let some: Vec<&str> = bundle.members().iter().take(3).map(|m| m.name()).collect();
    let holds = match bundle.members().len() {
        0 => "it holds no files".to_owned(),
        count => format!("it holds {count} files ({}, …)", some.join(", ")),
    };
    Error::volume(
        bundle.path(),
        format!(
            "not a volume in several files: {holds}; read are folders and archives of {}",
            known.join(", ")
        ),
    )
}
