//! Which cells between voxels may show something: a bit for each.

use rayon::prelude::*;

use super::Voxels;
use super::cells::SKIP_CELLS;
use super::visible_ranges::VisibleEnds;

/// Intervals of values that are compared with, at most; of more those that lie closest together count as one.
const MOST_INTERVALS: usize = 8;

/// Rows of skip cells that an estimate looks at, at most.
const ROWS_LOOKED_AT: usize = 64;

const EDGE: usize = SKIP_CELLS as usize;

/// Cells between voxels along x, y, z that a [`ShownCells`] tells of: its skip cell's and the first ones behind it, so that most boxes of
/// a few cells lie in one.
pub const REACH: [usize; 3] = [6, 5, 4];

/// What may show in and around a skip cell: a word for each slice, in it rows of [`REACH`]`[0]` bits, x fastest.
pub type ShownCells = [u32; REACH[2]];

/// By skip cell, x fastest, a bit for each cell between voxels in its reach: 0 only where trilinear interpolation in this cell and
/// in the next ones along all axes, or any of the voxels around these eight, shows nothing. Skip cells with an `occupancy` of 0 show nothing.
///
/// `None` where voxels are no integers, and where more than `most` of the cells in occupied skip cells show something, as estimated from
/// some of them.
///
/// # Panics
/// When `occupancy` does not have one entry for each of `counts` skip cells of a volume of `size`.
pub fn shown_cells(
    voxels: &Voxels,
    size: [u32; 3],
    counts: [u32; 3],
    occupancy: &[u8],
    ends: &VisibleEnds,
    most: f64,
) -> Option<Vec<ShownCells>> {
    let intervals = ends.intervals(MOST_INTERVALS);
    let size = size.map(|n| n as usize);
    let counts = counts.map(|n| n as usize);
    assert_eq!(
        occupancy.len(),
        counts.iter().product::<usize>(),
        "{counts:?}"
    );
    macro_rules! shown {
        ($voxels:expr, $voxel:ty) => {{
            let clamp = |v: i32| v.clamp(<$voxel>::MIN.into(), <$voxel>::MAX.into()) as $voxel;
            let intervals: Vec<[$voxel; 2]> = intervals.iter().map(|i| i.map(clamp)).collect();
            let rows = Rows {
                voxels: $voxels,
                size,
                counts,
            };
            (rows.share(occupancy, &intervals) <= most)
                .then(|| reaching(counts, &rows.shown(occupancy, &intervals)))
        }};
    }
    match voxels {
        Voxels::U8(voxels) => shown!(voxels, u8),
        Voxels::I8(voxels) => shown!(voxels, i8),
        Voxels::U16(voxels) => shown!(voxels, u16),
        Voxels::I16(voxels) => shown!(voxels, i16),
        Voxels::F32(_) => None,
    }
}

fn is_occupied(cell: &u8) -> bool {
    *cell != 0
}

/// Adds to each cell what the next one along an axis shows, which is `shift` bits ahead within a skip cell, for cells in `inner`, and else
/// in the skip cell so many places ahead.
fn add_next(shown: &mut [u64], ahead: usize, shift: u32, inner: u64) {
    for at in 0..shown.len() {
        let next = shown.get(at + ahead).copied().unwrap_or(0);
        let within = shown[at] >> shift & inner;
        shown[at] |= within | next << (3 * shift) & !inner;
    }
}

/// Of four rows of four bits each, six bits apart.
fn spread(rows: u64) -> u32 {
    let rows = rows as u32;
    rows & 0xf | (rows & 0xf0) << 2 | (rows & 0xf00) << 4 | (rows & 0xf000) << 6
}

/// Adds to the bits of each skip cell those of the next ones that it reaches.
fn reaching([width, height, _]: [usize; 3], shown: &[u64]) -> Vec<ShownCells> {
    const LAST_ROW: usize = REACH[0] * EDGE;
    let slice = |bits: u64, z: usize| bits >> (EDGE * EDGE * z) & 0xffff;
    let row_of = |row: usize| shown.get(row * width..(row + 1) * width).unwrap_or(&[]);
    let mut reaching = vec![ShownCells::default(); shown.len()];
    let rows = reaching.par_chunks_mut(width).with_min_len(8).enumerate();
    rows.for_each(|(row, reaching)| {
        let own = row_of(row);
        let is_last = (row + 1).is_multiple_of(height);
        let behind = if is_last { &[] } else { row_of(row + 1) };
        for (x, words) in reaching.iter_mut().enumerate() {
            let bits = |row: &[u64], x: usize| row.get(x).copied().unwrap_or(0);
            let [near, next] = [bits(own, x), bits(own, x + 1)];
            let [far, far_next] = [bits(behind, x), bits(behind, x + 1)];
            if near | next | far | far_next == 0 {
                continue;
            }
            for (z, word) in words.iter_mut().enumerate() {
                *word = spread(slice(near, z))
                    | spread(slice(next, z) & 0x3333) << EDGE
                    | (spread(slice(far, z) & 0xf) | spread(slice(far_next, z) & 3) << EDGE)
                        << LAST_ROW;
            }
        }
    });
    reaching
}

