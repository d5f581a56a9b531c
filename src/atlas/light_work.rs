//! Which samples of the light volume are computed, and by whom.
//!
//! Light is needed where the march can see it ([`LitVoxels`]). Groups of 4^3 samples are the unit of work, each with a bit for every
//! sample that is needed; the list of groups with the table of bricks is the reverse index, atlas to volume, of Hernell et
//! al. (there a texture with one texel for 4^3 voxels of the atlas). Differs from the paper: bricks of 1^3 and 2^3 voxels take
//! part where they can be seen. Where bricks do not share their samples, those on borders are all listed next to a visible skip
//! cell: one brick traces a sample and the others that have it follow (`sharing_of` in light_work.glsl says whom).

use rayon::prelude::*;

use crate::shader::structs::BrickRecord;
use crate::volume::blocks::{BLOCK_CELLS, BlockGrid, LEVELS};
use crate::volume::cells::SKIP_CELLS;

use super::lit_voxels::{GROUP, LitVoxels, Occupancy};
use super::residency::Residency;

/// Index into the table of bricks; group inside the brick, 8 bits an axis; the samples, a bit each, x fastest.
pub(crate) type WorkEntry = [u32; 4];

fn entry(brick: usize, group: u32, samples: u64) -> WorkEntry {
    [brick as u32, group, samples as u32, (samples >> 32) as u32]
}

/// Work lists of the light passes; empty when there is no light.
#[derive(Default)]
pub(crate) struct LightWork {
    /// Bricks that the lists refer to.
    pub(crate) bricks: Vec<BrickRecord>,
    /// Linear block index of each brick.
    pub(crate) blocks: Vec<usize>,
    /// Groups to trace.
    pub(crate) trace: Vec<WorkEntry>,
    /// Groups with samples that other bricks compute, and the range of each level, coarsest first.
    pub(crate) seam: Vec<WorkEntry>,
    /// First entry of each level in `seam`, and the end.
    pub(crate) seam_levels: [usize; LEVELS + 1],
}

/// The groups of one brick.
struct BrickWork {
    block: usize,
    level: u8,
    trace: Vec<(u32, u64)>,
    seam: Vec<(u32, u64)>,
}

impl LightWork {
    /// What of the bricks is lit.
    pub(crate) fn new(
        grid: &BlockGrid,
        residency: &Residency,
        occupancy: &Occupancy<'_>,
        lit: &LitVoxels,
    ) -> Self {
        let finder = GroupFinder {
            grid,
            residency,
            occupancy,
            lit,
        };
        let work: Vec<BrickWork> = (0..grid.len())
            .into_par_iter()
            .filter_map(|block| finder.brick(block))
            .collect();
        let mut lists = Self {
            bricks: Vec::with_capacity(work.len()),
            blocks: Vec::with_capacity(work.len()),
            trace: Vec::new(),
            seam: Vec::new(),
            seam_levels: [0; LEVELS + 1],
        };
        for (index, w) in work.iter().enumerate() {
            let Some(origin_at) = residency.layout.origins()[w.block] else {
                continue;
            };
            lists.bricks.push(BrickRecord {
                origin_at,
                level: w.level.into(),
                block_bx: grid.position(w.block).map(|b| b as i32),
                pad0: 0,
            });
            lists.blocks.push(w.block);
            lists.trace.extend(
                w.trace
                    .iter()
                    .map(|&(group, samples)| entry(index, group, samples)),
            );
        }
        for level in 0..LEVELS {
            for (index, w) in work
                .iter()
                .enumerate()
                .filter(|(_, w)| usize::from(w.level) == level)
            {
                lists.seam.extend(
                    w.seam
                        .iter()
                        .map(|&(group, samples)| entry(index, group, samples)),
                );
            }
            lists.seam_levels[level + 1] = lists.seam.len();
        }
        lists
    }

    /// Group coordinates of an entry, and its samples.
    pub(crate) fn group(&[_, packed, low, high]: &WorkEntry) -> ([u32; 3], u64) {
        let group = [packed & 255, (packed >> 8) & 255, packed >> 16];
        (group, u64::from(low) | u64::from(high) << 32)
    }

