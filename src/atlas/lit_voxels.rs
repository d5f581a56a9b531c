//! Voxels whose light can be seen.
//!
//! A sample that shows something reads the light of the eight voxels around it. Cells between voxels whose range of values the
//! transfer function does not show hold no such sample, so that most of a volume needs no light.

use std::ops::Range;

use rayon::prelude::*;

use super::residency::{Residency, Store};
use crate::error::Result;
use crate::volume::blocks::{BLOCK_CELLS, BlockGrid, FINEST, brick_extent, brick_texels};
use crate::volume::bricks::BrickBuilder;
use crate::volume::cells::SKIP_CELLS;
use crate::volume::select::Classify;
use crate::volume::visible_ranges::VisibleRanges;

const WORD_BITS: usize = u64::BITS as usize;

/// Voxels on each axis whose bits are asked for together, and samples of a group of light work.
pub(crate) const GROUP: u32 = 4;
const EDGE: usize = GROUP as usize;

/// A bit for each voxel.
pub(crate) struct LitVoxels {
    size: [usize; 3],
    /// Words of a row.
    row: usize,
    bits: Vec<u64>,
}

/// Skip cells of which some sample may show something.
pub(crate) struct Occupancy<'a> {
    pub(crate) counts: [u32; 3],
    /// 0 for those that show nothing, x fastest.
    pub(crate) cells: &'a [u8],
    /// Values between samples may leave the range of the samples around them: nothing finer than skip cells is known.
    pub(crate) widened: bool,
}

impl LitVoxels {
    /// `reach`: how far from a place that shows something a sample may be that is lit for it, in voxels on each axis (half a step
    /// where what is shown is decided by the ends of segments).
    ///
    /// # Errors
    /// As [`BrickBuilder::new`].
    pub(crate) fn new(
        store: &Store,
        residency: &Residency,
        shown: &VisibleRanges<'_, impl Classify>,
        occupancy: &Occupancy<'_>,
        reach: [u32; 3],
    ) -> Result<Self> {
        let grid = store.grid();
        let size = grid.size().map(|n| n as usize);
        let row = size[0].div_ceil(WORD_BITS);
        let mut lit = Self {
            size,
            row,
            bits: vec![0; row * size[1] * size[2]],
        };
        let bricks = BrickBuilder::new(&store.volume, grid, &residency.selection.levels)?;
        let finder = CellFinder {
            bricks: &bricks,
            grid,
            occupancy,
            visible: &|stored| shown.visible(stored),
        };
        let slab = row * size[1] * BLOCK_CELLS as usize;
        let blocks = grid.counts().map(|n| n as usize);
        lit.bits
            .par_chunks_mut(slab)
            .take(blocks[2])
            .enumerate()
            .for_each(|(z, bits)| {
                let mut slab = Slab { size, row, bits };
                for block in (0..blocks[0] * blocks[1]).map(|at| at + blocks[0] * blocks[1] * z) {
                    finder.mark(block, &mut slab);
                }
            });
        lit.spread(reach.map(|n| n as usize));
        Ok(lit)
    }

    /// From cells, which carry the number of their first voxel, to the voxels around them and around their neighbours within reach.
    fn spread(&mut self, reach: [usize; 3]) {
        let [row, plane] = [self.row, self.row * self.size[1]];
        self.bits.par_chunks_mut(row).for_each(|words| {
            for _ in 0..=reach[0] {
                shift_up(words);
            }
            for _ in 0..reach[0] {
                shift_down(words);
            }
        });
        self.bits
            .par_chunks_mut(plane)
            .for_each(|plane| spread_rows(plane, row, reach[1]));
        spread_rows(&mut self.bits, plane, reach[2]);
        // Shifts may have left bits beyond the last voxel.
        let used = self.size[0] % WORD_BITS;
        if used > 0 {
            for words in self.bits.chunks_exact_mut(row) {
                words[row - 1] &= (1 << used) - 1;
            }
        }
    }

    /// The lit voxels of 4³ from `low` on, a bit each, x fastest. `low`: a multiple of 4 on x.
    pub(crate) fn group(&self, low: [u32; 3]) -> u64 {
        let [x, y, z] = low.map(|n| n as usize);
        debug_assert!(x.is_multiple_of(EDGE));
        if x >= self.size[0] {
            return 0;
        }
        let mut group = 0;
        for k in z..(z + EDGE).min(self.size[2]) {
            for j in y..(y + EDGE).min(self.size[1]) {
                let word = self.bits[self.row * (j + self.size[1] * k) + x / WORD_BITS];
                let voxels = word >> (x % WORD_BITS) & 0xf;
                group |= voxels << (EDGE * (j - y + EDGE * (k - z)));
            }
        }
        group
    }

