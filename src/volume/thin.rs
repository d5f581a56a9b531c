//! Fewer voxels of a volume whose values must not be mixed.

use glam::{DMat3, DVec3};

use super::{MIN_SIZE, Volume, Voxels};
use crate::error::Result;

impl Volume {
    /// Every `every`-th voxel on each axis from the first on, at its place; axes keep at least two.
    ///
    /// # Errors
    /// As [`Volume::new`], which does not happen for a volume that is valid.
    pub fn thinned(&self, every: u32) -> Result<Self> {
        let every = self.size.map(|n| every.clamp(1, (n - 1) / (MIN_SIZE - 1)));
        let size: [u32; 3] = std::array::from_fn(|axis| (self.size[axis] - 1) / every[axis] + 1);
        let voxels = match &self.voxels {
            Voxels::U8(v) => Voxels::U8(self.pick(v, size, every)),
            Voxels::I8(v) => Voxels::I8(self.pick(v, size, every)),
            Voxels::U16(v) => Voxels::U16(self.pick(v, size, every)),
            Voxels::I16(v) => Voxels::I16(self.pick(v, size, every)),
            Voxels::F32(v) => Voxels::F32(self.pick(v, size, every)),
        };
        let mut placement = self.world_from_ix;
        placement.matrix3 *= DMat3::from_diagonal(DVec3::from_array(every.map(f64::from)));
        let thinned = Self::new(voxels, size, placement, self.rescale)?;
        let colors = self.colors.as_ref().map(|v| self.pick(v, size, every));
        thinned
            .with_colors(colors)?
            .with_metadata(self.metadata.clone())
            .with_labels(self.labels.clone())
    }

    fn pick<T: Copy>(&self, voxels: &[T], size: [u32; 3], every: [u32; 3]) -> Vec<T> {
        let [nx, ny, nz] = size;
        let places =
            (0..nz).flat_map(|k| (0..ny).flat_map(move |j| (0..nx).map(move |i| [i, j, k])));
        places
            .map(|[i, j, k]| voxels[self.offset(i * every[0], j * every[1], k * every[2])])
            .collect()
    }
}
