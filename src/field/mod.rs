//! The scalar field that a grid of voxels stands for: its values between the voxels and its gradient, in f64.

mod filter;
mod gradient;

use std::ops::{Add, Mul, Sub};

use glam::{DAffine3, DVec3};

use crate::scene::Interpolation;
use crate::volume::Volume;

pub use filter::CubicKernel;

/// A volume's field, defined between the first and the last voxel centre: `[0, n-1]` on each index axis.
/// Filters that reach beyond it find the border voxels repeated.
///
/// Values are in the file's own units.
pub struct Field<'a> {
    volume: &'a Volume,
    ix_from_world: DAffine3,
}

impl<'a> Field<'a> {
    /// The field of a volume.
    pub fn new(volume: &'a Volume) -> Self {
        Self {
            volume,
            ix_from_world: volume.world_from_ix().inverse(),
        }
    }

    /// Index position from world position (mm).
    pub fn ix_from_world(&self) -> DAffine3 {
        self.ix_from_world
    }

    /// Index position of the last voxel, the upper corner of the field.
    pub fn last_ix(&self) -> DVec3 {
        last_ix(self.volume.size())
    }

    /// True between the first and the last voxel centre.
    pub fn contains(&self, ix: DVec3) -> bool {
        contains(self.volume.size(), ix)
    }

    /// Value at an index position; `None` outside the field.
    pub fn sample(&self, ix: DVec3, interpolation: Interpolation) -> Option<f64> {
        self.contains(ix)
            .then(|| self.interpolate(ix, interpolation, |value| value))
    }

    /// Value at the point of the field that is nearest to an index position on each axis.
    pub(crate) fn sample_clamped(&self, ix: DVec3, interpolation: Interpolation) -> f64 {
        let inside = ix.clamp(DVec3::ZERO, self.last_ix());
        self.interpolate(inside, interpolation, |value| value)
    }

    /// Interpolates what `property` makes of the voxels' values, at an index position inside the field.
    ///
    /// The nearest voxel is `floor(x + 0.5)` on each axis: halves go up.
    pub(crate) fn interpolate<T: Interpolated>(
        &self,
        ix: DVec3,
        interpolation: Interpolation,
        property: impl Fn(f64) -> T,
    ) -> T {
        let cubic = |kernel: CubicKernel| {
            let fraction = ix - ix.floor();
            let weights = fraction.to_array().map(|t| kernel.weights(t));
            self.sum_of_cube(ix, weights, &property)
        };
        let voxel = |i, j, k| property(self.volume.value(i, j, k));
        match interpolation {
            Interpolation::Nearest => {
                let [i, j, k] = (ix + 0.5).floor().to_array().map(|x| x as u32);
                voxel(i, j, k)
            }
            Interpolation::Linear => trilinear(self.volume.size(), ix, voxel),
            Interpolation::Bspline => cubic(CubicKernel::Bspline),
            Interpolation::CatmullRom => cubic(CubicKernel::CatmullRom),
        }
    }

    /// Linear colour of the data at an index position inside the field: that of the nearest voxel, else the trilinear mixture,
    /// whatever kernel values have; `None` of data without colours.
    #[cfg(feature = "reference")]
    pub(crate) fn color(
        &self,
        ix: DVec3,
        interpolation: Interpolation,
        management: crate::scene::ColorManagement,
    ) -> Option<DVec3> {
        let colors = self.volume.colors()?;
        let voxel = |i, j, k| {
            let [r, g, b, _] = colors[self.volume.offset(i, j, k)];
            DVec3::from_array(management.decode([r, g, b].map(|c| f64::from(c) / 255.0)))
        };
        Some(match interpolation {
            Interpolation::Nearest => {
                let [i, j, k] = (ix + 0.5).floor().to_array().map(|x| x as u32);
                voxel(i, j, k)
            }
            _ => trilinear(self.volume.size(), ix, voxel),
        })
    }

    /// Sum over the 4^3 voxels around an index position, each with the product of its weights on x, y and z.
    pub(crate) fn sum_of_cube<T: Interpolated>(
        &self,
        ix: DVec3,
        weights: [[f64; 4]; 3],
        property: impl Fn(f64) -> T,
    ) -> T {
        let last = self.last_ix();
        let index = |axis: usize, tap: usize| {
            let voxel = ix[axis].floor() + tap as f64 - 1.0;
            voxel.clamp(0.0, last[axis]) as u32
        };
        let mut sum = T::default();
        for (z, wz) in weights[2].into_iter().enumerate() {
            for (y, wy) in weights[1].into_iter().enumerate() {
                for (x, wx) in weights[0].into_iter().enumerate() {
                    let value = self.volume.value(index(0, x), index(1, y), index(2, z));
                    sum = sum + property(value) * (wx * wy * wz);
                }
            }
        }
        sum
    }
}

/// Numbers and vectors.
pub(crate) trait Interpolated:
    Copy + Default + Add<Output = Self> + Sub<Output = Self> + Mul<f64, Output = Self>
{
}

impl<T> Interpolated for T where
    T: Copy + Default + Add<Output = T> + Sub<Output = T> + Mul<f64, Output = T>
{
}

/// Index position of the last voxel of a grid.
fn last_ix(size: [u32; 3]) -> DVec3 {
    DVec3::from_array(size.map(|n| f64::from(n) - 1.0))
}

/// True between the first and the last voxel centre.
pub(crate) fn contains(size: [u32; 3], ix: DVec3) -> bool {
    ix.cmpge(DVec3::ZERO).all() && ix.cmple(last_ix(size)).all()
}

/// Trilinear interpolation inside a grid of at least two points an axis.
pub(crate) fn trilinear<T: Interpolated>(
    size: [u32; 3],
    ix: DVec3,
    value: impl Fn(u32, u32, u32) -> T,
) -> T {
    // The last cell is closed above: its upper face belongs to it.
    let cell = ix.floor().min(last_ix(size) - 1.0);
    let [fx, fy, fz] = (ix - cell).to_array();
    let [i, j, k] = cell.to_array().map(|x| x as u32);
    let mix = |a: T, b: T, s: f64| a + (b - a) * s;
    let along_x = |j, k| mix(value(i, j, k), value(i + 1, j, k), fx);
    let along_y = |k| mix(along_x(j, k), along_x(j + 1, k), fy);
    mix(along_y(k), along_y(k + 1), fz)
}
