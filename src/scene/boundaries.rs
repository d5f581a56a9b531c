//! A transfer function that shows the boundaries between materials, from value and gradient statistics.
//!
//! G. Kindlmann, J. W. Durkin: *Semi-automatic generation of transfer functions for direct volume rendering*. IEEE
//! Symposium on Volume Visualization, 1998. A boundary is a step blurred by a Gaussian of standard deviation σ.
//! With g(v) and h(v), the means of first and second derivative along the gradient over all places of value v, such
//! a place lies `p(v) = -σ² h(v) / max(0, g(v) - g₀)` from the middle of its boundary (section 5), and
//! `σ = max g / (√e max h)`. Opacity is a tent over p; the rest, which the paper leaves to the user, is fixed here.

use glam::DVec3;
use rayon::prelude::*;

use super::histogram::ValueHistogram;
use super::{ControlPoint, palette};
use crate::volume::Volume;

/// Places at which derivatives are taken, about.
const SAMPLES: usize = 1 << 20;
/// Share of all samples that a value must have before it counts.
const MIN_SHARE: f64 = 2e-5;
/// g₀ as a share of the largest mean gradient: noise inside a material stays below.
const THRESHOLD: f64 = 0.3;
/// Standard deviation, in bins, of the Gaussian that evens out g and h.
const SMOOTHING: f64 = 1.5;
/// Height of the tent from which on values belong to a boundary.
const EDGE: f64 = 0.05;
/// Opacity, over one voxel, of the boundary of the lowest and of the highest values where there are several.
const FRONT_OPACITY: f64 = 0.10;
const BACK_OPACITY: f64 = 0.90;
/// Change of opacity below which a bin needs no control point of its own.
const TOLERANCE: f64 = 0.02;

/// Control points, or `None` where no boundary stands out.
pub(super) fn control_points(
    volume: &Volume,
    histogram: &ValueHistogram,
) -> Option<Vec<ControlPoint>> {
    let mut tents = Derivatives::of(volume, histogram).tents()?;
    // Noise makes gradients in the background too.
    tents[..histogram.foreground_bin()].fill(0.0);
    let boundaries = runs(&tents);
    let opacities = opacities(&tents, &boundaries);
    let visible: Vec<(f64, f64)> = corners(&opacities)
        .into_iter()
        .map(|bin| (histogram.start_of(bin), opacities[bin]))
        .collect();
    let (first, _) = *visible.first()?;
    let last = histogram.foreground_quantile(0.995).max(visible.last()?.0);
    let share = |value: f64| (value - first) / (last - first).max(f64::MIN_POSITIVE);
    let point = |(value, opacity): (f64, f64)| ControlPoint {
        value,
        color: palette::TISSUE.at(share(value)),
        opacity,
        emission: [0.0; 3],
        source: [0.0; 3],
    };
    let mut points: Vec<ControlPoint> = visible.into_iter().map(point).collect();
    // Colour goes on where opacity no longer changes.
    let end = points.last().map_or(0.0, |p| p.opacity);
    if points.last().is_some_and(|p| p.value < last) {
        points.push(point((last, end)));
    }
    Some(points)
}

/// Sums over places, by the bin of their value.
#[derive(Clone)]
struct Derivatives {
    count: Vec<f64>,
    /// Gradient magnitude, values per finest voxel.
    first: Vec<f64>,
    /// Second derivative along the gradient, values per finest voxel squared.
    second: Vec<f64>,
}

impl Derivatives {
    fn none(bins: usize) -> Self {
        Self {
            count: vec![0.0; bins],
            first: vec![0.0; bins],
            second: vec![0.0; bins],
        }
    }

    fn of(volume: &Volume, histogram: &ValueHistogram) -> Self {
        let bins = histogram.bins();
        let size = volume.size();
        let stride = (volume.voxels().len() as f64 / SAMPLES as f64)
            .cbrt()
            .ceil() as usize;
        let stride = stride.max(1);
        let inner = |axis: usize| (1..size[axis].saturating_sub(1)).step_by(stride);
        let slices: Vec<u32> = inner(2).collect();
        let parts: Vec<Self> = slices
            .par_iter()
            .map(|&k| {
                let mut sums = Self::none(bins);
                for j in inner(1) {
                    for i in inner(0) {
                        sums.take(volume, histogram, [i, j, k]);
                    }
                }
                sums
            })
            .collect();
        // In order, so that the rounding is always the same.
        parts.into_iter().fold(Self::none(bins), |mut sum, part| {
            for (into, from) in [
                (&mut sum.count, part.count),
                (&mut sum.first, part.first),
                (&mut sum.second, part.second),
            ] {
                into.iter_mut().zip(from).for_each(|(a, b)| *a += b);
            }
            sum
        })
    }