    /// True when the same samples are traced and copied.
    pub(crate) fn lists_equal(&self, other: &Self) -> bool {
        self.trace == other.trace && self.seam == other.seam && self.blocks == other.blocks
    }

    /// Samples that are traced.
    pub(crate) fn samples(&self) -> u64 {
        let samples = |entry| u64::from(Self::group(entry).1.count_ones());
        self.trace.iter().map(samples).sum()
    }
}

struct GroupFinder<'a> {
    grid: &'a BlockGrid,
    residency: &'a Residency,
    occupancy: &'a Occupancy<'a>,
    lit: &'a LitVoxels,
}

impl GroupFinder<'_> {
    fn level(&self, block: usize) -> Option<u8> {
        self.residency.selection.levels.by_block[block]
    }

    /// The groups of a brick that are needed; `None` when there is none.
    fn brick(&self, block: usize) -> Option<BrickWork> {
        let level = self.level(block)?;
        let intervals = self.grid.intervals(block, level);
        let computed = self.computed(block, level);
        let mut work = BrickWork {
            block,
            level,
            trace: Vec::new(),
            seam: Vec::new(),
        };
        let groups = intervals.map(|n| n / GROUP + 1);
        // Where the atlas is the volume itself, bricks share their samples, and nothing has to be copied.
        let shared = self.residency.layout.is_grid();
        for z in 0..groups[2] {
            for y in 0..groups[1] {
                for x in 0..groups[0] {
                    let group = [x, y, z];
                    let mut samples = self.lit_samples(block, intervals, group);
                    let border = border_samples(intervals, group);
                    if !shared && border != 0 && self.is_near_visible(block, level, group) {
                        samples |= border;
                    }
                    let packed = x | y << 8 | z << 16;
                    let elsewhere = samples_where(border & samples, group, |sample| {
                        !computed[place_on_border(intervals, sample)]
                    });
                    if samples != elsewhere {
                        work.trace.push((packed, samples & !elsewhere));
                    }
                    if !shared && elsewhere != 0 {
                        work.seam.push((packed, elsewhere));
                    }
                }
            }
        }
        (!work.trace.is_empty() || !work.seam.is_empty()).then_some(work)
    }

    /// By place on the border of a brick ([`place_on_border`]): are its samples computed there? Of the resident blocks whose closed
    /// boxes contain a sample, the coarsest decide what light it has, and of those of one level the last in x-fastest order.
    fn computed(&self, block: usize, level: u8) -> [bool; 27] {
        std::array::from_fn(|place| {
            let side = [place % 3, place / 3 % 3, place / 9].map(|n| n as i32 - 1);
            let steps = |axis: usize| side[axis].min(0)..=side[axis].max(0);
            let mut owner = true;
            for z in steps(2) {
                for y in steps(1) {
                    for x in steps(0) {
                        let there = self.grid.neighbor(block, [x, y, z]);
                        match there.and_then(|there| self.level(there)) {
                            Some(other) if other < level => return false,
                            Some(other) if other == level => owner = [x, y, z] == [0; 3],
                            _ => {}
                        }
                    }
                }
            }
            owner
        })
    }

    /// The samples of a group that are lit.
    fn lit_samples(&self, block: usize, intervals: [u32; 3], group: [u32; 3]) -> u64 {
        let base = self.grid.origin_ix(block);
        let cells = self.grid.cells(block);
        // From one sample to another: what is strictly nearer than the next sample on either side; at the finest level of a single
        // sample, its voxel.
        let any_between = |first: [u32; 3], last: [u32; 3]| {
            let scale = |a: usize| [cells[a], intervals[a]].map(i64::from);
            let low = std::array::from_fn(|a| {
                let [cells, intervals] = scale(a);
                i64::from(base[a]) + ((i64::from(first[a]) - 1) * cells).div_euclid(intervals) + 1
            });
            let high = std::array::from_fn(|a| {
                let [cells, intervals] = scale(a);
                i64::from(base[a]) + ((i64::from(last[a]) + 1) * cells - 1).div_euclid(intervals)
            });
            self.lit.any(low, high)
        };
        let first = group.map(|g| g * GROUP);
        let there = samples_there(intervals, group);
        if intervals == cells {
            return there & self.lit.group(std::array::from_fn(|a| base[a] + first[a]));
        }
        // Most groups of most volumes are dark.
        if !any_between(first, first.map(|s| s + GROUP - 1)) {
            return 0;
        }
        samples_where(there, group, |sample| any_between(sample, sample))
    }

    /// True when a visible skip cell lies where the samples of a group have weight, or have in a neighbour of this level: samples of
    /// the last block of an axis may lie nearer to each other than those that they share a border with.
    fn is_near_visible(&self, block: usize, level: u8, group: [u32; 3]) -> bool {
        let base = self.grid.origin_ix(block);
        let cells = self.grid.cells(block);
        let intervals = self.grid.intervals(block, level);
        let reach = f64::from(BLOCK_CELLS >> level);
        let ranges: [std::ops::Range<u32>; 3] = std::array::from_fn(|a| {
            let stride = f64::from(cells[a]) / f64::from(intervals[a]);
            let [first, last] = [0, GROUP - 1].map(|s| (group[a] * GROUP + s).min(intervals[a]));
            let at = |sample: u32, beyond: f64| {
                (f64::from(base[a]) + f64::from(sample) * stride + beyond) / f64::from(SKIP_CELLS)
            };
            // Rounding of the stride must not lose a cell.
            let low = (at(first, -reach) - 1e-9).floor().max(0.0) as u32;
            let high = (at(last, reach) + 1e-9).ceil() as u32;
            low..high.min(self.occupancy.counts[a])
        });
        let [width, height, _] = self.occupancy.counts.map(|n| n as usize);
        ranges[2].clone().any(|z| {
            ranges[1].clone().any(|y| {
                let row = width * (y as usize + height * z as usize);
                self.occupancy.cells[row + ranges[0].start as usize..row + ranges[0].end as usize]
                    .iter()
                    .any(|&o| o != 0)
            })
        })
    }
}

