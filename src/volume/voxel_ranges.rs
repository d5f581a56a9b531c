//! Smallest and largest voxel of every skip cell and of every block, in one pass over the volume.

use std::ops::Range;
use std::sync::Arc;

use rayon::prelude::*;

use super::Volume;
use super::blocks::{BLOCK_CELLS, BlockGrid};
use super::cells::SKIP_CELLS;
use super::texel::{Voxel, with_typed};

/// Skip cells of a block on each axis.
const PER_BLOCK: u32 = BLOCK_CELLS / SKIP_CELLS;

/// Smallest and largest voxel, in stored units, over closed groups of voxels: borders belong to both sides.
#[derive(Debug)]
pub(super) struct VoxelRanges {
    /// Of skip cells, x fastest.
    pub(super) cells: Arc<Vec<[f32; 2]>>,
    /// Of blocks, x fastest.
    pub(super) blocks: Vec<[f32; 2]>,
}

impl VoxelRanges {
    pub(super) fn of(volume: &Volume, grid: &BlockGrid) -> Self {
        let cells = with_typed!(volume.voxels(), voxels => cells_of(voxels, grid.size()));
        let counts = grid.size().map(|n| (n - 1).div_ceil(SKIP_CELLS));
        let block = |block: usize| {
            let first = grid.position(block).map(|b| b * PER_BLOCK);
            let axis = |a: usize| first[a]..(first[a] + PER_BLOCK).min(counts[a]);
            let row = |[j, k]: [u32; 2]| {
                let start = counts[0] as usize * (j + counts[1] * k) as usize;
                &cells[start + axis(0).start as usize..start + axis(0).end as usize]
            };
            axis(2)
                .flat_map(|k| axis(1).map(move |j| [j, k]))
                .flat_map(row)
                .fold([f32::INFINITY, f32::NEG_INFINITY], |a, b| {
                    [a[0].min(b[0]), a[1].max(b[1])]
                })
        };
        let blocks = (0..grid.len()).into_par_iter().map(block).collect();
        Self {
            cells: cells.into(),
            blocks,
        }
    }
}

fn cells_of<V: Voxel + PartialOrd>(voxels: &[V], size: [u32; 3]) -> Vec<[f32; 2]> {
    let [width, height, depth] = size.map(|n| n as usize);
    let step = SKIP_CELLS as usize;
    let [across, down, deep] = [width, height, depth].map(|n| (n - 1).div_ceil(step));
    let mut cells = vec![[0.0; 2]; across * down * deep];
    let rows = cells.par_chunks_mut(across).enumerate();
    rows.for_each_init(Envelope::default, |envelope, (cell, to)| {
        let [y, z] = [cell % down, cell / down].map(|c| c * step);
        let planes = z..=(z + step).min(depth - 1);
        let rows = planes
            .flat_map(|k| (y..=(y + step).min(height - 1)).map(move |j| j + height * k))
            .map(|row| &voxels[row * width..][..width]);
        envelope.enclose(rows);
        for (x, to) in to.iter_mut().enumerate() {
            *to = envelope.range(x * step..(x * step + step + 1).min(width));
        }
    });
    cells
}

/// Smallest and largest of several rows of voxels, one by one.
pub(crate) struct Envelope<V> {
    low: Vec<V>,
    high: Vec<V>,
}

impl<V> Default for Envelope<V> {
    fn default() -> Self {
        let [low, high] = [(); 2].map(|()| Vec::new());
        Self { low, high }
    }
}

impl<V: Voxel + PartialOrd> Envelope<V> {
    /// Of rows of equal length.
    pub(crate) fn enclose<'a>(&mut self, rows: impl IntoIterator<Item = &'a [V]>) {
        let mut rows = rows.into_iter();
        let first = rows.next().unwrap_or_default();
        for end in [&mut self.low, &mut self.high] {
            end.clear();
            end.extend_from_slice(first);
        }
        for row in rows {
            // Written so that compilers make vector code of it.
            for ((low, high), &v) in self.low.iter_mut().zip(&mut self.high).zip(row) {
                *low = if v < *low { v } else { *low };
                *high = if v > *high { v } else { *high };
            }
        }
    }

    /// Smallest and largest voxel of some columns, at least one.
    pub(crate) fn range(&self, columns: Range<usize>) -> [f32; 2] {
        [
            pick(&self.low[columns.clone()], |a, b| a < b),
            pick(&self.high[columns], |a, b| a > b),
        ]
    }
}

fn pick<V: Voxel>(values: &[V], better: impl Fn(V, V) -> bool) -> f32 {
    let best = values
        .iter()
        .copied()
        .reduce(|a, b| if better(b, a) { b } else { a });
    best.map_or(f32::NAN, Voxel::to_f32)
}