    /// Central differences at a voxel that has neighbours on all sides.
    fn take(&mut self, volume: &Volume, histogram: &ValueHistogram, [i, j, k]: [u32; 3]) {
        let value = volume.value(i, j, k);
        let bin = histogram.bin(value);
        self.count[bin] += 1.0;
        let differences = DVec3::new(
            volume.value(i + 1, j, k) - volume.value(i - 1, j, k),
            volume.value(i, j + 1, k) - volume.value(i, j - 1, k),
            volume.value(i, j, k + 1) - volume.value(i, j, k - 1),
        );
        // Voxels of the finest axis per voxel of each axis.
        let lengths = DVec3::from_array(volume.spacing()) / volume.min_spacing();
        let gradient = 0.5 * differences / lengths;
        let magnitude = gradient.length();
        if magnitude == 0.0 {
            return;
        }
        let step_ix = gradient / magnitude / lengths;
        let at_ix = DVec3::new(i.into(), j.into(), k.into());
        let ends = [at_ix + step_ix, at_ix - step_ix].map(|end| volume.sample(end));
        let [Some(ahead), Some(behind)] = ends else {
            return;
        };
        self.first[bin] += magnitude;
        self.second[bin] += ahead + behind - 2.0 * value;
    }

    /// Height of the tent over each bin; `None` where nothing changes.
    fn tents(&self) -> Option<Vec<f64>> {
        let [count, first, second] = [&self.count, &self.first, &self.second].map(|s| smooth(s));
        let enough = MIN_SHARE * count.iter().sum::<f64>();
        let mean = |sum: f64, n: f64| if n >= enough && n > 0.0 { sum / n } else { 0.0 };
        let means = |sums: &[f64]| -> Vec<f64> {
            sums.iter()
                .zip(&count)
                .map(|(&sum, &n)| mean(sum, n))
                .collect()
        };
        let (g, h) = (means(&first), means(&second));
        let largest = |values: &[f64]| values.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        let (steepest, bent) = (largest(&g), largest(&h));
        if steepest <= 0.0 || bent <= 0.0 {
            return None;
        }
        let sigma = steepest / (std::f64::consts::E.sqrt() * bent);
        let tent = |(&g, &h): (&f64, &f64)| {
            let above = g - THRESHOLD * steepest;
            if above <= 0.0 {
                return 0.0;
            }
            let distance = sigma * sigma * h / above;
            (1.0 - distance.abs() / sigma).max(0.0)
        };
        Some(g.iter().zip(&h).map(tent).collect())
    }
}

fn smooth(values: &[f64]) -> Vec<f64> {
    let reach = (3.0 * SMOOTHING).ceil() as usize;
    (0..values.len())
        .map(|center| {
            let last = (center + reach).min(values.len() - 1);
            (center.saturating_sub(reach)..=last)
                .map(|bin| {
                    let distance = bin.abs_diff(center) as f64 / SMOOTHING;
                    values[bin] * (-0.5 * distance * distance).exp()
                })
                .sum()
        })
        .collect()
}

/// First and last bin of each boundary.
fn runs(tents: &[f64]) -> Vec<[usize; 2]> {
    let mut runs: Vec<[usize; 2]> = Vec::new();
    for (bin, _) in tents.iter().enumerate().filter(|(_, t)| **t > EDGE) {
        match runs.last_mut() {
            Some(run) if run[1] + 2 >= bin => run[1] = bin,
            _ => runs.push([bin, bin]),
        }
    }
    runs
}

/// Tents, fainter for boundaries of lower values, which are in front of the others. The inside of the last one is
/// solid.
fn opacities(tents: &[f64], boundaries: &[[usize; 2]]) -> Vec<f64> {
    let mut opacities = vec![0.0; tents.len()];
    for (rank, &[first, last]) in boundaries.iter().enumerate() {
        let share = (rank + 1) as f64 / boundaries.len() as f64;
        let height = match boundaries.len() {
            1 => BACK_OPACITY,
            _ => FRONT_OPACITY + (BACK_OPACITY - FRONT_OPACITY) * share * share,
        };
        for bin in first..=last {
            opacities[bin] = height * tents[bin];
        }
    }
    if let Some(&[first, last]) = boundaries.last() {
        let peak = (first..=last)
            .max_by(|&a, &b| opacities[a].total_cmp(&opacities[b]))
            .unwrap_or(last);
        let height = opacities[peak];
        opacities[peak..].fill(height);
    }
    opacities
}

/// Bins that a piecewise linear function needs to follow the opacities within [`TOLERANCE`] (Douglas and Peucker
/// 1973), from the last transparent one on.
fn corners(opacities: &[f64]) -> Vec<usize> {
    let Some(first) = opacities.iter().position(|&o| o > 0.0) else {
        return Vec::new();
    };
    let first = first.saturating_sub(1);
    let mut kept = vec![first, opacities.len() - 1];
    let mut open = vec![[first, opacities.len() - 1]];
    while let Some([a, b]) = open.pop() {
        let line = |bin: usize| {
            let share = (bin - a) as f64 / (b - a).max(1) as f64;
            opacities[a] + (opacities[b] - opacities[a]) * share
        };
        let off = |bin: usize| (opacities[bin] - line(bin)).abs();
        let farthest = (a + 1..b).max_by(|&x, &y| off(x).total_cmp(&off(y)));
        if let Some(bin) = farthest.filter(|&bin| off(bin) > TOLERANCE) {
            kept.push(bin);
            open.extend([[a, bin], [bin, b]]);
        }
    }
    kept.sort_unstable();
    kept.dedup();
    kept
}