/// The samples of a group, of those given, for which `holds`.
fn samples_where(samples: u64, group: [u32; 3], holds: impl Fn([u32; 3]) -> bool) -> u64 {
    let (mut left, mut held) = (samples, 0);
    while left != 0 {
        let bit = left.trailing_zeros();
        let inside = [bit % GROUP, bit / GROUP % GROUP, bit / GROUP.pow(2)];
        if holds(std::array::from_fn(|a| group[a] * GROUP + inside[a])) {
            held |= 1 << bit;
        }
        left &= left - 1;
    }
    held
}

/// Of a group, a bit each and x fastest, the samples that are first on an axis.
const FIRST: [u64; 3] = [0x1111_1111_1111_1111, 0x000f_000f_000f_000f, 0xffff];

/// Those that are at a place on an axis.
fn samples_at(axis: usize, place: u32) -> u64 {
    FIRST[axis] << (place * GROUP.pow(axis as u32))
}

/// The samples of a group that exist.
fn samples_there(intervals: [u32; 3], group: [u32; 3]) -> u64 {
    (0..3).fold(u64::MAX, |there, axis| {
        let left = (intervals[axis] + 1).saturating_sub(group[axis] * GROUP);
        there & (0..left.min(GROUP)).fold(0, |on_axis, place| on_axis | samples_at(axis, place))
    })
}

/// Those on the border of the brick.
fn border_samples(intervals: [u32; 3], group: [u32; 3]) -> u64 {
    let border = (0..3).fold(0, |border, axis| {
        let low = if group[axis] == 0 {
            samples_at(axis, 0)
        } else {
            0
        };
        let high = if intervals[axis] / GROUP == group[axis] {
            samples_at(axis, intervals[axis] % GROUP)
        } else {
            0
        };
        border | low | high
    });
    border & samples_there(intervals, group)
}

