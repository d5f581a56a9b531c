//! What the transfer function shows of the resident bricks.

use crate::error::Result;
use crate::scene::Interpolation;
use crate::volume::blocks::{BLOCK_CELLS, BlockGrid, FINEST};
use crate::volume::cells::{CellGrid, Reach, SKIP_CELLS};
use crate::volume::leaps::octant_leaps;
use crate::volume::select::Classify as _;

use super::light_work::LightWork;
use super::lit_voxels::{LitVoxels, Occupancy};
use super::residency::{Residency, Store};
use super::{SampleScale, Shown};

/// Leaps through empty space, and the samples of the light volume that can be seen.
pub(crate) struct Visibility {
    /// By skip cell: see [`octant_leaps`]; [`WHOLE_BLOCK`] for a 0 whose whole block is 0.
    pub(crate) leaps: Vec<u32>,
    pub(crate) light: LightWork,
}

impl Visibility {
    /// `lit`: light is wanted, for samples so far from what shows something (see [`LitVoxels::new`]).
    ///
    /// # Errors
    /// As [`LitVoxels::new`].
    pub(crate) fn new(
        store: &Store,
        residency: &Residency,
        shown: &Shown<'_>,
        interpolation: Interpolation,
        lit: Option<[u32; 3]>,
    ) -> Result<Self> {
        let counts = residency.cells.counts();
        let visible = |range| shown.visible(range);
        let widened = Self::reach(residency, interpolation);
        let occupancy = match widened {
            None => residency.cells.occupancy(visible),
            Some(reach) => residency.cells.widened(reach).occupancy(visible),
        };
        let light = match lit {
            None => LightWork::default(),
            Some(reach) => {
                let occupancy = Occupancy {
                    counts,
                    cells: &occupancy,
                    widened: widened.is_some(),
                };
                let lit = LitVoxels::new(store, residency, shown, &occupancy, reach)?;
                LightWork::new(store.grid(), residency, &occupancy, &lit)
            }
        };
        let mut leaps = octant_leaps(counts, &occupancy);
        mark_whole_blocks(store.grid(), counts, &mut leaps);
        Ok(Self { leaps, light })
    }

    /// Linear indices of the skip cells that show something.
    pub(crate) fn visible_cells(&self) -> impl Iterator<Item = usize> {
        let leaps = self.leaps.iter().enumerate();
        leaps
            .filter(|&(_, &word)| word <= WHOLE_BLOCK)
            .map(|(cell, _)| cell)
    }

    /// Value ranges of skip cells, for projections of values: `[least, largest]` texture samples of each.
    pub(crate) fn sample_ranges(
        residency: &Residency,
        interpolation: Interpolation,
        samples: SampleScale,
    ) -> Vec<[f32; 2]> {
        let ranges = |cells: &CellGrid| {
            (0..cells.len())
                .map(|cell| {
                    // Nothing there is neither above nor below anything.
                    let Some(range) = cells.value_range(cell) else {
                        return [f32::INFINITY, f32::NEG_INFINITY];
                    };
                    let mut range = range.map(|v| samples.sample(v) as f32);
                    range.sort_by(f32::total_cmp);
                    // What the device interpolates may be off by rounding.
                    let margin = 1e-6 * range[0].abs().max(range[1].abs());
                    [range[0] - margin, range[1] + margin]
                })
                .collect()
        };
        match Self::reach(residency, interpolation) {
            None => ranges(&residency.cells),
            Some(reach) => ranges(&residency.cells.widened(reach)),
        }
    }

    /// How far beyond a skip cell a filter looks; `None` for those that do not.
    pub(super) fn reach(residency: &Residency, interpolation: Interpolation) -> Option<Reach> {
        if !interpolation.is_cubic() {
            return None;
        }
        let coarsest = residency.selection.levels.by_block.iter().flatten().min();
        // One sample beyond the cell's own: a voxel at the finest level, and always less than half the spacing in cells more.
        let spacing = BLOCK_CELLS >> coarsest.copied().unwrap_or(FINEST);
        Some(Reach {
            cells: (spacing / 2).max(1),
            // Catmull-Rom's weights sum to 1.25^3 in magnitude.
            overshoot: if interpolation == Interpolation::CatmullRom {
                0.98
            } else {
                0.0
            },
        })
    }
}

/// The shaders' `WHOLE_BLOCK`. No leaps are packed like this: where one octant has some, all have.
const WHOLE_BLOCK: u32 = 1;

/// Marks the cells of blocks of which every cell shows something, so that rays cross them in longer runs.
fn mark_whole_blocks(grid: &BlockGrid, counts: [u32; 3], leaps: &mut [u32]) {
    let [width, height, _] = counts.map(|n| n as usize);
    let per_block = BLOCK_CELLS / SKIP_CELLS;
    for block in 0..grid.len() {
        let ranges: [std::ops::Range<usize>; 3] = std::array::from_fn(|a| {
            let first = grid.position(block)[a] * per_block;
            first as usize..(first + per_block).min(counts[a]) as usize
        });
        let [x, y, z] = ranges;
        let rows: Vec<usize> = z
            .flat_map(|z| y.clone().map(move |y| width * (y + height * z)))
            .collect();
        let whole = rows
            .iter()
            .all(|r| leaps[r + x.start..r + x.end].iter().all(|&d| d == 0));
        if whole {
            for r in rows {
                leaps[r + x.start..r + x.end].fill(WHOLE_BLOCK);
            }
        }
    }
}
