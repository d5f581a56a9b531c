//! How often each value occurs.

use std::sync::OnceLock;

use rayon::prelude::*;

use super::texel::{Voxel, with_typed};
use super::{Volume, Voxels};

/// Equal parts of the value range that real numbers are counted in.
const PARTS: usize = 256;
/// Voxels that one task counts.
const CHUNK: usize = 1 << 20;
/// Tables that neighbours take turns with: a processor does not add to one number twice in a row without a wait.
const TABLES: usize = 4;

/// Counted when first asked for.
#[derive(Clone, Debug, Default)]
pub(super) struct ValueCounts(OnceLock<Vec<u64>>);

impl Volume {
    /// Values, and how many voxels have them. Of integers every one between smallest and largest, ascending with the stored voxels; of
    /// real numbers the middles of 256 equal parts of the value range.
    ///
    /// Looks at every voxel, in parallel, the first time.
    pub fn value_counts(&self) -> impl Iterator<Item = (f64, u64)> {
        let [low, high] = self.value_range();
        let first = self.stored_range[0];
        let is_real = matches!(self.voxels, Voxels::F32(_));
        let value = move |at: usize| {
            if is_real {
                low + (high - low) * (at as f64 + 0.5) / PARTS as f64
            } else {
                self.value_from_stored(first + at as f64)
            }
        };
        let counts = self.counts.0.get_or_init(|| self.count_values());
        (0..).map(value).zip(counts.iter().copied())
    }

    fn count_values(&self) -> Vec<u64> {
        let [low, high] = self.value_range();
        let [first, last] = self.stored_range;
        let part = |v: f32| {
            let share = (self.value_from_stored(v.into()) - low) / (high - low);
            // NaN, of a constant field, becomes 0.
            ((share * PARTS as f64) as usize).min(PARTS - 1)
        };
        if let Voxels::F32(voxels) = &self.voxels {
            return count(voxels, PARTS, part);
        }
        let values = (last - first) as usize + 1;
        with_typed!(&self.voxels, voxels => count_integers(voxels, first as i32, values))
    }
}

/// Voxels of each of so many integers from `first` on.
fn count_integers<V: Voxel>(voxels: &[V], first: i32, values: usize) -> Vec<u64> {
    // No integer of a voxel type is beyond what a 32-bit float holds.
    count(voxels, values, |v| (v.to_f32() as i32 - first) as usize)
}

/// Voxels in each bin.
pub(super) fn count<T: Copy + Sync>(
    voxels: &[T],
    bins: usize,
    bin: impl Fn(T) -> usize + Sync,
) -> Vec<u64> {
    let add = |mut counts: Vec<u64>, chunk: &[T]| {
        let mut tables = vec![0u32; TABLES * bins];
        let mut groups = chunk.chunks_exact(TABLES);
        for group in &mut groups {
            for (table, &voxel) in group.iter().enumerate() {
                tables[table * bins + bin(voxel)] += 1;
            }
        }
        for &voxel in groups.remainder() {
            tables[bin(voxel)] += 1;
        }
        for table in tables.chunks_exact(bins) {
            for (sum, &n) in counts.iter_mut().zip(table) {
                *sum += u64::from(n);
            }
        }
        counts
    };
    voxels
        .par_chunks(CHUNK)
        .fold(|| vec![0u64; bins], add)
        .reduce(
            || vec![0; bins],
            |mut sum, part| {
                sum.iter_mut().zip(part).for_each(|(s, p)| *s += p);
                sum
            },
        )
}

#[cfg(test)]
mod tests {
    use glam::DAffine3;

    use super::PARTS;
    use crate::volume::{Rescale, Volume, Voxels};

    #[test]
    fn every_voxel_is_counted_at_its_value() {
        // Not a multiple of the tables that take turns.
        let values = (0..3 * 5 * 7).map(|i: i32| i * i % 41 - 20);
        let kinds = [
            Voxels::I8(values.clone().map(|v| v as i8).collect()),
            Voxels::U16(values.clone().map(|v| (v + 60_000) as u16).collect()),
            Voxels::I16(values.clone().map(|v| 3 * v as i16).collect()),
            Voxels::F32(values.map(|v| (v as f32 * 0.04).exp()).collect()),
        ];
        for (voxels, slope) in kinds
            .into_iter()
            .flat_map(|v| [(v.clone(), 2.0), (v, -0.5)])
        {
            let rescale = Rescale {
                slope,
                intercept: 1.0,
            };
            let volume = Volume::new(voxels, [3, 5, 7], DAffine3::IDENTITY, rescale).unwrap();
            let [low, high] = volume.value_range();
            let half = match volume.voxels() {
                Voxels::F32(_) => 0.5 * (high - low) / PARTS as f64 + 1e-9,
                _ => 0.0,
            };
            let all: Vec<f64> = (0..volume.voxels().len())
                .map(|at| volume.value_from_stored(volume.voxels().get(at)))
                .collect();
            let counts: Vec<(f64, u64)> = volume.value_counts().collect();
            assert_eq!(counts.iter().map(|&(_, n)| n).sum::<u64>(), 3 * 5 * 7);
            for (value, n) in counts {
                let there = all.iter().filter(|&&v| (v - value).abs() <= half).count();
                assert_eq!(n, there as u64, "{value} of {low} to {high}");
            }
        }
    }
}
