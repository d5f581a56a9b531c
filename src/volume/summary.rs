//! What a volume holds, in few numbers.

use glam::DMat3;
use rayon::prelude::*;
use serde::Serialize;

use super::value_counts::count;
use super::{Volume, Voxels};

/// Bins of [`Histogram`].
pub const HISTOGRAM_BINS: usize = 64;

/// Bins of the histogram that percentiles of floats come from: they are off by at most half a bin.
const FINE_BINS: usize = 1 << 16;

/// Voxels that one task counts.
const CHUNK: usize = 1 << 20;

/// What a volume holds. Values are in the file's own units, lengths in millimetres, world space is LPS.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// Voxels on x, y, z.
    pub size: [u32; 3],
    /// Voxel type (`u8`, `i8`, `u16`, `i16`, `f32`).
    #[serde(rename = "type")]
    pub voxel_type: &'static str,
    /// Whether voxels have display colours, of 8 bits, beside these numbers.
    pub colors: bool,
    /// Distance between neighbouring voxels on each axis, mm.
    pub spacing: [f64; 3],
    /// World position of voxel (0,0,0), mm.
    pub origin: [f64; 3],
    /// Unit vector in the world along each index axis.
    pub directions: [[f64; 3]; 3],
    /// Which way each index axis runs, most nearly: Left or Right, Anterior or Posterior, Superior or Inferior.
    /// `LPS` when index and world axes agree.
    pub orientation: String,
    /// Factor from stored voxels to values.
    pub rescale_slope: f64,
    /// Offset from stored voxels to values.
    pub rescale_intercept: f64,
    /// Smallest and largest value.
    pub value_range: [f64; 2],
    /// Voxels that were NaN or infinite; no other number here counts them.
    pub non_finite: u64,
    /// Mean value.
    pub mean: f64,
    /// Percentiles of the values.
    pub percentiles: Percentiles,
    /// How values are spread over `value_range`.
    pub histogram: Histogram,
}

/// Values that 1, 5, 50, 95 and 99 per cent of the voxels do not exceed. Exact for integers; for floats within
/// 1/131072 of the value range.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Percentiles {
    /// 1st.
    pub p1: f64,
    /// 5th.
    pub p5: f64,
    /// Median.
    pub p50: f64,
    /// 95th.
    pub p95: f64,
    /// 99th.
    pub p99: f64,
}

/// Numbers of voxels in equal parts of a range.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Histogram {
    /// Lower end of the first and upper end of the last bin; a value at the upper end is in the last bin.
    pub range: [f64; 2],
    /// [`HISTOGRAM_BINS`] counts.
    pub counts: Vec<u64>,
}

impl Summary {
    /// Looks at every voxel, in parallel. The result does not depend on the number of threads.
    pub fn of(volume: &Volume) -> Self {
        let placement = volume.world_from_ix();
        let directions = DMat3::from_cols(
            placement.matrix3.x_axis.normalize_or_zero(),
            placement.matrix3.y_axis.normalize_or_zero(),
            placement.matrix3.z_axis.normalize_or_zero(),
        );
        let range = volume.value_range();
        let mut fine = Fine::of(volume);
        if volume.rescale().slope < 0.0 {
            fine.bins.reverse();
        }
        Self {
            size: volume.size(),
            voxel_type: volume.voxels().voxel_type().name(),
            colors: volume.colors().is_some(),
            spacing: volume.spacing(),
            origin: placement.translation.to_array(),
            directions: directions.to_cols_array_2d(),
            orientation: orientation(directions),
            rescale_slope: volume.rescale().slope,
            rescale_intercept: volume.rescale().intercept,
            value_range: range,
            non_finite: volume.non_finite(),
            mean: volume.value_from_stored(fine.stored_mean),
            percentiles: Percentiles {
                p1: fine.percentile(0.01),
                p5: fine.percentile(0.05),
                p50: fine.percentile(0.5),
                p95: fine.percentile(0.95),
                p99: fine.percentile(0.99),
            },
            histogram: fine.histogram(range),
        }
    }
}

/// A histogram fine enough to take all others from: one bin per value of integers.
struct Fine {
    /// Middle of each bin, as a value, and voxels in it; ascending.
    bins: Vec<(f64, u64)>,
    stored_mean: f64,
}