struct Rows<'a, V> {
    voxels: &'a [V],
    size: [usize; 3],
    counts: [usize; 3],
}

impl<V: Copy + Ord + Default + Send + Sync> Rows<'_, V> {
    fn shown(&self, occupancy: &[u8], intervals: &[[V; 2]]) -> Vec<u64> {
        let [width, height, _] = self.counts;
        let mut shown = vec![0; occupancy.len()];
        shown
            .par_chunks_mut(width)
            .zip(occupancy.par_chunks(width))
            .with_min_len(8)
            .enumerate()
            .for_each_init(Scratch::default, |scratch, (row, (shown, occupancy))| {
                self.mark(row, occupancy, shown, intervals, scratch);
            });
        for row in shown.chunks_exact_mut(width) {
            add_next(row, 1, 1, 0x7777_7777_7777_7777);
        }
        for slice in shown.chunks_exact_mut(width * height) {
            add_next(slice, width, 4, 0x0fff_0fff_0fff_0fff);
        }
        add_next(&mut shown, width * height, 16, 0x0000_ffff_ffff_ffff);
        shown
    }

    /// The share of cells that show something, of those in occupied skip cells.
    fn share(&self, occupancy: &[u8], intervals: &[[V; 2]]) -> f64 {
        let occupied: Vec<(usize, &[u8])> = occupancy
            .chunks_exact(self.counts[0])
            .enumerate()
            .filter(|(_, row)| row.iter().any(is_occupied))
            .collect();
        let step = occupied.len() / ROWS_LOOKED_AT + 1;
        let mut scratch = Scratch::default();
        let mut shown = vec![0u64; self.counts[0]];
        let (mut found, mut all) = (0, 0);
        for (row, occupancy) in occupied.into_iter().step_by(step) {
            shown.fill(0);
            self.mark(row, occupancy, &mut shown, intervals, &mut scratch);
            found += shown.iter().map(|bits| bits.count_ones()).sum::<u32>();
            all += u64::BITS * occupancy.iter().filter(|cell| is_occupied(cell)).count() as u32;
        }
        f64::from(found) / f64::from(all.max(1))
    }

    /// The bits of a row's skip cells, each without those of its next ones.
    fn mark(
        &self,
        row: usize,
        occupancy: &[u8],
        shown: &mut [u64],
        intervals: &[[V; 2]],
        scratch: &mut Scratch<V>,
    ) {
        let (Some(first), Some(last)) = (
            occupancy.iter().position(is_occupied),
            occupancy.iter().rposition(is_occupied),
        ) else {
            return;
        };
        let rows = self.counts[1];
        let corner = [first, row % rows, row / rows].map(|n| n * EDGE);
        let occupancy = &occupancy[first..=last];
        let shown = &mut shown[first..=last];
        let [width, height, depth] = self.size;
        let cells = (EDGE * shown.len()).min(width - 1 - corner[0]);
        for z in corner[2]..(corner[2] + EDGE).min(depth - 1) {
            for y in corner[1]..(corner[1] + EDGE).min(height - 1) {
                let row = |y: usize, z: usize| {
                    let first = corner[0] + width * (y + height * z);
                    &self.voxels[first..=first + cells]
                };
                let rows = [row(y, z), row(y + 1, z), row(y, z + 1), row(y + 1, z + 1)];
                let flags = scratch.flags(rows, intervals);
                let shift = EDGE * ((y - corner[1]) + EDGE * (z - corner[2]));
                for (bits, flags) in shown.iter_mut().zip(flags.chunks_exact(EDGE)) {
                    // A bit from each of four bytes.
                    let bytes = u32::from_le_bytes([flags[0], flags[1], flags[2], flags[3]]);
                    let row = bytes.wrapping_mul(0x0102_0408) >> 24;
                    *bits |= u64::from(row) << shift;
                }
            }
        }
        let empty = |&(_, cell): &(&mut u64, &u8)| !is_occupied(cell);
        let cells = shown.iter_mut().zip(occupancy);
        cells.filter(empty).for_each(|(bits, _)| *bits = 0);
    }
}

/// Room for a row.
#[derive(Default)]
struct Scratch<V> {
    low: Vec<V>,
    high: Vec<V>,
    flags: Vec<u8>,
}

