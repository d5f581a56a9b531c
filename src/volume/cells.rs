//! Empty-space skipping: value ranges of small groups of cells.

use std::sync::Arc;

use rayon::prelude::*;

use super::Rescale;
use super::blocks::{BLOCK_CELLS, BlockGrid, FINEST, brick_extent, brick_texels};
use super::bricks::BrickBuilder;
use super::statistics::BlockStatistics;

/// Cells on each axis of a skip cell.
pub const SKIP_CELLS: u32 = 4;

/// Skip cells of a block on each axis.
const PER_BLOCK: usize = (BLOCK_CELLS / SKIP_CELLS) as usize;

/// What a skip cell of a block that is not resident holds: no value lies in it.
const ABSENT: [f32; 2] = [f32::INFINITY, f32::NEG_INFINITY];

/// Smallest and largest value of the *stored* field over closed groups of 4^3 cells.
///
/// Ranges bound what sampling the bricks can return at the levels they have, coarse ones included:
/// all samples count that trilinear interpolation anywhere in the closed skip cell gives weight.
#[derive(Clone, Debug)]
pub struct CellGrid {
    counts: [u32; 3],
    rescale: Rescale,
    ranges: Arc<Vec<[f32; 2]>>,
}

impl CellGrid {
    /// Ranges of all skip cells, in parallel over slabs of blocks. `statistics` are those of the volume that the bricks are
    /// made of.
    pub fn new(bricks: &BrickBuilder, statistics: &BlockStatistics) -> Self {
        let grid = bricks.grid();
        let counts = grid.size().map(|n| (n - 1).div_ceil(SKIP_CELLS));
        let [width, height, _] = counts.map(|n| n as usize);
        let mut ranges = statistics.cell_ranges().clone();
        if bricks
            .levels()
            .by_block
            .iter()
            .all(|&level| level == Some(FINEST))
        {
            return Self {
                counts,
                rescale: statistics.rescale(),
                ranges,
            };
        }
        let blocks = grid.counts().map(|n| n as usize);
        let strides = [width, width * height];
        Arc::make_mut(&mut ranges)
            .par_chunks_mut(width * height * PER_BLOCK)
            .enumerate()
            .for_each_init(Scratch::new, |scratch, (z, slab)| {
                for y in 0..blocks[1] {
                    for x in 0..blocks[0] {
                        let block = x + blocks[0] * (y + blocks[1] * z);
                        if bricks.holds_voxels(block) {
                            continue;
                        }
                        let size = match bricks.levels().by_block[block] {
                            Some(level) => scratch.reduce(bricks, grid, block, level),
                            None => scratch.clear(grid, block),
                        };
                        let first = PER_BLOCK * (x + width * y);
                        scratch.copy_to(size, &mut slab[first..], strides);
                    }
                }
            });
        Self {
            counts,
            rescale: statistics.rescale(),
            ranges,
        }
    }

    /// Skip cells on x, y, z.
    pub fn counts(&self) -> [u32; 3] {
        self.counts
    }

    /// Smallest and largest stored value over a closed skip cell, by linear index, x fastest;
    /// `None` where nothing is resident.
    pub fn stored_range(&self, cell: usize) -> Option<[f32; 2]> {
        let range = self.ranges[cell];
        (range[0] <= range[1]).then_some(range)
    }

    /// [`CellGrid::stored_range`] in the file's units.
    pub fn value_range(&self, cell: usize) -> Option<[f64; 2]> {
        Some(self.rescale.range(self.stored_range(cell)?))
    }

    /// 1 for every skip cell whose range of stored values `visible` accepts; 0 for others and where nothing is resident. x
    /// fastest.
    pub fn occupancy(&self, visible: impl Fn([f32; 2]) -> bool + Sync) -> Vec<u8> {
        self.ranges
            .par_iter()
            .with_min_len(1 << 12)
            .map(|&[low, high]| u8::from(low <= high && visible([low, high])))
            .collect()
    }
}

/// How much further than a skip cell a wide filter looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reach {
    /// Skip cells on each side.
    pub cells: u32,
    /// How far results may leave the range of the samples, in halves of that range.
    pub overshoot: f32,
}

impl CellGrid {
    /// Ranges that bound what a filter of a wider support than trilinear returns in each skip cell.
    pub fn widened(&self, reach: Reach) -> Self {
        let mut ranges = self.ranges.to_vec();
        let counts = self.counts.map(|n| n as usize);
        let strides = [1, counts[0], counts[0] * counts[1]];
        for axis in 0..3 {
            let from = ranges.clone();
            let (count, stride) = (counts[axis], strides[axis]);
            ranges.par_iter_mut().enumerate().for_each(|(cell, to)| {
                let at = cell / stride % count;
                let reach = reach.cells as usize;
                let first = at.saturating_sub(reach);
                let last = (at + reach).min(count - 1);
                let start = cell - (at - first) * stride;
                for there in 0..=last - first {
                    let [low, high] = from[start + there * stride];
                    *to = [to[0].min(low), to[1].max(high)];
                }
            });
        }
        for range in &mut ranges {
            let [low, high] = *range;
            if low <= high {
                // Sums of many products are off by more than one rounding.
                let rounding = 1e-6 * low.abs().max(high.abs());
                let beyond = 0.5 * reach.overshoot * (high - low) + rounding;
                *range = [low - beyond, high + beyond];
            }
        }
        Self {
            counts: self.counts,
            rescale: self.rescale,
            ranges: ranges.into(),
        }
    }

