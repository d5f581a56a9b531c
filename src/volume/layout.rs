//! Where each brick lies in the 3D atlas.

use super::blocks::{BlockGrid, FINEST, LEVELS, Levels, brick_extent, brick_texels};
use crate::error::{Error, Result};

/// Candidates on each axis when the base of the atlas is chosen.
const CANDIDATES: u32 = 32;

/// How far the base of the atlas may stray from a cube.
const ASPECT: f64 = 1.4;

/// Extent of the atlas and origin of every brick in it, in texels.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AtlasLayout {
    extent: [u32; 3],
    origins: Vec<Option<[u32; 3]>>,
    copy_extents: CopyExtents,
}

/// How much of each brick has room in the atlas.
#[derive(Clone, Debug, PartialEq, Eq)]
enum CopyExtents {
    /// The voxels that a block has first: those it shares with the block before belong to that one's neighbour.
    Grid(BlockGrid),
    /// All `2^lambda + 1` texels.
    Whole(Levels),
}

impl AtlasLayout {
    /// Packs the resident bricks, none of whose axes may end beyond `max_extent` texels.
    ///
    /// When every block is at the finest level and the limit allows it, bricks lie as their blocks
    /// do, 16 texels apart: neighbours share the texels between them, so the atlas is the volume itself, and no
    /// filter, however wide, meets a border. Otherwise the
    /// bricks of each level are stacked in layers, from the finest to the coarsest, and coarser
    /// ones fill the gaps of finer ones; the base is the one of about a thousand near-square ones
    /// that makes the smallest atlas.
    ///
    /// # Errors
    /// [`Error::Invalid`] when `levels` do not fit `grid`, or the bricks do not fit the limit.
    pub fn plan(grid: &BlockGrid, levels: &Levels, max_extent: u32) -> Result<Self> {
        levels.check(grid)?;
        if levels.by_block.iter().all(|&l| l == Some(FINEST)) {
            let extent = grid.size();
            if extent.iter().all(|&n| n <= max_extent) {
                return Ok(Self {
                    extent,
                    origins: (0..grid.len())
                        .map(|block| Some(grid.origin_ix(block)))
                        .collect(),
                    copy_extents: CopyExtents::Grid(*grid),
                });
            }
        }
        Self::packed(levels, max_extent)
    }

    fn packed(levels: &Levels, max_extent: u32) -> Result<Self> {
        let counts = levels.count_by_level();
        let mut origins = vec![None; levels.by_block.len()];
        let mut extent = [1; 3];
        if levels.resident() > 0 {
            let packing = smallest(&counts, max_extent).ok_or_else(|| {
                Error::invalid(
                    "storage",
                    format!(
                        "{} bricks ({:.0} million texels) do not fit a 3D image of at most {max_extent}^3 texels \
                         on this device; raise data_reduction or lower memory_budget_mib",
                        levels.resident(),
                        texels(&counts) / 1e6,
                    ),
                )
            })?;
            extent = packing.extent;
            for level in 0..LEVELS as u8 {
                let mut places = packing
                    .runs
                    .iter()
                    .filter(|(l, _)| *l == level)
                    .flat_map(|(_, run)| run.origins());
                for (origin, _) in origins
                    .iter_mut()
                    .zip(&levels.by_block)
                    .filter(|(_, l)| **l == Some(level))
                {
                    *origin = places.next();
                }
            }
        }
        Ok(Self {
            extent,
            origins,
            copy_extents: CopyExtents::Whole(levels.clone()),
        })
    }

    /// Texels of the atlas on x, y, z; at least 1.
    pub fn extent(&self) -> [u32; 3] {
        self.extent
    }

    /// First texel of every block's brick, by linear block index; `None` for blocks that are not
    /// resident.
    pub fn origins(&self) -> &[Option<[u32; 3]>] {
        &self.origins
    }

    /// Texels of a brick to copy to its origin: a corner of the `(2^lambda + 1)^3` that a brick
    /// has; the others it shares with a brick that copies them. Zero for a block that is not resident.
    pub fn copy_extent(&self, block: usize) -> [u32; 3] {
        match &self.copy_extents {
            CopyExtents::Grid(grid) => {
                let (first, cells) = (grid.origin_ix(block), grid.cells(block));
                std::array::from_fn(|a| {
                    let last = first[a] + cells[a] + 1 == grid.size()[a];
                    cells[a] + u32::from(last)
                })
            }
            CopyExtents::Whole(levels) => [levels.by_block[block].map_or(0, brick_extent); 3],
        }
    }

    /// True when every block is at the finest level and bricks lie as their blocks do: brick `b` starts at
    /// `16 b`, and the texel of a voxel is its index.
    pub fn is_grid(&self) -> bool {
        matches!(self.copy_extents, CopyExtents::Grid(_))
    }

    /// Texels of the atlas, used or not.
    pub fn texels(&self) -> u64 {
        self.extent.iter().map(|&n| u64::from(n)).product()
    }
}