impl Fine {
    fn of(volume: &Volume) -> Self {
        let [low, high] = volume.stored_range();
        // (first bin's middle, width of a bin, counts, sum of the stored values if the bins do not give it)
        let (first, width, mut counts, sum) = match volume.voxels() {
            Voxels::U8(v) => integers(v, 0, 256),
            Voxels::I8(v) => integers(v, i8::MIN.into(), 256),
            Voxels::U16(v) => integers(v, 0, 1 << 16),
            Voxels::I16(v) => integers(v, i16::MIN.into(), 1 << 16),
            Voxels::F32(v) => floats(v, low, high),
        };
        // Voxels that were not finite were given the smallest value.
        let lowest = ((low - first) / width).round().max(0.0) as usize;
        if let Some(bin) = counts.get_mut(lowest) {
            *bin -= volume.non_finite();
        }
        let replaced = volume.non_finite() as f64 * low;
        let finite: u64 = counts.iter().sum();
        let bins = counts
            .into_iter()
            .enumerate()
            .filter(|&(_, count)| count > 0)
            .map(|(bin, count)| {
                let middle = (first + width * bin as f64).clamp(low, high);
                (volume.value_from_stored(middle), count)
            })
            .collect();
        Self {
            bins,
            stored_mean: (sum - replaced) / finite as f64,
        }
    }

    /// The smallest value that at least `part` of the voxels do not exceed.
    fn percentile(&self, part: f64) -> f64 {
        let total: u64 = self.bins.iter().map(|&(_, count)| count).sum();
        let rank = (part * total as f64).ceil().max(1.0) as u64;
        let mut seen = 0;
        let reached = self.bins.iter().find(|&&(_, count)| {
            seen += count;
            seen >= rank
        });
        reached.map_or(f64::NAN, |&(value, _)| value)
    }

    fn histogram(&self, range: [f64; 2]) -> Histogram {
        let [low, high] = range;
        let mut counts = vec![0; HISTOGRAM_BINS];
        for &(value, count) in &self.bins {
            let part = (value - low) / (high - low);
            // A constant volume has no range: `part` is NaN, which becomes bin 0.
            let bin = (part * HISTOGRAM_BINS as f64) as usize;
            counts[bin.min(HISTOGRAM_BINS - 1)] += count;
        }
        Histogram { range, counts }
    }
}

/// Counts of each value from `first` on, as (middle of the first bin, width, counts, sum).
fn integers<T: Copy + Into<i32> + Sync>(
    voxels: &[T],
    first: i32,
    bins: usize,
) -> (f64, f64, Vec<u64>, f64) {
    let counts = count(voxels, bins, |v| (v.into() - first) as usize);
    let values = (i64::from(first)..).zip(&counts);
    let sum: i128 = values.map(|(v, &n)| i128::from(v) * i128::from(n)).sum();
    (first.into(), 1.0, counts, sum as f64)
}

/// Counts in equal parts of [low, high], as (middle of the first bin, width, counts, sum).
fn floats(voxels: &[f32], low: f64, high: f64) -> (f64, f64, Vec<u64>, f64) {
    let width = (high - low) / FINE_BINS as f64;
    let width = if width > 0.0 { width } else { 1.0 };
    let counts = count(voxels, FINE_BINS, |v| {
        (((f64::from(v) - low) / width) as usize).min(FINE_BINS - 1)
    });
    // Parts are summed in order, so that the rounding does not depend on which thread came first.
    let parts: Vec<f64> = voxels
        .par_chunks(CHUNK)
        .map(|part| part.iter().map(|&v| f64::from(v)).sum())
        .collect();
    (low + 0.5 * width, width, counts, parts.iter().sum())
}

/// Pairs each index axis with a different world axis, the best matches first.
fn orientation(directions: DMat3) -> String {
    const LETTERS: [[char; 2]; 3] = [['L', 'R'], ['P', 'A'], ['S', 'I']];
    let mut pairs: Vec<(usize, usize, f64)> = (0..3)
        .flat_map(|index| (0..3).map(move |world| (index, world)))
        .map(|(index, world)| (index, world, directions.col(index)[world]))
        .collect();
    pairs.sort_by(|a, b| b.2.abs().total_cmp(&a.2.abs()));
    let mut letters = [None; 3];
    let mut taken = [false; 3];
    for (index, world, cosine) in pairs {
        if letters[index].is_none() && !taken[world] {
            letters[index] = Some(LETTERS[world][usize::from(cosine < 0.0)]);
            taken[world] = true;
        }
    }
    letters.into_iter().flatten().collect()
}

