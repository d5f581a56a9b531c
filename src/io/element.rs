//! Number types of voxels in files.

use std::fmt;

use bytemuck::Pod;

use crate::scene::Endian;

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

/// Type names of NumPy without the byte order, as Zarr has them too.
pub(super) const NUMPY_TYPES: [(&str, Element); 12] = [
    ("b1", Element::U8),
    ("u1", Element::U8),
    ("i1", Element::I8),
    ("u2", Element::U16),
    ("i2", Element::I16),
    ("u4", Element::U32),
    ("i4", Element::I32),
    ("u8", Element::U64),
    ("i8", Element::I64),
    ("f2", Element::F16),
    ("f4", Element::F32),
    ("f8", Element::F64),
];

/// Byte orders of NumPy type names; `|` is of single bytes.
pub(super) const NUMPY_ORDERS: [(&str, Endian); 3] = [
    ("<", Endian::Little),
    ("|", Endian::Little),
    (">", Endian::Big),
];

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

/// A colour, byte by byte.
impl Stored for [u8; 4] {
    fn swapped(self) -> Self {
        self
    }
}

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