fn texels(counts: &[usize; LEVELS]) -> f64 {
    (0..LEVELS)
        .map(|l| counts[l] as f64 * brick_texels(l as u8) as f64)
        .sum()
}

/// An axis-aligned part of the atlas.
#[derive(Clone, Copy, Debug)]
struct Space {
    origin: [u32; 3],
    size: [u32; 3],
}

/// Bricks of one level side by side: along x, then y, then z.
#[derive(Clone, Copy, Debug)]
struct Run {
    origin: [u32; 3],
    columns: usize,
    rows: usize,
    count: usize,
    side: u32,
}

impl Run {
    fn origins(self) -> impl Iterator<Item = [u32; 3]> {
        (0..self.count).map(move |i| {
            let at = [
                i % self.columns,
                i / self.columns % self.rows,
                i / (self.columns * self.rows),
            ];
            std::array::from_fn(|a| self.origin[a] + at[a] as u32 * self.side)
        })
    }
}

struct Packing {
    extent: [u32; 3],
    runs: Vec<(u8, Run)>,
}

/// The smallest packing among near-square bases; `None` when none ends within the limit.
fn smallest(counts: &[usize; LEVELS], max_extent: u32) -> Option<Packing> {
    let largest = brick_extent((0..LEVELS as u8).rfind(|&l| counts[usize::from(l)] > 0)?);
    if largest > max_extent {
        return None;
    }
    let cube = texels(counts).cbrt();
    let to = ((cube * ASPECT).ceil() as u32).clamp(largest, max_extent);
    let from = ((cube / ASPECT) as u32).clamp(largest, to);
    // Counted down, so that the limit itself is always tried.
    let step = ((to - from) / CANDIDATES).max(1) as usize;
    let mut best: Option<Packing> = None;
    for y in (from..=to).rev().step_by(step) {
        for x in (from..=y).rev().step_by(step) {
            let packing = pack(counts, [x, y]);
            let volume = |p: &Packing| p.extent.iter().map(|&n| u64::from(n)).product::<u64>();
            if packing.extent[2] <= max_extent
                && best.as_ref().is_none_or(|b| volume(&packing) < volume(b))
            {
                best = Some(packing);
            }
        }
    }
    best
}

/// Stacks layers of bricks, the largest first, on a base that holds at least one of them.
fn pack(counts: &[usize; LEVELS], base: [u32; 2]) -> Packing {
    let mut runs = Vec::new();
    let mut gaps: Vec<Space> = Vec::new();
    let mut height = 0u32;
    for level in (0..LEVELS as u8).rev() {
        let side = brick_extent(level);
        let mut remaining = counts[usize::from(level)];
        if remaining == 0 {
            continue;
        }
        let mut left_over = Vec::new();
        for gap in gaps {
            let run = fill(gap, side, remaining, &mut left_over);
            remaining -= run.count;
            runs.push((level, run));
        }
        let per_layer = (base[0] / side) as usize * (base[1] / side) as usize;
        // A height beyond any limit stays one: it must not wrap.
        let layers = u32::try_from(remaining.div_ceil(per_layer)).unwrap_or(u32::MAX);
        let stack = Space {
            origin: [0, 0, height],
            size: [base[0], base[1], layers.saturating_mul(side)],
        };
        runs.push((level, fill(stack, side, remaining, &mut left_over)));
        height = height.saturating_add(stack.size[2]);
        gaps = left_over;
    }
    runs.retain(|(_, run)| run.count > 0);
    Packing {
        extent: [base[0], base[1], height],
        runs,
    }
}

/// Puts up to `count` bricks into a space and adds what remains of it to `left_over`.
fn fill(space: Space, side: u32, count: usize, left_over: &mut Vec<Space>) -> Run {
    let Space {
        origin: [x, y, z],
        size,
    } = space;
    let [columns, rows, layers] = size.map(|n| (n / side) as usize);
    let count = count.min(columns * rows * layers);
    let run = Run {
        origin: space.origin,
        columns,
        rows,
        count,
        side,
    };
    if count == 0 {
        left_over.push(space);
        return run;
    }
    let mut keep = |origin, size: [u32; 3]| {
        if !size.contains(&0) {
            left_over.push(Space { origin, size });
        }
    };
    // The box around the bricks, and what is left behind, beside and above them.
    let layers = count.div_ceil(columns * rows);
    let width = columns.min(count) as u32 * side;
    let depth = rows.min(count.div_ceil(columns)) as u32 * side;
    let height = layers as u32 * side;
    keep([x, y, z + height], [size[0], size[1], size[2] - height]);
    keep([x, y + depth, z], [size[0], size[1] - depth, height]);
    keep([x + width, y, z], [size[0] - width, depth, height]);
    // In the box, the rows that the last layer lacks, and the end of its last row.
    let in_last = count - (layers - 1) * columns * rows;
    let top = z + height - side;
    let used = in_last.div_ceil(columns) as u32 * side;
    let end = ((in_last - 1) % columns + 1) as u32 * side;
    keep([x, y + used, top], [width, depth - used, side]);
    keep([x + end, y + used - side, top], [width - end, side, side]);
    run
}
