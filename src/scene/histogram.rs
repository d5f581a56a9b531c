//! How values are spread, and where the background ends.

use crate::volume::{Volume, Voxels};

const MAX_BINS: usize = 256;
/// Bins on either side that counts are averaged over when the background is looked for, against noise.
const SMOOTHING: usize = 2;
/// The background ends where the histogram has fallen to this share of its peak.
const BACKGROUND_END: f64 = 0.05;
/// Share of the foreground in one bin that makes a peak.
const MIN_PEAK: f64 = 0.005;

/// Voxels per equal part of the value range, lowest values first. Integers get no more bins than values, so that
/// none is empty for want of a value.
pub(super) struct ValueHistogram {
    range: [f64; 2],
    counts: Vec<u64>,
    /// First bin above the background.
    foreground: usize,
}

impl ValueHistogram {
    pub(super) fn of(volume: &Volume) -> Self {
        let [stored_min, stored_max] = volume.stored_range();
        let bins = match volume.voxels() {
            Voxels::F32(_) => MAX_BINS,
            _ => MAX_BINS.min((stored_max - stored_min) as usize + 1),
        };
        let mut histogram = Self {
            range: volume.value_range(),
            counts: vec![0; bins],
            foreground: 0,
        };
        for (value, count) in volume.value_counts() {
            let bin = histogram.bin(value);
            histogram.counts[bin] += count;
        }
        histogram.foreground = background_end(&histogram.counts, BACKGROUND_END);
        histogram
    }

    /// The same for a field that runs on below its peak: the background ends at half of that.
    pub(super) fn of_field(volume: &Volume) -> Self {
        let mut histogram = Self::of(volume);
        histogram.foreground = background_end(&histogram.counts, 0.5);
        histogram
    }

    /// First bin above the background.
    pub(super) fn foreground_bin(&self) -> usize {
        self.foreground
    }

    pub(super) fn bins(&self) -> usize {
        self.counts.len()
    }

    /// The bin of a value; a constant field has one.
    pub(super) fn bin(&self, value: f64) -> usize {
        let [lowest, highest] = self.range;
        let share = (value - lowest) / (highest - lowest);
        // NaN, of a constant field, becomes 0.
        ((share * self.bins() as f64) as usize).min(self.bins() - 1)
    }

    /// Value at the lower end of a bin.
    pub(super) fn start_of(&self, bin: usize) -> f64 {
        let [lowest, highest] = self.range;
        lowest + (highest - lowest) * bin as f64 / self.bins() as f64
    }

    /// Share of all voxels that belong to the background; 0 where there is none.
    pub(super) fn background_share(&self) -> f64 {
        let sum = |counts: &[u64]| counts.iter().sum::<u64>() as f64;
        sum(&self.counts[..self.foreground]) / sum(&self.counts)
    }

    /// Whether the foreground has a peak of its own: counts that fall, then rise by a factor.
    pub(super) fn has_second_peak(&self, rise: f64) -> bool {
        let smooth = smoothed(&self.counts);
        let foreground = &smooth[self.foreground..];
        let total: f64 = foreground.iter().sum();
        let mut lowest = f64::INFINITY;
        foreground.iter().any(|&count| {
            lowest = lowest.min(count);
            // Peaks of a few voxels are noise.
            count > rise * lowest && count > MIN_PEAK * total
        })
    }

    /// The value that a share of the voxels above the background does not exceed, to the width of a bin.
    pub(super) fn foreground_quantile(&self, share: f64) -> f64 {
        let counts = &self.counts[self.foreground..];
        let wanted = share * counts.iter().sum::<u64>() as f64;
        let mut sum = 0u64;
        let reached = counts.iter().position(|&n| {
            sum += n;
            n > 0 && sum as f64 >= wanted
        });
        self.start_of(self.foreground + reached.unwrap_or(counts.len().saturating_sub(1)))
    }
}

/// First bin above the background: above the highest peak of the darker half, once the counts have fallen to
/// `level` of it. 0 when the peak lies in the brighter half, or nothing lies above.
fn background_end(counts: &[u64], level: f64) -> usize {
    let smooth = smoothed(counts);
    let highest = smooth.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1));
    let Some((peak, &height)) = highest else {
        return 0;
    };
    let end = (peak + 1..counts.len())
        .find(|&bin| smooth[bin] <= level * height)
        .unwrap_or(counts.len());
    let above: u64 = counts[end..].iter().sum();
    if peak >= counts.len() / 2 || above == 0 {
        0
    } else {
        end
    }
}

/// Means over [`SMOOTHING`] bins on either side.
fn smoothed(counts: &[u64]) -> Vec<f64> {
    (0..counts.len())
        .map(|bin| {
            let last = (bin + SMOOTHING).min(counts.len() - 1);
            let window = &counts[bin.saturating_sub(SMOOTHING)..=last];
            window.iter().sum::<u64>() as f64 / window.len() as f64
        })
        .collect()
}
