//! Readers of volume files, against files written byte by byte and against independent readers.

#[cfg(feature = "formats")]
mod chunked;
mod colors;
#[cfg(feature = "formats")]
mod independent;
mod metadata;
mod metaimage;
mod nifti;
mod nrrd;
mod parts;
mod raw;
mod shipped;
#[cfg(feature = "formats")]
mod sparse;

use std::io::Write;
use std::path::{Path, PathBuf};

use glam::{DAffine3, DVec3};
use umbravox::io::{ReadOptions, read};
use umbravox::volume::{Volume, VoxelType};

/// Different on every axis, so that no two can be mixed up.
const SIZE: [u32; 3] = [3, 4, 5];
const COUNT: usize = 60;

/// A voxel type of a file.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    U8,
    I8,
    U16,
    I16,
    U32,
    I32,
    U64,
    I64,
    F32,
    F64,
}

impl Kind {
    const ALL: [Self; 10] = [
        Self::U8,
        Self::I8,
        Self::U16,
        Self::I16,
        Self::U32,
        Self::I32,
        Self::U64,
        Self::I64,
        Self::F32,
        Self::F64,
    ];

    /// 60 values that use the type's range, and the type that a volume of them must have.
    fn content(self) -> (Vec<f64>, VoxelType) {
        let (first, step, read_as) = match self {
            Self::U8 => (2.0, 4.0, VoxelType::U8),
            Self::I8 => (-120.0, 4.0, VoxelType::I8),
            Self::U16 => (5.0, 1000.0, VoxelType::U16),
            Self::I16 => (-30000.0, 1001.0, VoxelType::I16),
            Self::U32 => (40000.0, 3.0, VoxelType::U16),
            // Positive at first, so that the reader must change its mind.
            Self::I32 => (30000.0, -1001.0, VoxelType::I16),
            Self::U64 => (7.0, 70001.0, VoxelType::F32),
            Self::I64 => (40000.0, -1001.0, VoxelType::F32),
            Self::F32 => (-5.25, 0.37, VoxelType::F32),
            Self::F64 => (-3.0, 0.25, VoxelType::F32),
        };
        let values = (0..COUNT).map(|i| {
            let value = first + step * i as f64;
            if self == Self::F32 {
                f64::from(value as f32)
            } else {
                value
            }
        });
        (values.collect(), read_as)
    }

    /// One value as it lies in a file.
    fn bytes(self, value: f64, big: bool) -> Vec<u8> {
        macro_rules! bytes {
            ($t:ty) => {{
                let value = value as $t;
                if big {
                    value.to_be_bytes().to_vec()
                } else {
                    value.to_le_bytes().to_vec()
                }
            }};
        }
        match self {
            Self::U8 => bytes!(u8),
            Self::I8 => bytes!(i8),
            Self::U16 => bytes!(u16),
            Self::I16 => bytes!(i16),
            Self::U32 => bytes!(u32),
            Self::I32 => bytes!(i32),
            Self::U64 => bytes!(u64),
            Self::I64 => bytes!(i64),
            Self::F32 => bytes!(f32),
            Self::F64 => bytes!(f64),
        }
    }

    /// All of [`Kind::content`] as it lies in a file.
    fn data(self, big: bool) -> Vec<u8> {
        let (values, _) = self.content();
        values.iter().flat_map(|&v| self.bytes(v, big)).collect()
    }
}

/// A folder that goes away with the test.
struct Scratch(tempfile::TempDir);

impl Scratch {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn file(&self, name: &str, bytes: &[u8]) -> PathBuf {
        let path = self.0.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(&path, bytes).unwrap();
        path
    }
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

fn zlib(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::best());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

fn open(path: &Path) -> Volume {
    read(path, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}"))
}

/// Voxels as stored, x fastest.
fn stored(volume: &Volume) -> Vec<f64> {
    (0..volume.voxels().len())
        .map(|i| volume.voxels().get(i))
        .collect()
}

/// Checks size, type and every voxel.
#[track_caller]
fn assert_holds(volume: &Volume, kind: Kind) {
    let (values, read_as) = kind.content();
    assert_eq!(volume.size(), SIZE, "{kind:?}");
    assert_eq!(volume.voxels().voxel_type(), read_as, "{kind:?}");
    assert_eq!(stored(volume), values, "{kind:?}");
    // x is fastest: voxel (2,1,3) is number 2 + 3 (1 + 4 * 3).
    let at = volume.voxels().get(volume.offset(2, 1, 3));
    assert_eq!(at, values[41], "{kind:?}");
}

/// Checks the world step along each index axis and the position of voxel (0,0,0).
#[track_caller]
fn assert_placed(volume: &Volume, steps: [[f64; 3]; 3], origin: [f64; 3], tolerance: f64) {
    let [x, y, z] = steps.map(DVec3::from);
    let wanted = DAffine3::from_cols(x, y, z, origin.into());
    assert!(
        volume.world_from_ix().abs_diff_eq(wanted, tolerance),
        "{}\nis not\n{wanted}",
        volume.world_from_ix()
    );
}

/// Checks that a file is bad input, and that the message names the file and every one of `words`.
#[track_caller]
fn assert_refused(path: &Path, options: &ReadOptions<'_>, words: &[&str]) {
    let error = match read(path, options) {
        Ok(volume) => panic!("{path:?} was read: {:?}, wanted {words:?}", volume.size()),
        Err(error) => error,
    };
    let message = error.to_string();
    assert!(error.is_bad_input(), "{message}");
    for word in words {
        assert!(message.contains(word), "{message:?} does not say {word:?}");
    }
}
