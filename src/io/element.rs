//! Number types of voxels in files.

use std::fmt;

use bytemuck::Pod;

/// Type of a stored voxel. Those wider than a [`Volume`](crate::volume::Volume) holds are narrowed exactly.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Element {
    U8,
    I8,
    U16,
    I16,
    U32,
    I32,
    U64,
    I64,
    F16,
    F32,
    F64,
}

impl Element {
    /// Bytes per voxel in the file.
    pub(super) const fn bytes(self) -> u64 {
        match self {
            Self::U8 | Self::I8 => 1,
            Self::U16 | Self::I16 | Self::F16 => 2,
            Self::U32 | Self::I32 | Self::F32 => 4,
            Self::U64 | Self::I64 | Self::F64 => 8,
        }
    }
}

impl fmt::Display for Element {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::U8 => "u8",
            Self::I8 => "i8",
            Self::U16 => "u16",
            Self::I16 => "i16",
            Self::U32 => "u32",
            Self::I32 => "i32",
            Self::U64 => "u64",
            Self::I64 => "i64",
            Self::F16 => "f16",
            Self::F32 => "f32",
            Self::F64 => "f64",
        })
    }
}

/// A number as it lies in a file.
pub(super) trait Stored: Pod {
    /// With its bytes in the other order.
    fn swapped(self) -> Self;
}

macro_rules! stored_integer {
    ($($t:ty)*) => {$(
        impl Stored for $t {
            fn swapped(self) -> Self {
                self.swap_bytes()
            }
        }
    )*};
}
stored_integer!(u8 i8 u16 i16 u32 i32 u64 i64);

impl Stored for half::f16 {
    fn swapped(self) -> Self {
        Self::from_bits(self.to_bits().swap_bytes())
    }
}

impl Stored for f32 {
    fn swapped(self) -> Self {
        Self::from_bits(self.to_bits().swap_bytes())
    }
}

impl Stored for f64 {
    fn swapped(self) -> Self {
        Self::from_bits(self.to_bits().swap_bytes())
    }
}