#[cfg(test)]
mod tests {
    use glam::{DAffine3, DVec3};

    use super::*;
    use crate::volume::Rescale;

    fn volume(voxels: Voxels, size: [u32; 3], slope: f64) -> Volume {
        let rescale = Rescale {
            slope,
            intercept: 10.0,
        };
        Volume::new(voxels, size, DAffine3::IDENTITY, rescale).unwrap()
    }

    #[test]
    fn integers_are_exact() {
        // 0..=99: the nearest-rank percentile p is p - 1, the mean 49.5.
        let s = Summary::of(&volume(Voxels::I16((0..100).collect()), [10, 5, 2], 1.0));
        let p = s.percentiles;
        assert_eq!(
            [p.p1, p.p5, p.p50, p.p95, p.p99],
            [10.0, 14.0, 59.0, 104.0, 108.0]
        );
        assert_eq!(s.mean, 59.5);
        assert_eq!(s.value_range, [10.0, 109.0]);
        assert_eq!(s.histogram.counts.iter().sum::<u64>(), 100);
        assert_eq!(s.histogram.counts[0], 2, "0 and 1 lie below 99/64 = 1.55");
        assert_eq!(s.histogram.counts[63], 2, "98 and 99 lie from 97.45 on");
    }

    #[test]
    fn a_negative_slope_turns_the_order() {
        let s = Summary::of(&volume(Voxels::U8((0..100).collect()), [10, 5, 2], -2.0));
        assert_eq!(s.value_range, [-188.0, 10.0]);
        assert_eq!(s.percentiles.p1, -188.0);
        assert_eq!(s.percentiles.p99, 8.0);
        assert_eq!(s.mean, -89.0);
    }

    #[test]
    fn floats_skip_what_is_not_finite() {
        let mut values: Vec<f32> = (0..1000).map(|i| 1.0 + i as f32 / 999.0).collect();
        values[3] = f32::NAN;
        values[4] = f32::INFINITY;
        let finite = values.iter().filter(|v| v.is_finite());
        let mean: f64 = finite.map(|&v| f64::from(v)).sum::<f64>() / 998.0;
        let s = Summary::of(&volume(Voxels::F32(values), [10, 10, 10], 1.0));
        assert_eq!(s.non_finite, 2);
        assert_eq!(s.histogram.counts.iter().sum::<u64>(), 998);
        assert!((s.mean - mean - 10.0).abs() < 1e-12, "{}", s.mean);
        // Rank 499 of 998 is the value at place 500, the two holes lie below it.
        let median = 11.0 + 500.0 / 999.0;
        assert!((s.percentiles.p50 - median).abs() <= 1.0 / 131_072.0 + 1e-7);
    }

    #[test]
    fn a_constant_volume_is_one_bin() {
        for voxels in [Voxels::U16(vec![7; 8]), Voxels::F32(vec![7.0; 8])] {
            let s = Summary::of(&volume(voxels, [2, 2, 2], 1.0));
            assert_eq!(s.value_range, [17.0, 17.0]);
            assert_eq!(s.histogram.counts[0], 8);
            assert_eq!(s.percentiles.p50, 17.0);
            assert_eq!(s.mean, 17.0);
        }
    }

    #[test]
    fn orientation_names_the_nearest_axes() {
        let code = |x, y, z| orientation(DMat3::from_cols(x, y, z));
        assert_eq!(code(DVec3::X, DVec3::Y, DVec3::Z), "LPS");
        assert_eq!(code(-DVec3::X, -DVec3::Y, DVec3::Z), "RAS");
        assert_eq!(code(DVec3::Y, -DVec3::Z, DVec3::X), "PIL");
        // 45 degrees to two axes each: still one letter per world axis.
        let a = DVec3::new(1.0, 1.0, 0.0).normalize();
        let b = DVec3::new(-1.0, 1.0, 0.0).normalize();
        let mut letters: Vec<char> = code(a, b, DVec3::Z).chars().collect();
        letters.sort_unstable();
        assert!(
            letters == ['L', 'P', 'S'] || letters == ['P', 'R', 'S'],
            "{letters:?}"
        );
    }
}
