//! From the voxels of one block to the samples of its coarse levels.
//!
//! Filtering is separable and never leaves the closed block. On an axis, a sample on a border of
//! the block is the border plane itself; a sample inside is a tent of half-width `s = m / N` around
//! its position. A sample is then a convex combination of voxels that every block containing its
//! position also contains, so blocks of equal level agree on shared faces and nothing leaks into a
//! block from beside it. Tents reproduce linear fields exactly.

use std::sync::LazyLock;

use super::blocks::{BLOCK_CELLS, FINEST};
use super::texel::Voxel;

/// Voxels of a full block on each axis, both borders included.
const SIDE: usize = BLOCK_CELLS as usize + 1;

/// Voxels of a full closed block.
pub(crate) const BLOCK_VOXELS: usize = SIDE.pow(3);

/// Samples on an axis of the largest coarse brick.
const COARSE_SIDE: usize = (1 << (FINEST - 1)) + 1;

/// Weights of consecutive voxels of an axis, from `first` on.
struct Tap {
    first: usize,
    weights: Vec<f64>,
}

/// The taps of every sample of an axis, by cells of the block (from 1) and level.
static AXIS_TAPS: LazyLock<Vec<[Vec<Tap>; FINEST as usize]>> = LazyLock::new(|| {
    (1..=BLOCK_CELLS as usize)
        .map(|cells| std::array::from_fn(|level| axis_taps(cells, 1 << level)))
        .collect()
});

fn axis_taps(cells: usize, intervals: usize) -> Vec<Tap> {
    (0..=intervals)
        .map(|i| match i {
            0 => border_tap(0),
            _ if i == intervals => border_tap(cells),
            _ => tent(i * cells, cells, intervals),
        })
        .collect()
}

fn border_tap(voxel: usize) -> Tap {
    Tap {
        first: voxel,
        weights: vec![1.0],
    }
}

/// Tent of half-width `cells / intervals`, rounded to whole voxels, around `position / intervals`.
///
/// A tent of integer half-width `h` has weights `(h - |j|) / h^2` at integer offsets. Between two
/// voxels it is the linear blend of the tents around them, which keeps the sum at 1 and the mean at
/// the position.
fn tent(position: usize, cells: usize, intervals: usize) -> Tap {
    let half = ((2 * cells + intervals) / (2 * intervals)).max(1);
    let below = position / intervals;
    let blend = (position % intervals) as f64 / intervals as f64;
    let weight = |center: usize, j: usize| {
        half.saturating_sub(center.abs_diff(j)) as f64 / (half * half) as f64
    };
    let above = if blend > 0.0 { below + 1 } else { below };
    let first = below + 1 - half;
    Tap {
        first,
        weights: (first..above + half)
            .map(|j| (1.0 - blend) * weight(below, j) + blend * weight(above, j))
            .collect(),
    }
}

/// The closed voxels of one block, and room to filter them.
pub(crate) struct BlockFilter {
    /// Voxels of the closed block on each axis, `m + 1`.
    size: [usize; 3],
    voxels: Vec<f32>,
    planes: Vec<f64>,
    rows: Vec<f64>,
}

impl BlockFilter {
    pub(crate) fn new() -> Self {
        Self {
            size: [0; 3],
            voxels: vec![0.0; BLOCK_VOXELS],
            planes: vec![0.0; COARSE_SIDE * SIDE * SIDE],
            rows: vec![0.0; COARSE_SIDE * COARSE_SIDE * SIDE],
        }
    }

    /// Takes the closed block of `cells` cells at `origin_ix` out of a volume of `volume_size`
    /// voxels.
    pub(crate) fn gather<V: Voxel>(
        &mut self,
        voxels: &[V],
        volume_size: [u32; 3],
        origin_ix: [u32; 3],
        cells: [u32; 3],
    ) {
        let [width, height, _] = volume_size.map(|n| n as usize);
        let [x, y, z] = origin_ix.map(|c| c as usize);
        let size = cells.map(|m| m as usize + 1);
        self.size = size;
        for (row, to) in self.voxels[..size.iter().product()]
            .chunks_exact_mut(size[0])
            .enumerate()
        {
            let at = x + width * (y + row % size[1] + height * (z + row / size[1]));
            for (to, from) in to.iter_mut().zip(&voxels[at..at + size[0]]) {
                *to = from.to_f32();
            }
        }
    }

    /// Voxels of the closed block on each axis.
    pub(crate) fn size(&self) -> [usize; 3] {
        self.size
    }

    /// The closed block as stored, x fastest.
    pub(crate) fn voxels(&self) -> &[f32] {
        &self.voxels[..self.size.iter().product()]
    }

    /// The `(2^lambda + 1)^3` samples of a level below the finest, x fastest, rounded as they are
    /// stored.
    ///
    /// Sums are in f64 so that rounding to the texel cannot leave the range of the voxels that went
    /// in.
    pub(crate) fn coarse<V: Voxel>(&mut self, level: u8, samples: &mut [V::Texel]) {
        let taps: [&[Tap]; 3] =
            std::array::from_fn(|a| AXIS_TAPS[self.size[a] - 2][level as usize].as_slice());
        let [width, height, _] = self.size;
        let side = (1 << level) + 1;

        let area = width * height;
        for (tap, plane) in taps[2].iter().zip(self.planes.chunks_exact_mut(area)) {
            weighted_sum(tap, &self.voxels, plane);
        }
        for (plane, rows) in self
            .planes
            .chunks_exact(area)
            .zip(self.rows.chunks_exact_mut(side * width))
            .take(side)
        {
            for (tap, row) in taps[1].iter().zip(rows.chunks_exact_mut(width)) {
                weighted_sum(tap, plane, row);
            }
        }
        for (row, to) in self
            .rows
            .chunks_exact(width)
            .zip(samples[..side.pow(3)].chunks_exact_mut(side))
        {
            for (tap, to) in taps[0].iter().zip(to) {
                let sum = tap
                    .weights
                    .iter()
                    .zip(&row[tap.first..])
                    .map(|(w, v)| w * v)
                    .sum();
                *to = V::nearest_texel(sum);
            }
        }
    }
}

/// Weighted sum of the slices of `from`, each as long as `to`, that a tap names.
fn weighted_sum<T: Copy + Into<f64>>(tap: &Tap, from: &[T], to: &mut [f64]) {
    let slices = from[tap.first * to.len()..].chunks_exact(to.len());
    to.fill(0.0);
    for (weight, slice) in tap.weights.iter().zip(slices) {
        for (sum, &value) in to.iter_mut().zip(slice) {
            *sum += weight * value.into();
        }
    }
}

/// Where a voxel `x` of a closed block lies among the samples of an axis: the sample below, and the
/// fraction toward the next.
pub(crate) fn place(x: usize, cells: usize, intervals: usize) -> (usize, f32) {
    let below = (x * intervals / cells).min(intervals - 1);
    (below, (x * intervals - below * cells) as f32 / cells as f32)
}
