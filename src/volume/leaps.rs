//! How far a ray may leap from each skip cell through cells that show nothing.
//!
//! Every cell holds one distance for each of the eight octants of directions that a ray may have: the edge, in cells, of the largest
//! empty cube that has the cell in its near corner. What lies behind a ray or beside it does not shorten its leaps, which an
//! undirected distance map lets it do (Deakin and Knackstedt, "Efficient ray casting of volumetric images using distance maps for empty
//! space skipping", 2019, keep one map for each direction for the same reason).

use rayon::prelude::*;

/// Largest leap, in cells: what 4 bits can say.
pub const LONGEST_LEAP: u8 = leap(15);

const OCTANTS: u32 = 8;
const CODE_BITS: usize = 4;
const WORD_BITS: usize = u64::BITS as usize;
/// The bits of a cell's leaps, and as many cells.
const SQUARE: usize = u32::BITS as usize;

/// The leap, in cells, that a code of 4 bits stands for: 0 to 7, then in steps of 2, then of 4.
pub const fn leap(code: u32) -> u8 {
    if code < 4 {
        code as u8
    } else {
        ((4 + code % 4) << (code / 4 - 1)) as u8
    }
}

/// Leaps from every cell, x fastest, by cells with `occupancy` not 0: 4 bits for each octant, codes for [`leap`]. Octant 0, in the
/// lowest bits, ascends along all axes; 1, 2 and 4 are added for those that descend along x, y and z. 0: the cell itself
/// is occupied.
///
/// # Panics
/// When `occupancy` does not have one entry for each cell.
pub fn octant_leaps(counts: [u32; 3], occupancy: &[u8]) -> Vec<u32> {
    let cells = counts.iter().map(|&n| n as usize).product();
    assert_eq!(
        occupancy.len(),
        cells,
        "one entry of occupancy for each of {counts:?} cells"
    );
    let empty = EmptyCubes::new(counts, occupancy);
    let codes: Vec<[Vec<u64>; CODE_BITS]> = (0..OCTANTS)
        .into_par_iter()
        .map(|octant| code_bits(empty.clone(), octant))
        .collect();
    let mut leaps = vec![0; cells];
    leaps
        .par_chunks_mut(counts[0] as usize)
        .with_min_len(1 << 8)
        .enumerate()
        .for_each(|(row, leaps)| {
            for (word, leaps) in leaps.chunks_mut(WORD_BITS).enumerate() {
                let at = row * empty.row + word;
                for (half, leaps) in leaps.chunks_mut(SQUARE).enumerate() {
                    let mut bits = std::array::from_fn(|bit| {
                        let plane = &codes[bit / CODE_BITS][bit % CODE_BITS];
                        (plane[at] >> (half * SQUARE)) as u32
                    });
                    transpose(&mut bits);
                    leaps.copy_from_slice(&bits[..leaps.len()]);
                }
            }
        });
    leaps
}

/// The bits of every cell's code for the rays of one octant.
fn code_bits(mut cubes: EmptyCubes, octant: u32) -> [Vec<u64>; CODE_BITS] {
    let mut codes = std::array::from_fn(|_| vec![0; cubes.bits.len()]);
    for code in 1..1u32 << CODE_BITS {
        cubes.grow(usize::from(leap(code) - cubes.edge), octant);
        cubes.edge = leap(code);
        // Where a cube is empty the smaller ones are, so that the code is the number of empty ones: bit n of it is odd where an odd number
        // of every 2^n-th one are.
        for (bit, plane) in codes.iter_mut().enumerate() {
            if code.is_multiple_of(1 << bit) {
                plane.iter_mut().zip(&cubes.bits).for_each(|(b, c)| *b ^= c);
            }
        }
        if cubes.bits.iter().all(|&word| word == 0) {
            break;
        }
    }
    codes
}

/// A bit for each cell: set where it is the near corner of an empty cube. What lies beyond the grid is empty.
#[derive(Clone)]
struct EmptyCubes {
    /// In cells.
    edge: u8,
    /// Words of a row, and of a slice.
    row: usize,
    slice: usize,
    bits: Vec<u64>,
}

impl EmptyCubes {
    /// Single cells. Bits beyond the last of a row are set.
    fn new([width, height, _]: [u32; 3], occupancy: &[u8]) -> Self {
        let row = (width as usize).div_ceil(WORD_BITS);
        let word = |cells: &[u8]| {
            let bits = cells.iter().zip(0..);
            !bits.fold(0, |word, (&cell, bit)| word | u64::from(cell != 0) << bit)
        };
        let rows = occupancy.chunks_exact(width as usize);
        Self {
            edge: 1,
            row,
            slice: row * height as usize,
            bits: rows
                .flat_map(|row| row.chunks(WORD_BITS).map(word))
                .collect(),
        }
    }

    /// To cubes whose edge is longer by `by`, at most twice as long: where those at both ends of the difference are empty on each
    /// axis, the larger one is.
    fn grow(&mut self, by: usize, octant: u32) {
        if by == 0 {
            return;
        }
        let [ascends_x, ascends_y, ascends_z] = [0, 1, 2].map(|axis| octant >> axis & 1 == 0);
        let by_bits = by as u32;
        for words in self.bits.chunks_exact_mut(self.row) {
            if ascends_x {
                for at in 0..words.len() {
                    let next = words.get(at + 1).copied().unwrap_or(u64::MAX);
                    words[at] &= words[at] >> by_bits | next << (u64::BITS - by_bits);
                }
            } else {
                for at in (0..words.len()).rev() {
                    let next = at.checked_sub(1).map_or(u64::MAX, |before| words[before]);
                    words[at] &= words[at] << by_bits | next >> (u64::BITS - by_bits);
                }
            }
        }
        for slice in self.bits.chunks_exact_mut(self.slice) {
            combine(slice, by * self.row, ascends_y);
        }
        combine(&mut self.bits, by * self.slice, ascends_z);
    }
}

/// Leaves the bits that are set so many words ahead, too; what lies beyond the last is set.
fn combine(words: &mut [u64], ahead: usize, ascends: bool) {
    let Some(last) = words.len().checked_sub(ahead) else {
        return;
    };
    if ascends {
        for at in 0..last {
            words[at] &= words[at + ahead];
        }
    } else {
        for at in (0..last).rev() {
            words[at + ahead] &= words[at];
        }
    }
}

/// Swaps rows and columns of a square of bits (Warren, "Hacker's Delight", 2nd ed. 2012, section 7-3).
fn transpose(rows: &mut [u32; SQUARE]) {
    let mut mask = u32::MAX;
    for step in [16, 8, 4, 2, 1] {
        mask ^= mask << step;
        for at in (0..SQUARE).filter(|at| at & step == 0) {
            let swapped = (rows[at] >> step ^ rows[at + step]) & mask;
            rows[at] ^= swapped << step;
            rows[at + step] ^= swapped;
        }
    }
}
