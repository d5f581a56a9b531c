//! A sparse tree, written out over the bounding box of its active voxels.

use std::path::Path;

use glam::I64Vec3;

use super::tree::{LEAF_LOG2, LEAF_VOXELS, Part, Tree, Value, bit, cell};
use crate::error::Result;
use crate::io::ReadOptions;
use crate::io::element::Element;
use crate::io::grid::Grid;
use crate::io::payload::reserve;
use crate::io::source::bad;
use crate::volume::MIN_SIZE;

/// A box of voxels.
pub(super) struct Dense<T> {
    /// Index of the first voxel.
    pub(super) min: I64Vec3,
    pub(super) grid: Grid,
    /// x is fastest.
    pub(super) voxels: Vec<T>,
}

/// Fills the active bounding box: what is neither leaf nor tile has the background value.
pub(super) fn densify<T: Value>(
    path: &Path,
    tree: &Tree<'_, T>,
    element: Element,
    options: &ReadOptions<'_>,
) -> Result<Dense<T>> {
    let (bounds, leaves) = survey(tree)?;
    let Some((min, max)) = bounds else {
        return Err(bad(path, "the grid has no active voxel".into()));
    };
    let size = (max - min + I64Vec3::ONE).max(I64Vec3::splat(MIN_SIZE.into()));
    let axes = size.to_array().map(|n| n.unsigned_abs());
    let keys = "active bounding box";
    let grid = Grid::of_one(path, keys, axes, element, &options.limits)?;
    let mut voxels = reserve(grid.voxels)?;
    voxels.resize(grid.voxels, tree.background);
    let mut dense = Dense { min, grid, voxels };
    tree.visit(&mut |origin, part| {
        if let Part::Tile { log2, value, .. } = part
            && value != tree.background
        {
            dense.fill(origin, 1 << log2, value);
        }
        Ok(())
    })?;
    let each = leaves.len() / 64 + 1;
    for (i, (&origin, values)) in leaves.iter().zip(tree.leaves()).enumerate() {
        dense.copy(origin, &values?);
        if let Some(progress) = options.progress
            && i % each == 0
        {
            progress(grid.bytes / leaves.len() as u64 * i as u64, grid.bytes);
        }
    }
    Ok(dense)
}

/// First and last active voxel on each axis.
type Bounds = Option<(I64Vec3, I64Vec3)>;

/// The bounds of the active voxels, and where leaves lie.
fn survey<T: Value>(tree: &Tree<'_, T>) -> Result<(Bounds, Vec<I64Vec3>)> {
    let mut bounds: Bounds = None;
    let mut leaves = Vec::new();
    let mut include = |first: I64Vec3, last: I64Vec3| {
        let (min, max) = bounds.unwrap_or((first, last));
        bounds = Some((min.min(first), max.max(last)));
    };
    tree.visit(&mut |origin, part| {
        match part {
            Part::Tile { log2, active, .. } if active => {
                include(origin, origin + I64Vec3::splat((1 << log2) - 1));
            }
            Part::Tile { .. } => {}
            Part::Leaf { active } => {
                leaves.push(origin);
                for i in (0..LEAF_VOXELS).filter(|&i| bit(active, i)) {
                    let voxel = origin + cell(i, LEAF_LOG2);
                    include(voxel, voxel);
                }
            }
        }
        Ok(())
    })?;
    Ok((bounds, leaves))
}

impl<T: Copy> Dense<T> {
    /// Sets what of a cube lies inside.
    fn fill(&mut self, origin: I64Vec3, edge: i64, value: T) {
        let size = self.grid.size.map(i64::from);
        let [x, y, z] = (origin - self.min).to_array();
        let clip = |at: i64, size: i64| at.clamp(0, size)..(at + edge).clamp(0, size);
        let [nx, ny, nz] = size;
        let columns = clip(x, nx);
        for k in clip(z, nz) {
            for j in clip(y, ny) {
                let row = (nx * (j + ny * k)) as usize;
                let cells = row + columns.start as usize..row + columns.end as usize;
                if let Some(cells) = self.voxels.get_mut(cells) {
                    cells.fill(value);
                }
            }
        }
    }

    /// Sets what of a leaf lies inside.
    fn copy(&mut self, origin: I64Vec3, values: &[T]) {
        let [nx, ny, nz] = self.grid.size.map(i64::from);
        for (i, &value) in values.iter().enumerate() {
            let [x, y, z] = (origin + cell(i, LEAF_LOG2) - self.min).to_array();
            let inside = (0..nx).contains(&x) && (0..ny).contains(&y) && (0..nz).contains(&z);
            let at = (x + nx * (y + ny * z)) as usize;
            if inside && let Some(voxel) = self.voxels.get_mut(at) {
                *voxel = value;
            }
        }
    }
}