    /// True when a voxel of a closed box is lit; what lies outside of the volume is not.
    pub(crate) fn any(&self, low: [i64; 3], high: [i64; 3]) -> bool {
        let clip =
            |a: usize| low[a].max(0) as usize..(high[a] + 1).clamp(0, self.size[a] as i64) as usize;
        let columns = clip(0);
        clip(2).any(|z| {
            clip(1).any(|y| has_bit(&self.bits[self.row * (y + self.size[1] * z)..], &columns))
        })
    }
}

/// True when one of a range of bits is set.
fn has_bit(words: &[u64], bits: &Range<usize>) -> bool {
    (bits.start / WORD_BITS..bits.end.div_ceil(WORD_BITS)).any(|word| {
        let first = bits.start.max(word * WORD_BITS) % WORD_BITS;
        let after = (word + 1) * WORD_BITS;
        let mask = u64::MAX << first & u64::MAX >> (after - bits.end.min(after));
        words[word] & mask != 0
    })
}

/// The rows of one layer of blocks.
struct Slab<'a> {
    size: [usize; 3],
    row: usize,
    bits: &'a mut [u64],
}

impl Slab<'_> {
    /// Marks the cells of a box `[low, high)`; z counts from the slab's first.
    fn mark(&mut self, low: [usize; 3], high: [usize; 3]) {
        for z in low[2]..high[2] {
            for y in low[1]..high[1] {
                let first = self.row * (y + self.size[1] * z);
                for x in low[0]..high[0] {
                    self.bits[first + x / WORD_BITS] |= 1 << (x % WORD_BITS);
                }
            }
        }
    }
}

struct CellFinder<'a> {
    bricks: &'a BrickBuilder<'a>,
    grid: &'a BlockGrid,
    occupancy: &'a Occupancy<'a>,
    /// Of a range of stored values.
    visible: &'a (dyn Fn([f32; 2]) -> bool + Sync),
}

impl CellFinder<'_> {
    /// Marks the cells of a block that show something.
    fn mark(&self, block: usize, slab: &mut Slab<'_>) {
        let Some(level) = self.bricks.levels().by_block[block] else {
            return;
        };
        let origin = self.grid.origin_ix(block);
        let cells = self.grid.cells(block);
        let occupied: Vec<[u32; 3]> = (0..cells.map(|n| n.div_ceil(SKIP_CELLS)).iter().product())
            .map(|at| {
                let [x, y, _] = cells.map(|n| n.div_ceil(SKIP_CELLS));
                [at % x, at / x % y, at / (x * y)]
            })
            .filter(|&cell| self.is_occupied(origin, cell))
            .collect();
        if occupied.is_empty() {
            return;
        }
        // Within the slab, whose first layer is the block's.
        let place = |cell: [u32; 3]| {
            [origin[0] + cell[0], origin[1] + cell[1], cell[2]].map(|n| n as usize)
        };
        if self.occupancy.widened {
            for cell in occupied {
                let low = cell.map(|n| n * SKIP_CELLS);
                let high = std::array::from_fn(|a| (low[a] + SKIP_CELLS).min(cells[a]));
                slab.mark(place(low), place(high));
            }
            return;
        }
        let mut samples = vec![0.0; brick_texels(level)];
        self.bricks.stored(block, &mut samples);
        let side = brick_extent(level) as usize;
        let shows = |cell: [u32; 3]| (self.visible)(range_of(&samples, side, cell));
        if level == FINEST {
            for skip in occupied {
                let low = skip.map(|n| n * SKIP_CELLS);
                let high: [u32; 3] = std::array::from_fn(|a| (low[a] + SKIP_CELLS).min(cells[a]));
                for cell in boxed(low, high).filter(|&cell| shows(cell)) {
                    slab.mark(place(cell), place(cell.map(|n| n + 1)));
                }
            }
        } else {
            let intervals = self.grid.intervals(block, level);
            for cell in boxed([0; 3], intervals).filter(|&cell| shows(cell)) {
                let low = std::array::from_fn(|a| cell[a] * cells[a] / intervals[a]);
                let high =
                    std::array::from_fn(|a| ((cell[a] + 1) * cells[a]).div_ceil(intervals[a]));
                slab.mark(place(low), place(high));
            }
        }
    }

    fn is_occupied(&self, origin_ix: [u32; 3], skip_cell: [u32; 3]) -> bool {
        let [x, y, z] = [0, 1, 2].map(|a| (origin_ix[a] / SKIP_CELLS + skip_cell[a]) as usize);
        let [width, height, _] = self.occupancy.counts.map(|n| n as usize);
        self.occupancy.cells[x + width * (y + height * z)] != 0
    }
}

