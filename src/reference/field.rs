//! The scalar field that a grid of voxels stands for.

use std::ops::{Add, Mul, Sub};

use glam::{DAffine3, DVec3};

use crate::scene::Interpolation;
use crate::volume::Volume;

/// A volume's field, defined between the first and the last voxel centre: `[0, n-1]` on each index axis.
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

    /// Value at an index position; `None` outside the field.
    ///
    /// The nearest voxel is `floor(x + 0.5)` on each axis: halves go up.
    pub fn sample(&self, ix: DVec3, interpolation: Interpolation) -> Option<f64> {
        match interpolation {
            Interpolation::Nearest => {
                let inside = contains(self.volume.size(), ix);
                let [i, j, k] = (ix + 0.5).floor().to_array().map(|x| x as u32);
                inside.then(|| self.volume.value(i, j, k))
            }
            Interpolation::Linear => {
                trilinear(self.volume.size(), ix, |i, j, k| self.volume.value(i, j, k))
            }
        }
    }

    /// World-space gradient at an index position, in values per mm; `None` outside the field.
    ///
    /// Central differences of the trilinear field along the index axes. Taps lie one voxel away; at the
    /// border they are moved onto the field, and the difference is divided by the distance that is left.
    pub fn gradient_ws(&self, ix: DVec3) -> Option<DVec3> {
        if !contains(self.volume.size(), ix) {
            return None;
        }
        let mut gradient_ix = DVec3::ZERO;
        for axis in 0..3 {
            let [mut below, mut above] = [ix; 2];
            below[axis] = (ix[axis] - 1.0).max(0.0);
            above[axis] = (ix[axis] + 1.0).min(self.last_ix()[axis]);
            let difference = self.sample(above, Interpolation::Linear)?
                - self.sample(below, Interpolation::Linear)?;
            gradient_ix[axis] = difference / (above[axis] - below[axis]);
        }
        // Gradients transform by the inverse transpose of what moves points.
        Some(self.ix_from_world.matrix3.transpose() * gradient_ix)
    }
}

/// Index position of the last voxel of a grid.
pub(super) fn last_ix(size: [u32; 3]) -> DVec3 {
    DVec3::from_array(size.map(|n| f64::from(n) - 1.0))
}

/// True between the first and the last voxel centre.
fn contains(size: [u32; 3], ix: DVec3) -> bool {
    ix.cmpge(DVec3::ZERO).all() && ix.cmple(last_ix(size)).all()
}

/// Trilinear interpolation on a grid of at least two points an axis; `None` outside `[0, n-1]`.
pub(super) fn trilinear<T>(
    size: [u32; 3],
    ix: DVec3,
    value: impl Fn(u32, u32, u32) -> T,
) -> Option<T>
where
    T: Copy + Add<Output = T> + Sub<Output = T> + Mul<f64, Output = T>,
{
    if !contains(size, ix) {
        return None;
    }
    // The last cell is closed above: its upper face belongs to it.
    let cell = ix.floor().min(last_ix(size) - 1.0);
    let [fx, fy, fz] = (ix - cell).to_array();
    let [i, j, k] = cell.to_array().map(|x| x as u32);
    let mix = |a: T, b: T, s: f64| a + (b - a) * s;
    let along_x = |j, k| mix(value(i, j, k), value(i + 1, j, k), fx);
    let along_y = |k| mix(along_x(j, k), along_x(j + 1, k), fy);
    Some(mix(along_y(k), along_y(k + 1), fz))
}
