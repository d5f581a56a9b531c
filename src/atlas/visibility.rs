//! What the transfer function shows of the resident bricks.

use std::sync::{Arc, OnceLock};

use crate::error::Result;
use crate::scene::Interpolation;
use crate::volume::blocks::{BLOCK_CELLS, BlockGrid, FINEST};
use crate::volume::cells::{CellGrid, Reach, SKIP_CELLS};
use crate::volume::leaps::octant_leaps;
use crate::volume::shown_cells::{ShownCells, shown_cells};
use crate::volume::visible_ranges::{VisibleEnds, VisibleRanges};

use super::light_work::LightWork;
use super::lit_voxels::{LitVoxels, Occupancy};
use super::residency::{Residency, Store};
use super::{SampleScale, Shown};

/// Leaps through empty space, and the samples of the light volume that can be seen.
pub(crate) struct Visibility {
    /// By skip cell: see [`octant_leaps`]; [`WHOLE_BLOCK`] for a 0 whose whole block is 0.
    pub(crate) leaps: Arc<Vec<u32>>,
    /// See [`shown_cells()`]; `None` where nobody asks, or nothing finer than skip cells is known.
    pub(crate) cells: Option<Vec<ShownCells>>,
    /// What was asked for.
    cells_asked: Option<f64>,
    pub(crate) light: LightWork,
    /// How far the filter looks.
    reach: Option<Reach>,
    /// All that the transfer function says of ranges of integers.
    ends: Option<VisibleEnds>,
    /// Of skip cells.
    counts: [u32; 3],
    /// [`Visibility::bounds`], once they were asked for.
    bounds: OnceLock<Option<[[u32; 3]; 2]>>,
}

/// What visibility follows from.
#[derive(Clone, Copy)]
pub(crate) struct VisibilityRequest<'a> {
    pub(crate) store: &'a Store,
    pub(crate) residency: &'a Residency,
    pub(crate) shown: Shown<'a>,
    pub(crate) interpolation: Interpolation,
    /// Light is wanted, for samples so far from what shows something (see [`LitVoxels::new`]).
    pub(crate) lit: Option<[u32; 3]>,
    /// Cells between voxels are wanted where at most this share of those in visible skip cells shows something.
    pub(crate) cells: Option<f64>,
}

impl Visibility {
    /// # Errors
    /// As [`LitVoxels::new`].
    pub(crate) fn new(request: &VisibilityRequest<'_>) -> Result<Self> {
        let ranges = request.ranges();
        let occupancy = request.occupancy(&ranges);
        Ok(Self {
            leaps: request.leaps(&occupancy).into(),
            cells: request.shown_cells(&ranges, &occupancy),
            cells_asked: request.cells,
            light: request.light(&ranges, &occupancy)?,
            reach: request.reach(),
            ends: ranges.into_ends(),
            counts: request.residency.cells.counts(),
            bounds: OnceLock::new(),
        })
    }

    /// The same for another transfer function or filter, of which residency and light are those that this was made for; `None` where all is
    /// as it was.
    ///
    /// # Errors
    /// As [`LitVoxels::new`].
    pub(crate) fn changed(&self, request: &VisibilityRequest<'_>) -> Result<Option<Self>> {
        let ranges = request.ranges();
        let reach = request.reach();
        // What a wider filter returns may lie between integers.
        let by_ends = reach.is_none() && self.reach.is_none() && self.ends.is_some();
        let same_wish = request.cells == self.cells_asked;
        if by_ends && same_wish && ranges.ends() == self.ends.as_ref() {
            return Ok(None);
        }
        let occupancy = request.occupancy(&ranges);
        let occupied = self.leaps.iter().map(|&word| word <= WHOLE_BLOCK);
        let same_cells = occupied.eq(occupancy.iter().map(|&cell| cell != 0));
        let cells = request.shown_cells(&ranges, &occupancy);
        if same_cells && request.lit.is_none() && cells == self.cells {
            return Ok(None);
        }
        Ok(Some(Self {
            leaps: if same_cells {
                Arc::clone(&self.leaps)
            } else {
                request.leaps(&occupancy).into()
            },
            cells,
            cells_asked: request.cells,
            light: request.light(&ranges, &occupancy)?,
            reach,
            ends: ranges.into_ends(),
            counts: request.residency.cells.counts(),
            bounds: if same_cells {
                self.bounds.clone()
            } else {
                OnceLock::new()
            },
        }))
    }

