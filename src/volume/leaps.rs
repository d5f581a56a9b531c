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
    // The code of the longest leap that stays within each distance.
    let codes: [u32; LONGEST_LEAP as usize + 1] = std::array::from_fn(|distance| {
        let within = (0..16)
            .rev()
            .find(|&code| usize::from(leap(code)) <= distance);
        within.unwrap_or(0)
    });
    let distances: Vec<Vec<u8>> = (0..OCTANTS)
        .into_par_iter()
        .map(|octant| octant_distance(counts, occupancy, octant))
        .collect();
    let mut packed = vec![0; cells];
    packed
        .par_iter_mut()
        .with_min_len(1 << 14)
        .enumerate()
        .for_each(|(cell, word)| {
            for (octant, distances) in distances.iter().enumerate() {
                *word |= codes[usize::from(distances[cell])] << (4 * octant);
            }
        });
    packed
}

/// Edge of the largest empty cube with each cell in its near corner, at most [`LONGEST_LEAP`]; what lies beyond the grid is empty.
///
/// One sweep from the far end: a cube of edge n is empty when its corner is, and the cubes of edge n - 1 at the
/// corner's seven neighbours ahead.
fn octant_distance(counts: [u32; 3], occupancy: &[u8], octant: u32) -> Vec<u8> {
    let [width, height, depth] = counts.map(|n| n as usize);
    let [x_order, y_order, z_order] = std::array::from_fn(|axis| Order {
        count: counts[axis] as usize,
        ascends: octant >> axis & 1 == 0,
    });
    let mut distance = vec![0; width * height * depth];
    // Least of the neighbours in other rows.
    let mut near = vec![0; width];
    for (z, z_ahead) in z_order.farthest_first() {
        for (y, y_ahead) in y_order.farthest_first() {
            near.fill(LONGEST_LEAP);
            let rows = [(Some(y), z_ahead), (y_ahead, z_ahead), (y_ahead, Some(z))];
            for (y, z) in rows.into_iter().filter_map(|(y, z)| y.zip(z)) {
                let first = width * (y + height * z);
                for (near, &there) in near.iter_mut().zip(&distance[first..first + width]) {
                    *near = there.min(*near);
                }
            }
            let first = width * (y + height * z);
            let [mut ahead, mut near_ahead] = [LONGEST_LEAP; 2];
            for (x, _) in x_order.farthest_first() {
                let least = near[x].min(near_ahead).min(ahead);
                near_ahead = near[x];
                ahead = if occupancy[first + x] == 0 {
                    (least + 1).min(LONGEST_LEAP)
                } else {
                    0
                };
                distance[first + x] = ahead;
            }
        }
    }
    distance
}

/// The cells of an axis as a ray meets them.
struct Order {
    count: usize,
    ascends: bool,
}

impl Order {
    /// Every cell with the one ahead of it, last first.
    fn farthest_first(&self) -> impl Iterator<Item = (usize, Option<usize>)> {
        let place = |at: usize| {
            if self.ascends {
                self.count - 1 - at
            } else {
                at
            }
        };
        (0..self.count).map(move |at| (place(at), at.checked_sub(1).map(place)))
    }
}