    /// Number of skip cells.
    #[expect(clippy::len_without_is_empty, reason = "a grid has at least one cell")]
    pub fn len(&self) -> usize {
        self.ranges.len()
    }
}

/// Room to reduce a brick to its skip cells, axis by axis.
struct Scratch {
    samples: Vec<f32>,
    planes: Vec<f32>,
    rows: Vec<f32>,
    cells: [[f32; 2]; PER_BLOCK.pow(3)],
}

impl Scratch {
    fn new() -> Self {
        let side = brick_extent(FINEST) as usize;
        Self {
            samples: vec![0.0; brick_texels(FINEST)],
            planes: vec![0.0; PER_BLOCK * side * side],
            rows: vec![0.0; PER_BLOCK * PER_BLOCK * side],
            cells: [ABSENT; PER_BLOCK.pow(3)],
        }
    }

    /// Fills `cells`, 4 to a row and 16 to a plane; returns how many the block has on each axis.
    fn reduce(
        &mut self,
        bricks: &BrickBuilder,
        grid: &BlockGrid,
        block: usize,
        level: u8,
    ) -> [usize; 3] {
        bricks.stored(block, &mut self.samples);
        let (cells, intervals) = (grid.cells(block), grid.intervals(block, level));
        let side = brick_extent(level) as usize;
        let spans = [0, 1, 2].map(|a| spans(cells[a], intervals[a]));
        self.fold(side, &spans, 0, |a, b| if b < a { b } else { a });
        self.fold(side, &spans, 1, |a, b| if b > a { b } else { a });
        cells.map(|m| m.div_ceil(SKIP_CELLS) as usize)
    }

    /// The same for a block that is not resident.
    fn clear(&mut self, grid: &BlockGrid, block: usize) -> [usize; 3] {
        self.cells = [ABSENT; PER_BLOCK.pow(3)];
        grid.cells(block).map(|m| m.div_ceil(SKIP_CELLS) as usize)
    }

    /// Combines the samples of every skip cell and stores the result as one `end` of the ranges.
    fn fold(
        &mut self,
        side: usize,
        spans: &[[Span; PER_BLOCK]; 3],
        end: usize,
        pick: impl Fn(f32, f32) -> f32,
    ) {
        let area = side * side;
        for (span, to) in spans[2].iter().zip(self.planes.chunks_exact_mut(area)) {
            fold_slices(&self.samples, *span, to, &pick);
        }
        for (plane, to) in self
            .planes
            .chunks_exact(area)
            .take(PER_BLOCK)
            .zip(self.rows.chunks_exact_mut(PER_BLOCK * side))
        {
            for (span, to) in spans[1].iter().zip(to.chunks_exact_mut(side)) {
                fold_slices(plane, *span, to, &pick);
            }
        }
        for (row, to) in self
            .rows
            .chunks_exact(side)
            .zip(self.cells.chunks_exact_mut(PER_BLOCK))
        {
            for (span, to) in spans[0].iter().zip(to) {
                let samples = &row[span.first..=span.last];
                to[end] = samples[1..].iter().copied().fold(samples[0], &pick);
            }
        }
    }

    fn copy_to(&self, size: [usize; 3], to: &mut [[f32; 2]], strides: [usize; 2]) {
        for k in 0..size[2] {
            for j in 0..size[1] {
                let from = PER_BLOCK * (j + PER_BLOCK * k);
                let at = j * strides[0] + k * strides[1];
                to[at..at + size[0]].copy_from_slice(&self.cells[from..from + size[0]]);
            }
        }
    }
}

/// Samples of an axis, both included, that a closed skip cell touches.
#[derive(Clone, Copy, Default)]
struct Span {
    first: usize,
    last: usize,
}

/// The spans of a block's skip cells on one axis; those beyond the block repeat the last.
fn spans(cells: u32, intervals: u32) -> [Span; PER_BLOCK] {
    std::array::from_fn(|c| {
        let from = (c as u32 * SKIP_CELLS).min(cells - 1) / SKIP_CELLS * SKIP_CELLS;
        let to = (from + SKIP_CELLS).min(cells);
        Span {
            first: (from * intervals / cells) as usize,
            last: (to * intervals).div_ceil(cells) as usize,
        }
    })
}

/// Combines the slices of `from`, each as long as `to`, that a span names.
fn fold_slices(from: &[f32], span: Span, to: &mut [f32], pick: impl Fn(f32, f32) -> f32) {
    let length = to.len();
    let mut slices = from[span.first * length..(span.last + 1) * length].chunks_exact(length);
    if let Some(first) = slices.next() {
        to.copy_from_slice(first);
    }
    for slice in slices {
        for (to, &v) in to.iter_mut().zip(slice) {
            *to = pick(*to, v);
        }
    }
}
