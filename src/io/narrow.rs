//! Voxel types wider than a volume holds, narrowed without changing a value.

use std::path::Path;

use super::element::{Element, Stored};
use super::payload::reserve;
use super::source::bad;
use crate::error::{Error, Result};
use crate::volume::Voxels;

/// A stored number that a volume does not hold as it is.
pub(super) trait Wide: Stored + std::fmt::Display {
    /// The same value, if the type has it.
    fn to_u16(self) -> Option<u16>;
    /// The same value, if the type has it.
    fn to_i16(self) -> Option<i16>;
    /// The same value (NaN for NaN), if the type has it.
    fn to_f32(self) -> Option<f32>;
}

macro_rules! wide_integer {
    ($($t:ty)*) => {$(
        impl Wide for $t {
            fn to_u16(self) -> Option<u16> {
                self.try_into().ok()
            }

            fn to_i16(self) -> Option<i16> {
                self.try_into().ok()
            }

            fn to_f32(self) -> Option<f32> {
                let nearest = self as f32;
                (nearest as i128 == i128::from(self)).then_some(nearest)
            }
        }
    )*};
}
wide_integer!(u32 i32 u64 i64);

/// Halves stay floats: their 16 bits are not those of an integer.
impl Wide for half::f16 {
    fn to_u16(self) -> Option<u16> {
        None
    }

    fn to_i16(self) -> Option<i16> {
        None
    }

    fn to_f32(self) -> Option<f32> {
        Some(Self::to_f32(self))
    }
}

impl Wide for f64 {
    fn to_u16(self) -> Option<u16> {
        let nearest = self as u16;
        (Self::from(nearest) == self).then_some(nearest)
    }

    fn to_i16(self) -> Option<i16> {
        let nearest = self as i16;
        (Self::from(nearest) == self).then_some(nearest)
    }

    fn to_f32(self) -> Option<f32> {
        let nearest = self as f32;
        (Self::from(nearest) == self || self.is_nan()).then_some(nearest)
    }
}

/// The first of u16, i16 and f32 that holds every voxel so far.
///
/// Growing as values come, and not reading the wide array first, keeps memory at what the result needs, and at
/// one and a half times that where 16 bits turn out to be too few.
pub(super) enum Narrowed {
    U16(Vec<u16>),
    I16(Vec<i16>),
    F32(Vec<f32>),
}

impl Narrowed {
    /// Empty, with room for `count` voxels.
    pub(super) fn new(count: usize) -> Result<Self> {
        Ok(Self::U16(reserve(count)?))
    }

    /// Takes in all values of a chunk. Gives back the place of the first that not even f32 holds.
    pub(super) fn extend<T: Wide>(&mut self, values: &[T], count: usize) -> Result<Option<usize>> {
        let mut taken = 0;
        while let Some(rest @ [_, ..]) = values.get(taken..) {
            taken += match self {
                Self::U16(held) => extend_while(held, rest, T::to_u16),
                Self::I16(held) => extend_while(held, rest, T::to_i16),
                Self::F32(held) => extend_while(held, rest, T::to_f32),
            };
            match (values.get(taken), &self) {
                (None, _) => break,
                (Some(_), Self::F32(_)) => return Ok(Some(taken)),
                (Some(&refused), _) => self.widen(refused, count)?,
            }
        }
        Ok(None)
    }

    /// Changes to a type that also has values like `refused`.
    fn widen<T: Wide>(&mut self, refused: T, count: usize) -> Result<()> {
        *self = match std::mem::replace(self, Self::F32(Vec::new())) {
            Self::U16(held)
                if refused.to_i16().is_some() && held.iter().all(|&v| v <= i16::MAX as u16) =>
            {
                // Collecting into the same layout reuses the allocation; the capacity stays.
                Self::I16(held.into_iter().map(|v| v as i16).collect())
            }
            Self::U16(held) => Self::F32(widened(&held, count)?),
            Self::I16(held) => Self::F32(widened(&held, count)?),
            wide @ Self::F32(_) => wide,
        };
        Ok(())
    }

    pub(super) fn into_voxels(self) -> Voxels {
        match self {
            Self::U16(held) => Voxels::U16(held),
            Self::I16(held) => Voxels::I16(held),
            Self::F32(held) => Voxels::F32(held),
        }
    }
}

/// A whole array, narrowed.
#[cfg(any(feature = "vdb", feature = "zarr"))]
pub(super) fn narrowed<T: Wide>(path: &Path, element: Element, values: Vec<T>) -> Result<Voxels> {
    let mut narrow = Narrowed::new(values.len())?;
    match narrow.extend(&values, values.len())? {
        None => Ok(narrow.into_voxels()),
        Some(at) => Err(not_exact(path, at, values.get(at), element)),
    }
}

/// Says which value no type of a volume holds.
pub(super) fn not_exact<T: Wide>(
    path: &Path,
    voxel: usize,
    value: Option<&T>,
    element: Element,
) -> Error {
    let value = value.map(T::to_string).unwrap_or_default();
    bad(
        path,
        format!(
            "voxel {voxel} of type {element} is {value}, which a 32-bit float cannot hold exactly; \
             convert the file to u8, i8, u16, i16 or f32"
        ),
    )
}

/// Appends converted values up to the first that does not convert; how many were taken.
fn extend_while<T: Copy, N>(
    held: &mut Vec<N>,
    values: &[T],
    convert: impl Fn(T) -> Option<N>,
) -> usize {
    let before = held.len();
    held.extend(values.iter().map_while(|&v| convert(v)));
    held.len() - before
}

fn widened<N: Copy + Into<f32>>(held: &[N], count: usize) -> Result<Vec<f32>> {
    let mut wide = reserve(count)?;
    wide.extend(held.iter().map(|&v| v.into()));
    Ok(wide)
}
