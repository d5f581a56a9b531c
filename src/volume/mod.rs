//! The host's model of a scalar volume: voxels, geometry, blocks, levels of detail.
//!
//! A voxel value sits at a point. The field is defined between the first and the last voxel centre on each
//! axis, and nothing is sampled outside. Index space (`_ix`) counts voxels: voxel `(i,j,k)` sits at `(i,j,k)`.
//! World space (`_ws`) is patient/physical space in millimetres, LPS.

pub mod blocks;
pub mod bricks;
pub mod cells;
mod color;
mod filter;
mod fingerprint;
mod labels;
pub mod layout;
pub mod leaps;
mod metadata;
pub mod select;
pub mod shown_cells;
pub mod statistics;
mod summary;
mod texel;
mod thin;
mod value_counts;
pub mod visible_ranges;
mod voxel_ranges;

pub use color::linear_from_srgb;
pub(crate) use fingerprint::hexadecimal;
pub use labels::{LabelIndices, LabelMap, MAX_LABELS};
pub use metadata::{Content, Metadata};
pub use summary::{HISTOGRAM_BINS, Histogram, Percentiles, Summary};
pub(crate) use texel::{Voxel, with_typed};
pub(crate) use voxel_ranges::Envelope;

use std::sync::Arc;

use glam::{DAffine3, DVec3};

use crate::error::{Error, Result};
use value_counts::ValueCounts;

/// Number of voxels on each axis below which a volume encloses no space.
pub const MIN_SIZE: u32 = 2;

/// How a voxel is stored, in files and on the device.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum VoxelType {
    /// Unsigned 8-bit.
    U8,
    /// Signed 8-bit.
    I8,
    /// Unsigned 16-bit.
    U16,
    /// Signed 16-bit.
    I16,
    /// 32-bit float.
    F32,
}

impl VoxelType {
    /// Every type.
    pub const ALL: [Self; 5] = [Self::U8, Self::I8, Self::U16, Self::I16, Self::F32];

    /// Bytes per voxel.
    pub const fn bytes(self) -> usize {
        match self {
            Self::U8 | Self::I8 => 1,
            Self::U16 | Self::I16 => 2,
            Self::F32 => 4,
        }
    }

    /// The name used in scene files and listings.
    pub const fn name(self) -> &'static str {
        match self {
            Self::U8 => "u8",
            Self::I8 => "i8",
            Self::U16 => "u16",
            Self::I16 => "i16",
            Self::F32 => "f32",
        }
    }
}

/// Voxels in file precision, x fastest, then y, then z; tightly packed.
#[derive(Clone, Debug, PartialEq)]
pub enum Voxels {
    /// Unsigned 8-bit.
    U8(Vec<u8>),
    /// Signed 8-bit.
    I8(Vec<i8>),
    /// Unsigned 16-bit.
    U16(Vec<u16>),
    /// Signed 16-bit.
    I16(Vec<i16>),
    /// 32-bit float; always finite inside a [`Volume`].
    F32(Vec<f32>),
}

impl Voxels {
    /// The type of each voxel.
    pub fn voxel_type(&self) -> VoxelType {
        match self {
            Self::U8(_) => VoxelType::U8,
            Self::I8(_) => VoxelType::I8,
            Self::U16(_) => VoxelType::U16,
            Self::I16(_) => VoxelType::I16,
            Self::F32(_) => VoxelType::F32,
        }
    }

    /// Number of voxels.
    pub fn len(&self) -> usize {
        match self {
            Self::U8(v) => v.len(),
            Self::I8(v) => v.len(),
            Self::U16(v) => v.len(),
            Self::I16(v) => v.len(),
            Self::F32(v) => v.len(),
        }
    }

    /// True when there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// One voxel as stored (before rescale).
    pub fn get(&self, at: usize) -> f64 {
        match self {
            Self::U8(v) => v[at].into(),
            Self::I8(v) => v[at].into(),
            Self::U16(v) => v[at].into(),
            Self::I16(v) => v[at].into(),
            Self::F32(v) => v[at].into(),
        }
    }
}

/// `value = slope * stored + intercept`: from stored voxels to the file's own units (Hounsfield in CT).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rescale {
    /// Factor; finite and not 0. Default 1.
    pub slope: f64,
    /// Offset; finite. Default 0.
    pub intercept: f64,
}

impl Rescale {
    /// Range of values, ascending, of a range of stored voxels.
    pub fn range(self, stored: [f32; 2]) -> [f64; 2] {
        let [a, b] = stored.map(|s| self.slope * f64::from(s) + self.intercept);
        [a.min(b), a.max(b)]
    }
}

impl Default for Rescale {
    fn default() -> Self {
        Self {
            slope: 1.0,
            intercept: 0.0,
        }
    }
}

/// A scalar field on a regular grid, placed in the world.
#[derive(Clone, Debug)]
pub struct Volume {
    voxels: Voxels,
    size: [u32; 3],
    world_from_ix: DAffine3,
    rescale: Rescale,
    stored_range: [f64; 2],
    /// Voxels that were NaN or infinite and were set to the smallest finite value.
    non_finite: u64,
    metadata: Metadata,
    labels: Option<Arc<LabelMap>>,
    /// Display colours of the voxels.
    colors: Option<Vec<[u8; 4]>>,
    /// See [`Volume::value_counts`].
    counts: ValueCounts,
}

