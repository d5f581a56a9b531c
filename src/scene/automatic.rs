//! A transfer function for a volume that comes without one.

use rayon::prelude::*;

use super::{ControlPoint, presets};
use crate::error::Result;
use crate::volume::{Volume, VoxelType, Voxels};

/// What CT falls back to.
const CT_PRESET: &str = "ct-bone";
/// CT in Hounsfield units holds air.
const AIR_BELOW: f64 = -900.0;
const MAX_BINS: usize = 256;
/// Bins on either side that the histogram is averaged over when the background is looked for, against noise.
const SMOOTHING: usize = 2;
/// The background ends where the histogram has fallen to this share of its peak.
const BACKGROUND_END: f64 = 0.05;

/// Share of the voxels above the background that lie below a point, its display colour and its opacity.
const RAMP: [(f64, [f64; 3], f64); 5] = [
    (0.00, [0.25, 0.07, 0.05], 0.0),
    (0.30, [0.50, 0.20, 0.13], 0.01),
    (0.60, [0.76, 0.44, 0.29], 0.08),
    (0.90, [0.93, 0.78, 0.60], 0.40),
    (0.995, [1.0, 0.98, 0.93], 0.90),
];

/// Signed 16-bit (or rescaled 16-bit) data that reach down to air are taken for CT; anything else gets a ramp
/// over the percentiles of what is brighter than the background.
pub(super) fn control_points(volume: &Volume) -> Result<Vec<ControlPoint>> {
    if looks_like_hounsfield(volume) {
        return Ok(presets::find(CT_PRESET)?.control_points());
    }
    let counts = histogram(volume);
    let [lowest, highest] = volume.value_range();
    let value_of = |bin: usize| lowest + (highest - lowest) * bin as f64 / counts.len() as f64;
    let first = background_end(&counts);
    let total: u64 = counts[first..].iter().sum();
    let points = RAMP.iter().map(|&(share, color, opacity)| ControlPoint {
        value: value_of(first + bin_at(&counts[first..], share * total as f64)),
        color,
        opacity,
        emission: [0.0; 3],
    });
    Ok(points.collect())
}

fn looks_like_hounsfield(volume: &Volume) -> bool {
    let wide = matches!(
        volume.voxels().voxel_type(),
        VoxelType::I16 | VoxelType::U16
    );
    let [lowest, highest] = volume.value_range();
    wide && lowest <= AIR_BELOW && highest > 0.0
}

/// Voxels per equal part of the value range, lowest values first. Integers get no more bins than values, so that
/// none is empty for want of a value.
fn histogram(volume: &Volume) -> Vec<u64> {
    let [stored_min, stored_max] = volume.stored_range();
    let bins = match volume.voxels() {
        Voxels::F32(_) => MAX_BINS,
        _ => MAX_BINS.min((stored_max - stored_min) as usize + 1),
    };
    let [lowest, highest] = volume.value_range();
    let rescale = volume.rescale();
    // A constant field falls into the first bin.
    let bins_per_value = if highest > lowest {
        bins as f64 / (highest - lowest)
    } else {
        0.0
    };
    let bin_of = |stored: f64| {
        let value = rescale.slope * stored + rescale.intercept;
        (((value - lowest) * bins_per_value) as usize).min(bins - 1)
    };
    match volume.voxels() {
        Voxels::U8(v) => count(v, bins, bin_of),
        Voxels::I8(v) => count(v, bins, bin_of),
        Voxels::U16(v) => count(v, bins, bin_of),
        Voxels::I16(v) => count(v, bins, bin_of),
        Voxels::F32(v) => count(v, bins, bin_of),
    }
}

fn count<T: Copy + Into<f64> + Sync>(
    voxels: &[T],
    bins: usize,
    bin_of: impl Fn(f64) -> usize + Sync,
) -> Vec<u64> {
    voxels
        .par_chunks(1 << 18)
        .map(|chunk| {
            let mut counts = vec![0u64; bins];
            for &voxel in chunk {
                counts[bin_of(voxel.into())] += 1;
            }
            counts
        })
        .reduce(
            || vec![0; bins],
            |mut sum, part| {
                sum.iter_mut().zip(part).for_each(|(s, p)| *s += p);
                sum
            },
        )
}

/// First bin above the background: above the highest peak of the darker half, once the counts have fallen to
/// [`BACKGROUND_END`] of it. 0 when the peak lies in the brighter half, or nothing lies above.
fn background_end(counts: &[u64]) -> usize {
    let smooth: Vec<f64> = (0..counts.len())
        .map(|bin| {
            let last = (bin + SMOOTHING).min(counts.len() - 1);
            let window = &counts[bin.saturating_sub(SMOOTHING)..=last];
            window.iter().sum::<u64>() as f64 / window.len() as f64
        })
        .collect();
    let highest = smooth.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1));
    let Some((peak, &height)) = highest else {
        return 0;
    };
    let end = (peak + 1..counts.len())
        .find(|&bin| smooth[bin] <= BACKGROUND_END * height)
        .unwrap_or(counts.len());
    let above: u64 = counts[end..].iter().sum();
    if peak >= counts.len() / 2 || above == 0 {
        0
    } else {
        end
    }
}

/// The bin in which the running sum of counts reaches `wanted`.
fn bin_at(counts: &[u64], wanted: f64) -> usize {
    let mut sum = 0u64;
    counts
        .iter()
        .position(|&n| {
            sum += n;
            n > 0 && sum as f64 >= wanted
        })
        .unwrap_or(counts.len().saturating_sub(1))
}
