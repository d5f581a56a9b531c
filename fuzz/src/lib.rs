//! One fuzz target for each reader, through the door that everyone uses: [`umbravox::io::read`] of a path.
//!
//! An input is one file, written into a folder in memory (`/dev/shm`), beside the data files that a detached header may
//! name. Whatever it holds, it is read within the limits or refused as bad input; everything else is a finding.

mod dicom;

use std::borrow::Cow;
use std::path::PathBuf;
use std::sync::LazyLock;

use libfuzzer_sys::Corpus;
use tempfile::TempDir;
use umbravox::io::{Limits, ReadOptions, read};
use umbravox::scene::{
    ColorManagement, Endian, RawDescription, RawType, TransferFile, TransferFormat,
};

/// Largest volume that an input may ask for, voxels: a fuzzer that spends its time on filling memory finds nothing.
const MAX_VOXELS: u64 = 1 << 18;

/// A reader, and the files that it shall be tried with.
pub struct Target {
    /// Whether a file belongs to this reader. Others are not kept in the corpus.
    wants: fn(&[u8]) -> bool,
    /// What is said about the file beside its content, from its first bytes.
    options: fn(&[u8]) -> ReadOptions<'static>,
    /// The file that an input stands for.
    file: fn(&[u8]) -> Cow<'_, [u8]>,
}

const fn by_content(wants: fn(&[u8]) -> bool) -> Target {
    Target {
        wants,
        options: |_| limited(),
        file: |data| Cow::Borrowed(data),
    }
}

/// `.nrrd` and `.nhdr`.
pub const NRRD: Target = by_content(|data| data.starts_with(b"NRRD000"));
/// `.nii`, `.nii.gz` and `.hdr`.
pub const NIFTI: Target = by_content(|data| {
    let magic = |at: usize| data.get(at..at + 2);
    is_gzip(data)
        || magic(344) == Some(b"n+")
        || magic(344) == Some(b"ni")
        || magic(4) == Some(b"n+")
});
/// `.mha` and `.mhd`.
pub const METAIMAGE: Target = by_content(|data| contains(data, b"NDims"));
/// One object, or a tar of a series.
pub const DICOM: Target = by_content(|data| contains(data, b"DICM"));
/// A tar of PNG or JPEG pictures.
pub const PICTURES: Target =
    by_content(|data| contains(data, b"\x89PNG") || contains(data, b"\xff\xd8\xff"));
/// Pages in one file, or a tar of files.
pub const TIFF: Target = by_content(|data| contains(data, b"II") || contains(data, b"MM"));
/// `.npy` and `.npz`.
pub const NUMPY: Target = by_content(|data| contains(data, b"NUMPY") || data.starts_with(b"PK"));
/// `.fits`.
pub const FITS: Target = by_content(|data| data.starts_with(b"SIMPLE  ="));
/// `.vti`.
pub const VTI: Target = by_content(|data| contains(data, b"<VTKFile"));
/// `.zip`, `.tar`, `.tar.gz` and `.tar.xz`.
pub const ARCHIVES: Target = by_content(|data| {
    data.starts_with(b"PK")
        || is_gzip(data)
        || data.starts_with(b"\xfd7zXZ")
        || contains(data, b"ustar")
});
/// `.vdb`.
pub const OPENVDB: Target = by_content(|data| data.starts_with(b" BDV"));
/// A tar of a Zarr store.
pub const ZARR: Target = by_content(|data| contains(data, b"zarr"));
/// One coded picture (JPEG, JPEG 2000, JPEG-LS, RLE), of which a good DICOM object is made: the first bytes are what its
/// header says of it.
pub const CODED_PIXELS: Target = Target {
    wants: |data| data.len() > dicom::HEADER_BYTES,
    options: |_| limited(),
    file: |data| Cow::Owned(dicom::object(data)),
};
/// Headerless data; the first bytes are the description.
pub const RAW: Target = Target {
    wants: |data| data.len() > 8,
    options: described,
    file: |data| Cow::Borrowed(data),
};

fn is_gzip(data: &[u8]) -> bool {
    data.starts_with(&[0x1f, 0x8b])
}

fn contains(data: &[u8], word: &[u8]) -> bool {
    data.windows(word.len()).any(|part| part == word)
}

fn limited() -> ReadOptions<'static> {
    ReadOptions {
        limits: Limits {
            max_voxels: MAX_VOXELS,
            max_bytes: 8 * MAX_VOXELS,
            max_header_bytes: 1 << 16,
            max_archive_bytes: 8 << 20,
            max_files: 64,
        },
        ..ReadOptions::default()
    }
}

fn described(data: &[u8]) -> ReadOptions<'static> {
    let byte = |at: usize| data.get(at).copied().unwrap_or_default();
    let types = [
        RawType::U8,
        RawType::I8,
        RawType::U16,
        RawType::I16,
        RawType::F32,
    ];
    let raw = RawDescription {
        size: [0, 1, 2].map(|at| u32::from(byte(at))),
        voxel_type: types[usize::from(byte(3)) % types.len()],
        spacing: [4, 5, 6].map(|at| f64::from(byte(at)) - 1.0),
        endian: if byte(3) & 0x80 == 0 {
            Endian::Little
        } else {
            Endian::Big
        },
        offset: u64::from(byte(7)),
    };
    ReadOptions {
        raw: Some(raw),
        ..limited()
    }
}

/// The folder of this process, with data files for detached headers.
static FOLDER: LazyLock<TempDir> = LazyLock::new(|| {
    let folder = TempDir::new_in("/dev/shm").expect("a folder in memory");
    for name in ["x.raw", "input.img"] {
        std::fs::write(folder.path().join(name), vec![7; 4096]).expect("a data file");
    }
    folder
});

/// Reads one input as a file.
///
/// # Panics
/// On a finding.
pub fn run(target: &Target, data: &[u8]) -> Corpus {
    if !(target.wants)(data) {
        return Corpus::Reject;
    }
    let path: PathBuf = FOLDER.path().join("input.hdr");
    std::fs::write(&path, (target.file)(data)).expect("room in memory");
    match read(&path, &(target.options)(data)) {
        Ok(volume) => assert!(volume.voxels().len() as u64 <= MAX_VOXELS),
        Err(error) => assert!(error.is_bad_input(), "{error}"),
    }
    Corpus::Keep
}

/// Reads one input as a transfer function. What is read can be written, and what is written can be read.
///
/// # Panics
/// On a finding.
pub fn run_transfer_function(data: &[u8]) -> Corpus {
    let Ok(text) = std::str::from_utf8(data) else {
        return Corpus::Reject;
    };
    let Ok(file) = TransferFile::parse(text, "input") else {
        return Corpus::Keep;
    };
    for management in [ColorManagement::Linear, ColorManagement::None] {
        for (name, format) in TransferFormat::ALL {
            let written = file.to_text(format, "input", management);
            if let Err(error) = TransferFile::parse(&written, name) {
                panic!("{error}\n{written}");
            }
        }
    }
    Corpus::Keep
}

/// The program of a target.
#[macro_export]
macro_rules! reader {
    ($target:ident) => {
        libfuzzer_sys::fuzz_target!(|data: &[u8]| -> libfuzzer_sys::Corpus {
            $crate::run(&$crate::$target, data)
        });
    };
}