impl Volume {
    /// Checks and takes ownership of a grid.
    ///
    /// NaN and infinite voxels become the smallest finite value; [`Volume::non_finite`] counts them.
    ///
    /// # Errors
    /// [`Error::Invalid`] when an axis has fewer than two voxels, the voxel count does not match `size`, the
    /// placement is singular or not finite, the rescale slope is 0 or not finite, or no voxel is finite.
    pub fn new(
        mut voxels: Voxels,
        size: [u32; 3],
        world_from_ix: DAffine3,
        rescale: Rescale,
    ) -> Result<Self> {
        for (axis, n) in ["x", "y", "z"].iter().zip(size) {
            if n < MIN_SIZE {
                return Err(Error::invalid(
                    format!("volume size {axis}"),
                    format!(
                        "{n} voxel(s) on this axis enclose no space; at least {MIN_SIZE} are needed"
                    ),
                ));
            }
        }
        let count = size
            .iter()
            .try_fold(1usize, |n, &s| n.checked_mul(s as usize));
        if count != Some(voxels.len()) {
            return Err(Error::invalid(
                "volume size",
                format!("{size:?} does not match the {} voxels given", voxels.len()),
            ));
        }
        let det = world_from_ix.matrix3.determinant();
        if !(world_from_ix.is_finite()
            && det.is_finite()
            && det != 0.0
            && world_from_ix.inverse().is_finite())
        {
            return Err(Error::invalid(
                "volume placement",
                format!(
                    "spacing and directions must be finite and span space, got {world_from_ix}"
                ),
            ));
        }
        if !rescale.slope.is_finite() || rescale.slope == 0.0 || !rescale.intercept.is_finite() {
            return Err(Error::invalid(
                "volume rescale",
                format!(
                    "slope must be finite and not 0, intercept finite; got slope {}, intercept {}",
                    rescale.slope, rescale.intercept
                ),
            ));
        }
        let (stored_range, non_finite) = finite_range(&mut voxels)?;
        Ok(Self {
            voxels,
            size,
            world_from_ix,
            rescale,
            stored_range,
            non_finite,
            metadata: Metadata::default(),
            labels: None,
            colors: None,
            counts: ValueCounts::default(),
        })
    }

    /// Axis-aligned grid with voxel (0,0,0) at the world origin; `spacing` in mm.
    ///
    /// # Errors
    /// As [`Volume::new`].
    pub fn axis_aligned(voxels: Voxels, size: [u32; 3], spacing: [f64; 3]) -> Result<Self> {
        Self::new(
            voxels,
            size,
            DAffine3::from_scale(DVec3::from_array(spacing)),
            Rescale::default(),
        )
    }

    /// The same volume, with what its file says of it.
    pub fn with_metadata(self, metadata: Metadata) -> Self {
        Self { metadata, ..self }
    }

    /// What its file says of it; nothing by default.
    pub fn metadata(&self) -> &Metadata {
        &self.metadata
    }

    /// The same volume, with a segmentation of it; `None`: without.
    ///
    /// # Errors
    /// [`Error::Invalid`] when the two lie apart.
    pub fn with_labels(self, labels: Option<Arc<LabelMap>>) -> Result<Self> {
        if let Some(map) = &labels {
            map.check_overlap(&self)?;
        }
        Ok(Self { labels, ..self })
    }

    /// The same volume, with a display colour for each voxel: red, green, blue, and a byte that is not looked at; `None`:
    /// without.
    ///
    /// # Errors
    /// [`Error::Invalid`] when there are not as many colours as voxels.
    pub fn with_colors(self, colors: Option<Vec<[u8; 4]>>) -> Result<Self> {
        let (have, want) = (colors.as_ref().map(Vec::len), self.voxels.len());
        if have.is_some_and(|have| have != want) {
            let message = format!("{} for {want} voxels", have.unwrap_or_default());
            return Err(Error::invalid("volume colours", message));
        }
        Ok(Self { colors, ..self })
    }

    /// Display colours of the voxels, in their order, where the data have their own. The values still make the opacity.
    pub fn colors(&self) -> Option<&[[u8; 4]]> {
        self.colors.as_deref()
    }

    /// The segmentation beside it.
    pub fn labels(&self) -> Option<&Arc<LabelMap>> {
        self.labels.as_ref()
    }

    /// Voxels as stored, x fastest.
    pub fn voxels(&self) -> &Voxels {
        &self.voxels
    }

    /// Voxels on x, y, z.
    pub fn size(&self) -> [u32; 3] {
        self.size
    }

    /// World position (mm, LPS) from voxel index.
    pub fn world_from_ix(&self) -> DAffine3 {
        self.world_from_ix
    }

    /// Distance between neighbouring voxels on each axis, mm.
    pub fn spacing(&self) -> [f64; 3] {
        let m = self.world_from_ix.matrix3;
        [m.x_axis.length(), m.y_axis.length(), m.z_axis.length()]
    }