/// Every place of a box `[low, high)`.
fn boxed(low: [u32; 3], high: [u32; 3]) -> impl Iterator<Item = [u32; 3]> {
    (low[2]..high[2]).flat_map(move |z| {
        (low[1]..high[1]).flat_map(move |y| (low[0]..high[0]).map(move |x| [x, y, z]))
    })
}

/// Smallest and largest of the eight samples around a cell.
fn range_of(samples: &[f32], side: usize, cell: [u32; 3]) -> [f32; 2] {
    let [x, y, z] = cell.map(|n| n as usize);
    let first = x + side * (y + side * z);
    let rows = [0, side, side * side, side * side + side];
    rows.iter()
        .fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], row| {
            let [a, b] = [samples[first + row], samples[first + row + 1]];
            [low.min(a).min(b), high.max(a).max(b)]
        })
}

/// Adds to each bit the one below it.
fn shift_up(words: &mut [u64]) {
    let mut carry = 0;
    for word in words {
        let top = *word >> (WORD_BITS - 1);
        *word |= *word << 1 | carry;
        carry = top;
    }
}

/// Adds to each bit the one above it.
fn shift_down(words: &mut [u64]) {
    let mut carry = 0;
    for word in words.iter_mut().rev() {
        let bottom = *word << (WORD_BITS - 1);
        *word |= *word >> 1 | carry;
        carry = bottom;
    }
}

/// Adds to each item of so many words those up to `reach` after it and up to `reach + 1` before it.
fn spread_rows(words: &mut [u64], item: usize, reach: usize) {
    for _ in 0..=reach {
        for at in (item..words.len()).rev() {
            words[at] |= words[at - item];
        }
    }
    for _ in 0..reach {
        for at in 0..words.len() - item {
            words[at] |= words[at + item];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Spread of one cell, axis by axis, against the definition.
    #[test]
    fn a_cell_lights_the_voxels_around_its_neighbors_within_reach() {
        let size = [130usize, 5, 4];
        for (cell, reach) in [
            ([63, 2, 1], [0, 0, 0]),
            ([64, 0, 2], [2, 1, 1]),
            ([127, 3, 0], [3, 0, 2]),
        ] {
            let row = size[0].div_ceil(WORD_BITS);
            let mut lit = LitVoxels {
                size,
                row,
                bits: vec![0; row * size[1] * size[2]],
            };
            let mut slab = Slab {
                size,
                row,
                bits: &mut lit.bits,
            };
            slab.mark(cell, cell.map(|n| n + 1));
            lit.spread(reach);
            for z in 0..size[2] {
                for y in 0..size[1] {
                    for x in 0..size[0] {
                        let at = [x, y, z];
                        let expected = (0..3).all(|a| {
                            at[a] + reach[a] >= cell[a] && at[a] <= cell[a] + 1 + reach[a]
                        });
                        let place = at.map(|n| n as i64);
                        assert_eq!(
                            lit.any(place, place),
                            expected,
                            "{at:?} for {cell:?}, reach {reach:?}"
                        );
                    }
                }
            }
            for low in [[60, 1, 0], [64, 0, 1], [124, 2, 2], [128, 4, 3]] {
                let group = lit.group(low);
                for bit in 0..64 {
                    let place = [bit % 4, bit / 4 % 4, bit / 16];
                    let place = std::array::from_fn(|a| i64::from(low[a] + place[a]));
                    assert_eq!(group >> bit & 1 != 0, lit.any(place, place), "{place:?}");
                }
            }
            assert!(!lit.any([-4, -4, -4], [-1, 9, 9]), "nothing lies outside");
            assert!(lit.any([-4; 3], [200; 3]));
        }
    }
}