impl<V: Copy + Ord + Default> Scratch<V> {
    /// 1 for each cell between four rows whose range of values meets an interval, else 0; zeros up to a whole number of skip cells.
    fn flags(&mut self, [a, b, c, d]: [&[V]; 4], intervals: &[[V; 2]]) -> &[u8] {
        let voxels = a.len();
        let (b, c, d) = (&b[..voxels], &c[..voxels], &d[..voxels]);
        self.low.resize(voxels, V::default());
        self.high.resize(voxels, V::default());
        for (at, (low, high)) in self.low.iter_mut().zip(&mut self.high).enumerate() {
            *low = a[at].min(b[at]).min(c[at].min(d[at]));
            *high = a[at].max(b[at]).max(c[at].max(d[at]));
        }
        let cells = voxels - 1;
        self.flags.clear();
        self.flags.resize(cells.next_multiple_of(EDGE), 0);
        let flags = &mut self.flags[..cells];
        let (low, next_low) = (&self.low[..cells], &self.low[1..=cells]);
        let (high, next_high) = (&self.high[..cells], &self.high[1..=cells]);
        for &[first, last] in intervals {
            for (at, flag) in flags.iter_mut().enumerate() {
                let low = low[at].min(next_low[at]);
                let high = high[at].max(next_high[at]);
                *flag |= u8::from(low <= last) & u8::from(high >= first);
            }
        }
        &self.flags
    }
}

#[cfg(test)]
mod tests {
    use glam::DAffine3;

    use super::*;
    use crate::volume::select::Classify as _;
    use crate::volume::visible_ranges::VisibleRanges;
    use crate::volume::visible_ranges::tests::Intervals;
    use crate::volume::{Rescale, Volume};

    const SIZE: [u32; 3] = [21, 10, 14];

    /// A wave of 100 values, each of its own cell now and then.
    fn values(offset: i32) -> impl Iterator<Item = i32> {
        (0..SIZE.iter().product()).map(move |at: u32| {
            let [x, y, z] = [
                at % SIZE[0],
                at / SIZE[0] % SIZE[1],
                at / (SIZE[0] * SIZE[1]),
            ]
            .map(f64::from);
            let wave = (0.31 * x + 0.12 * z).sin() + (0.43 * y - 0.21 * z).cos();
            offset + (25.0 * wave + 50.0) as i32 + i32::from(at.is_multiple_of(97)) * 20
        })
    }

    #[test]
    fn bits_are_those_of_the_cells_and_of_the_next_ones() {
        let all: [Voxels; 4] = [
            Voxels::U8(values(0).map(|v| v as u8).collect()),
            Voxels::I8(values(-60).map(|v| v as i8).collect()),
            Voxels::U16(values(1000).map(|v| v as u16).collect()),
            Voxels::I16(values(-1000).map(|v| v as i16).collect()),
        ];
        for (voxels, offset) in all.into_iter().zip([0, -60, 1000, -1000]) {
            let volume = Volume::new(voxels, SIZE, DAffine3::IDENTITY, Rescale::default()).unwrap();
            for shown in [
                vec![[95.0, 120.0]],
                vec![[-5.0, 3.0], [48.0, 49.0], [97.0, 97.0]],
                vec![],
            ] {
                let offset = f64::from(offset);
                let shown = Intervals(shown.iter().map(|i| i.map(|v| v + offset)).collect());
                compare(&volume, &shown);
            }
        }
    }

    fn compare(volume: &Volume, shown: &Intervals) {
        let ranges = VisibleRanges::new(volume, shown);
        let shows = |cell: [u32; 3]| {
            if (0..3).any(|a| cell[a] + 1 >= SIZE[a]) {
                return false;
            }
            let corners = (0..8).map(|corner| {
                let [x, y, z] = [0, 1, 2].map(|a| cell[a] + (corner >> a & 1));
                volume.value(x, y, z)
            });
            let (low, high) = corners.fold((f64::MAX, f64::MIN), |(low, high), v| {
                (low.min(v), high.max(v))
            });
            shown.visible([low, high])
        };
        let counts = SIZE.map(|n| (n - 1).div_ceil(SKIP_CELLS));
        let places = |counts: [u32; 3]| {
            (0..counts.iter().product()).map(move |at: u32| {
                [
                    at % counts[0],
                    at / counts[0] % counts[1],
                    at / (counts[0] * counts[1]),
                ]
            })
        };
        let within = |skip: [u32; 3]| {
            places([SKIP_CELLS; 3])
                .map(move |cell| std::array::from_fn(|a| SKIP_CELLS * skip[a] + cell[a]))
        };
        let occupancy: Vec<u8> = places(counts)
            .map(|skip| u8::from(within(skip).any(shows)))
            .collect();
        let voxels = volume.voxels();
        let ends = ranges.ends().unwrap();
        let bits = shown_cells(voxels, SIZE, counts, &occupancy, ends, 1.0).unwrap();
        for (skip, bits) in places(counts).zip(bits) {
            for within in places(REACH.map(|n| n as u32)) {
                let cell: [u32; 3] = std::array::from_fn(|a| SKIP_CELLS * skip[a] + within[a]);
                let expected =
                    places([2; 3]).any(|next| shows(std::array::from_fn(|a| cell[a] + next[a])));
                let [x, y, z] = within;
                let bit = bits[z as usize] >> (x + REACH[0] as u32 * y) & 1;
                assert_eq!(bit == 1, expected, "{cell:?} of {skip:?} {:?}", shown.0);
            }
        }
        // What most cells show is not worth it.
        let visible = occupancy.contains(&1);
        let few = shown_cells(voxels, SIZE, counts, &occupancy, ends, 0.0);
        assert_eq!(few.is_none(), visible);
    }
}