    /// The smallest spacing, mm: the "voxel of the finest level" that step lengths are given in.
    pub fn min_spacing(&self) -> f64 {
        self.spacing().into_iter().fold(f64::INFINITY, f64::min)
    }

    /// From stored to the file's own values.
    pub fn rescale(&self) -> Rescale {
        self.rescale
    }

    /// Smallest and largest value, in the file's own units.
    pub fn value_range(&self) -> [f64; 2] {
        let [a, b] = self.stored_range.map(|s| self.value_from_stored(s));
        [a.min(b), a.max(b)]
    }

    /// Smallest and largest stored voxel.
    pub fn stored_range(&self) -> [f64; 2] {
        self.stored_range
    }

    /// Applies the rescale.
    pub fn value_from_stored(&self, stored: f64) -> f64 {
        self.rescale.slope * stored + self.rescale.intercept
    }

    /// Number of NaN or infinite voxels that were replaced by the smallest finite one.
    pub fn non_finite(&self) -> u64 {
        self.non_finite
    }

    /// Index of a voxel in [`Volume::voxels`].
    pub fn offset(&self, i: u32, j: u32, k: u32) -> usize {
        i as usize + self.size[0] as usize * (j as usize + self.size[1] as usize * k as usize)
    }

    /// The field at a continuous voxel index, trilinear between voxel centres, in the file's own units; `None`
    /// outside of the field. A hundred-thousandth of a voxel is allowed for rounding.
    pub fn sample(&self, at_ix: DVec3) -> Option<f64> {
        const ROUNDING: f64 = 1e-5;
        let last = DVec3::from_array(self.size.map(|n| f64::from(n - 1)));
        let inside = at_ix.cmpge(DVec3::splat(-ROUNDING)) & at_ix.cmple(last + ROUNDING);
        if !inside.all() {
            return None;
        }
        let at = at_ix.clamp(DVec3::ZERO, last);
        // The last cell ends at the last voxel.
        let first = at.floor().min(last - 1.0);
        let share = at - first;
        let [i, j, k] = first.as_uvec3().to_array();
        let mut sum = 0.0;
        for (dk, wz) in [1.0 - share.z, share.z].into_iter().enumerate() {
            for (dj, wy) in [1.0 - share.y, share.y].into_iter().enumerate() {
                for (di, wx) in [1.0 - share.x, share.x].into_iter().enumerate() {
                    sum += wx * wy * wz * self.value(i + di as u32, j + dj as u32, k + dk as u32);
                }
            }
        }
        Some(sum)
    }

    /// One voxel in the file's own units.
    pub fn value(&self, i: u32, j: u32, k: u32) -> f64 {
        self.value_from_stored(self.voxels.get(self.offset(i, j, k)))
    }
}

/// Range of the finite voxels; others are replaced by its minimum.
fn finite_range(voxels: &mut Voxels) -> Result<([f64; 2], u64)> {
    use rayon::prelude::*;
    fn range<T: Copy + Ord + Send + Sync>(v: &[T]) -> Option<(T, T)> {
        // By value: compilers make vector code of this, and not of minima of references.
        let widen = |(lo, hi): (T, T), &x: &T| (lo.min(x), hi.max(x));
        v.par_chunks(1 << 16)
            .filter_map(|c| c.first().map(|&x| c.iter().fold((x, x), widen)))
            .reduce_with(|a, b| (a.0.min(b.0), a.1.max(b.1)))
    }
    let empty = || Error::invalid("volume", "there are no voxels");
    Ok(match voxels {
        Voxels::U8(v) => range(v)
            .map(|(a, b)| ([a.into(), b.into()], 0))
            .ok_or_else(empty)?,
        Voxels::I8(v) => range(v)
            .map(|(a, b)| ([a.into(), b.into()], 0))
            .ok_or_else(empty)?,
        Voxels::U16(v) => range(v)
            .map(|(a, b)| ([a.into(), b.into()], 0))
            .ok_or_else(empty)?,
        Voxels::I16(v) => range(v)
            .map(|(a, b)| ([a.into(), b.into()], 0))
            .ok_or_else(empty)?,
        Voxels::F32(v) => {
            let (lo, hi, bad) = v
                .par_chunks(1 << 16)
                .map(|c| {
                    c.iter().fold(
                        (f32::INFINITY, f32::NEG_INFINITY, 0u64),
                        |(lo, hi, bad), &x| {
                            if x.is_finite() {
                                (lo.min(x), hi.max(x), bad)
                            } else {
                                (lo, hi, bad + 1)
                            }
                        },
                    )
                })
                .reduce(
                    || (f32::INFINITY, f32::NEG_INFINITY, 0),
                    |a, b| (a.0.min(b.0), a.1.max(b.1), a.2 + b.2),
                );
            if lo > hi {
                return Err(Error::invalid("volume", "no voxel is a finite number"));
            }
            if bad > 0 {
                v.par_iter_mut()
                    .filter(|x| !x.is_finite())
                    .for_each(|x| *x = lo);
            }
            ([lo.into(), hi.into()], bad)
        }
    })
}