/// Where on the border of its brick a sample lies: for each axis 0 at the low end, 1 between, 2 at the high end, x counting 1, y 3
/// and z 9.
fn place_on_border(intervals: [u32; 3], sample: [u32; 3]) -> usize {
    (0..3).rev().fold(0, |place, a| {
        let side = match sample[a] {
            0 => 0,
            n if n == intervals[a] => 2,
            _ => 1,
        };
        3 * place + side
    })
}

const _: () = assert!(BLOCK_CELLS / GROUP < 256, "a group coordinate fits 8 bits");

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::atlas::Store;
    use crate::volume::blocks::Levels;
    use crate::volume::select::{Classify, Selection};
    use crate::volume::visible_ranges::VisibleRanges;
    use crate::volume::{Volume, Voxels};

    struct AboveHalf;

    impl Classify for AboveHalf {
        fn premultiplied(&self, value: f64) -> [f32; 7] {
            [if value > 127.0 { 1.0 } else { 0.0 }; 7]
        }

        fn visible(&self, [_, high]: [f64; 2]) -> bool {
            high > 127.0
        }
    }

    #[test]
    fn samples_of_groups_are_there_and_on_borders_as_their_places_say() {
        for intervals in [[16; 3], [1, 2, 4], [5, 16, 7], [3, 8, 15]] {
            for at in 0..125 {
                let group = [at % 5, at / 5 % 5, at / 25];
                let (mut there, mut border) = (0, 0);
                for bit in 0..64 {
                    let sample: [u32; 3] = [bit % 4, bit / 4 % 4, bit / 16];
                    let sample = std::array::from_fn(|a| 4 * group[a] + sample[a]);
                    let inside = (0..3).all(|a| sample[a] <= intervals[a]);
                    let on_border = (0..3).any(|a| sample[a] == 0 || sample[a] == intervals[a]);
                    there |= u64::from(inside) << bit;
                    border |= u64::from(inside && on_border) << bit;
                    assert_eq!(samples_where(1 << bit, group, |s| s == sample), 1 << bit);
                }
                assert_eq!(
                    samples_there(intervals, group),
                    there,
                    "{intervals:?} {group:?}"
                );
                assert_eq!(
                    border_samples(intervals, group),
                    border,
                    "{intervals:?} {group:?}"
                );
            }
        }
    }

    /// A sample that a brick takes over is computed or taken over by the brick that it comes from, wherever something visible is
    /// nearer to it than the next sample; whatever the levels, and where the last blocks of the axes are narrow.
    #[test]
    fn what_is_taken_over_is_computed() {
        let mut state = 7u32;
        let mut random = move |below: u32| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) % below
        };
        let mut checked = 0;
        for _ in 0..40 {
            let size = [0; 3].map(|_| 18 + random(18));
            let mut voxels = vec![0; size.iter().product::<u32>() as usize];
            for _ in 0..1 + random(4) {
                voxels[random(size.iter().product()) as usize] = 255;
            }
            let volume = Volume::axis_aligned(Voxels::U8(voxels), size, [1.0; 3]).unwrap();
            let store = Store::new(Arc::new(volume)).unwrap();
            let grid = store.grid();
            let by_block = (0..grid.len()).map(|_| (random(8) > 0).then(|| random(5) as u8));
            let selection = Selection {
                levels: Levels {
                    by_block: by_block.collect(),
                },
                data_reduction: 1.0,
                by_level: [0; LEVELS],
                error: 0.0,
                dropped: 0,
            };
            let residency = Residency::new(&store, selection, 4096).unwrap();
            if residency.layout.is_grid() {
                continue;
            }
            // Bricks hold means; what is visible of them decides, cell by cell.
            let shown = VisibleRanges::new(&store.volume, &AboveHalf);
            let cells = residency.cells.occupancy(|stored| shown.visible(stored));
            let occupancy = Occupancy {
                counts: residency.cells.counts(),
                cells: &cells,
                widened: false,
            };
            let lit = LitVoxels::new(&store, &residency, &shown, &occupancy, [0; 3]).unwrap();
            let work = LightWork::new(grid, &residency, &occupancy, &lit);
            checked += check(grid, &residency, &occupancy, &work);
        }
        assert!(checked > 1000, "{checked} samples");
    }

    /// Checks every sample taken over that something visible is near to, and counts them.
    fn check(
        grid: &BlockGrid,
        residency: &Residency,
        occupancy: &Occupancy<'_>,
        work: &LightWork,
    ) -> usize {
        let mut listed = std::collections::BTreeSet::new();
        for entry in work.trace.iter().chain(&work.seam) {
            for sample in samples_of(entry) {
                listed.insert((work.blocks[entry[0] as usize], sample));
            }
        }
        let level = |block: usize| residency.selection.levels.by_block[block];
        let mut checked = 0;
        for entry in &work.seam {
            let block = work.blocks[entry[0] as usize];
            let own = level(block).unwrap();
            let spacing = |block: usize, a: usize| {
                let intervals = grid.intervals(block, level(block).unwrap());
                f64::from(grid.cells(block)[a]) / f64::from(intervals[a])
            };
            for sample in samples_of(entry) {
                let at: [f64; 3] = std::array::from_fn(|a| {
                    f64::from(grid.origin_ix(block)[a]) + f64::from(sample[a]) * spacing(block, a)
                });
                let near = (0..occupancy.cells.len()).any(|cell| {
                    occupancy.cells[cell] != 0 && {
                        let place = cell_position(occupancy, cell);
                        (0..3).all(|a| {
                            let low = f64::from(place[a] * SKIP_CELLS);
                            let high = low + f64::from(SKIP_CELLS);
                            at[a] + spacing(block, a) > low && at[a] - spacing(block, a) < high
                        })
                    }
                });
                if !near {
                    continue;
                }
                // Whose closed boxes contain it: the coarsest level, and of that the last.
                let mut from: Option<(u8, usize)> = None;
                for other in 0..grid.len() {
                    let Some(other_level) = level(other) else {
                        continue;
                    };
                    let inside = (0..3).all(|a| {
                        let low = f64::from(grid.origin_ix(other)[a]);
                        (low..=low + f64::from(grid.cells(other)[a])).contains(&at[a])
                    });
                    if inside && from.is_none_or(|(coarsest, _)| other_level <= coarsest) {
                        from = Some((other_level, other));
                    }
                }
                let (from_level, from) = from.unwrap();
                assert!(from != block && from_level <= own, "{at:?}");
                // Those between which it lies there.
                let between: [[u32; 2]; 3] = std::array::from_fn(|a| {
                    let place = (at[a] - f64::from(grid.origin_ix(from)[a])) / spacing(from, a);
                    [(place + 1e-6).floor() as u32, (place - 1e-6).ceil() as u32]
                });
                for corner in 0..8 {
                    let there = std::array::from_fn(|a| between[a][corner >> a & 1]);
                    assert!(
                        listed.contains(&(from, there)),
                        "sample {sample:?} of block {block} at {at:?}, level {own}: block {from}, level {from_level}, does not list {there:?}"
                    );
                    checked += 1;
                }
            }
        }
        checked
    }

    fn samples_of(entry: &WorkEntry) -> impl Iterator<Item = [u32; 3]> {
        let (group, samples) = LightWork::group(entry);
        (0..GROUP.pow(3))
            .filter(move |bit| samples >> bit & 1 != 0)
            .map(move |bit| {
                let inside = [bit % GROUP, bit / GROUP % GROUP, bit / GROUP.pow(2)];
                std::array::from_fn(|a| group[a] * GROUP + inside[a])
            })
    }

    fn cell_position(occupancy: &Occupancy<'_>, cell: usize) -> [u32; 3] {
        let [width, height, _] = occupancy.counts;
        let cell = cell as u32;
        [cell % width, cell / width % height, cell / (width * height)]
    }
}