    /// First and last of the skip cells that show something, on each axis; `None` where nothing shows.
    pub(crate) fn bounds(&self) -> Option<[[u32; 3]; 2]> {
        let [width, height, _] = self.counts;
        let shows = |&word: &u32| word <= WHOLE_BLOCK;
        let of_row = |(row, words): (usize, &[u32])| {
            let [first, last] = [
                words.iter().position(shows)?,
                words.iter().rposition(shows)?,
            ];
            let row = row as u32;
            let at = |x: usize| [x as u32, row % height, row / height];
            Some([at(first), at(last)])
        };
        let join = |[low, high]: [[u32; 3]; 2], [first, last]: [[u32; 3]; 2]| {
            let each = |pick: fn(u32, u32) -> u32, a: [u32; 3], b: [u32; 3]| {
                std::array::from_fn(|axis| pick(a[axis], b[axis]))
            };
            [each(u32::min, low, first), each(u32::max, high, last)]
        };
        *self.bounds.get_or_init(|| {
            let rows = self.leaps.chunks_exact(width as usize).enumerate();
            rows.filter_map(of_row).reduce(join)
        })
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

impl<'a> VisibilityRequest<'a> {
    fn ranges(&self) -> VisibleRanges<'_, Shown<'a>> {
        VisibleRanges::new(&self.store.volume, &self.shown)
    }

    fn reach(&self) -> Option<Reach> {
        Visibility::reach(self.residency, self.interpolation)
    }

    /// By skip cell: 0 where none of its values shows anything.
    fn occupancy(&self, ranges: &VisibleRanges<'_, Shown<'_>>) -> Vec<u8> {
        let cells = &self.residency.cells;
        let visible = |stored| ranges.visible(stored);
        match self.reach() {
            None => cells.occupancy(visible),
            Some(reach) => cells.widened(reach).occupancy(visible),
        }
    }

    fn leaps(&self, occupancy: &[u8]) -> Vec<u32> {
        let counts = self.residency.cells.counts();
        let mut leaps = octant_leaps(counts, occupancy);
        mark_whole_blocks(self.store.grid(), counts, &mut leaps);
        leaps
    }

    fn shown_cells(
        &self,
        ranges: &VisibleRanges<'_, Shown<'_>>,
        occupancy: &[u8],
    ) -> Option<Vec<ShownCells>> {
        // Those of coarser bricks, and of wider filters, say nothing.
        if !self.residency.layout.is_grid() || self.reach().is_some() {
            return None;
        }
        let volume = &self.store.volume;
        let counts = self.residency.cells.counts();
        shown_cells(
            volume.voxels(),
            volume.size(),
            counts,
            occupancy,
            ranges.ends()?,
            self.cells?,
        )
    }

    fn light(&self, ranges: &VisibleRanges<'_, Shown<'_>>, occupancy: &[u8]) -> Result<LightWork> {
        let Some(reach) = self.lit else {
            return Ok(LightWork::default());
        };
        let Self {
            store, residency, ..
        } = *self;
        let occupancy = Occupancy {
            counts: residency.cells.counts(),
            cells: occupancy,
            widened: self.reach().is_some(),
        };
        let lit = LitVoxels::new(store, residency, ranges, &occupancy, reach)?;
        Ok(LightWork::new(store.grid(), residency, &occupancy, &lit))
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
