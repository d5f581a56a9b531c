//! Voxel types as the host stores them and as an atlas texel holds them.

use bytemuck::Pod;

/// A voxel type of [`super::Voxels`] and the texel that keeps its precision on the device.
///
/// "Stored" values are those of the file before rescale. Signed integers become unsigned texels by
/// adding half their range, because unsigned normalised formats are the ones that every device
/// samples.
pub(crate) trait Voxel: Pod + Send + Sync {
    /// What one atlas texel holds.
    type Texel: Pod + Send + Sync;

    /// The stored value; exact for every type.
    fn to_f32(self) -> f32;

    /// The texel of this very voxel.
    fn texel(self) -> Self::Texel;

    /// The texel nearest to a stored value.
    fn nearest_texel(stored: f64) -> Self::Texel;

    /// The stored value of a texel.
    fn stored(texel: Self::Texel) -> f32;

    /// Writes the texels of a row as bytes; `to` is as long as the row.
    fn write_row(row: &[Self], to: &mut [u8]);
}

macro_rules! unsigned_voxel {
    ($voxel:ty) => {
        impl Voxel for $voxel {
            type Texel = $voxel;

            fn to_f32(self) -> f32 {
                self.into()
            }

            fn texel(self) -> $voxel {
                self
            }

            fn nearest_texel(stored: f64) -> $voxel {
                (stored + 0.5) as $voxel
            }

            fn stored(texel: $voxel) -> f32 {
                texel.into()
            }

            fn write_row(row: &[Self], to: &mut [u8]) {
                to.copy_from_slice(bytemuck::cast_slice(row));
            }
        }
    };
}

macro_rules! signed_voxel {
    ($voxel:ty, $texel:ty) => {
        impl Voxel for $voxel {
            type Texel = $texel;

            fn to_f32(self) -> f32 {
                self.into()
            }

            fn texel(self) -> $texel {
                self.wrapping_sub(<$voxel>::MIN) as $texel
            }

            fn nearest_texel(stored: f64) -> $texel {
                (stored - f64::from(<$voxel>::MIN) + 0.5) as $texel
            }

            fn stored(texel: $texel) -> f32 {
                f32::from(texel) + f32::from(<$voxel>::MIN)
            }

            fn write_row(row: &[Self], to: &mut [u8]) {
                for (voxel, bytes) in row.iter().zip(to.chunks_exact_mut(size_of::<$texel>())) {
                    bytes.copy_from_slice(&voxel.texel().to_ne_bytes());
                }
            }
        }
    };
}

unsigned_voxel!(u8);
unsigned_voxel!(u16);
signed_voxel!(i8, u8);
signed_voxel!(i16, u16);

impl Voxel for f32 {
    type Texel = f32;

    fn to_f32(self) -> f32 {
        self
    }

    fn texel(self) -> f32 {
        self
    }

    fn nearest_texel(stored: f64) -> f32 {
        stored as f32
    }

    fn stored(texel: f32) -> f32 {
        texel
    }

    fn write_row(row: &[Self], to: &mut [u8]) {
        to.copy_from_slice(bytemuck::cast_slice(row));
    }
}

/// Runs an expression with the typed voxels of a [`super::Voxels`].
macro_rules! with_typed {
    ($voxels:expr, $typed:ident => $body:expr) => {
        match $voxels {
            $crate::volume::Voxels::U8($typed) => $body,
            $crate::volume::Voxels::I8($typed) => $body,
            $crate::volume::Voxels::U16($typed) => $body,
            $crate::volume::Voxels::I16($typed) => $body,
            $crate::volume::Voxels::F32($typed) => $body,
        }
    };
}
pub(crate) use with_typed;
