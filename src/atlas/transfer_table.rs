//! The transfer function as a table for the shaders, and what it makes visible.
//!
//! Each bin keeps its value at its start and at its end, so that jumps at control points stay jumps, and the number of bins is
//! chosen so that control points fall on bin borders wherever possible: then the table is exact, not an approximation.

use super::Preintegration;
use crate::scene::{Curve, Optical};
use crate::volume::select::Classify;
use crate::volume::{Volume, VoxelType};

/// Most bins; two more pad the ends. Every device has 2D images of 4096 texels.
const MAX_BINS: usize = 4094;
/// Fewest bins: kinks that cannot be aligned stay finely resolved.
const MIN_BINS: usize = 1024;
/// How near (in bins) a control point must be to a border to count as lying on it.
const ALIGNED: f64 = 1e-4;

/// `value = scale * sample + offset`: from what the texture unit returns to the file's own units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SampleScale {
    pub(crate) scale: f64,
    pub(crate) offset: f64,
}

impl SampleScale {
    /// Unsigned normalized textures hold integers, biased by half their range where those are signed.
    pub(crate) fn of(volume: &Volume) -> Self {
        let (texel_scale, bias) = match volume.voxels().voxel_type() {
            VoxelType::U8 => (255.0, 0.0),
            VoxelType::I8 => (255.0, -128.0),
            VoxelType::U16 => (65535.0, 0.0),
            VoxelType::I16 => (65535.0, -32768.0),
            VoxelType::F32 => (1.0, 0.0),
        };
        let rescale = volume.rescale();
        Self {
            scale: rescale.slope * texel_scale,
            offset: rescale.slope * bias + rescale.intercept,
        }
    }

    pub(crate) fn sample(self, value: f64) -> f64 {
        (value - self.offset) / self.scale
    }
}

/// A transfer function ready for the device.
#[derive(Clone, Debug)]
pub(crate) struct TransferTable {
    curve: Curve,
    samples: SampleScale,
    /// Value at the start of bin 1; bin 0 holds what is below.
    first: f64,
    /// Width of a bin in values.
    width: f64,
    starts: Vec<Optical>,
    ends: Vec<Optical>,
    /// Number of bins before each that show something.
    shown_before: Vec<u32>,
    /// Of pre-integrated classification, its table.
    preintegration: Option<Preintegration>,
}

impl TransferTable {
    /// Width of the image that holds a table.
    pub(crate) const MAX_TEXELS: u32 = MAX_BINS as u32 + 2;
    /// Its rows: colour and opacity at starts and at ends of bins, emission likewise, places in the pre-integrated table, what is
    /// added whatever the opacity at starts and at ends.
    pub(crate) const ROWS: u32 = 7;

    /// `preintegrated`: with a table over the two ends of a segment.
    pub(crate) fn new(curve: &Curve, samples: SampleScale, preintegrated: bool) -> Self {
        let values: Vec<f64> = curve.points.iter().map(|p| p.value).collect();
        let (low, high) = (
            values.first().copied().unwrap_or(0.0),
            values.last().copied().unwrap_or(0.0),
        );
        let (bins, width) = if high > low {
            let bins = best_bins(&values);
            (bins, (high - low) / bins as f64)
        } else {
            // One control point, or a single jump: all the action is at the borders of the padding.
            (0, low.abs().max(1.0))
        };
        let border = |b: usize| {
            let value = low + width * b as f64;
            let nearest = values
                .iter()
                .min_by(|p, q| (*p - value).abs().total_cmp(&(*q - value).abs()))
                .copied()
                .unwrap_or(value);
            if (nearest - value).abs() <= 2.0 * ALIGNED * width {
                nearest
            } else {
                value
            }
        };
        let first_point = curve.points.first().map(|p| p.optical).unwrap_or_default();
        let last_point = curve.points.last().map(|p| p.optical).unwrap_or_default();
        let mut starts = vec![first_point];
        let mut ends = vec![first_point];
        for b in 0..bins {
            starts.push(curve.evaluate(border(b)));
            ends.push(curve.before(border(b + 1)));
        }
        starts.push(last_point);
        ends.push(last_point);
        let preintegration = preintegrated.then(|| Preintegration::new(curve, low, width, bins));
        let mut shown_before = vec![0];
        for (a, b) in starts.iter().zip(&ends) {
            let shown = u32::from(shows(a) || shows(b));
            shown_before.push(shown_before.last().copied().unwrap_or(0) + shown);
        }
        Self {
            curve: curve.clone(),
            samples,
            first: low,
            width,
            starts,
            ends,
            shown_before,
            preintegration,
        }
    }

    /// The table over the two ends of a segment, if there is one.
    pub(crate) fn preintegration(&self) -> Option<&Preintegration> {
        self.preintegration.as_ref()
    }

    /// Texture samples to values.
    pub(crate) fn samples(&self) -> SampleScale {
        self.samples
    }

    /// Bins, padding included.
    pub(crate) fn bins(&self) -> usize {
        self.starts.len()
    }

    /// Bins per unit of a texture sample, and the sample at which bin 1 starts.
    pub(crate) fn bin_from_sample(&self) -> (f64, f64) {
        (
            self.samples.scale / self.width,
            self.samples.sample(self.first),
        )
    }

    /// Rows of RGBA: colour and the march's opacity at starts and at ends of bins, then emission and the light pass's
    /// opacity likewise. With pre-integration a fifth: where on an axis of its table each bin starts (r) and ends (g). Then the
    /// light added per unit distance whatever the opacity, at starts and at ends.
    ///
    /// Opacities are over a whole sample of each pass wherever that is linear in the bin. Elsewhere they are the function's own,
    /// and the end is marked as `-1 - opacity` (`bin_opacity` in glsl/include/classify.glsl).
    pub(crate) fn texels(&self, lengths: SampleLengths) -> Vec<[f32; 4]> {
        let bins = self.bins();
        let mut texels = vec![[0.0; 4]; bins * Self::ROWS as usize];
        for (bin, (start, end)) in self.starts.iter().zip(&self.ends).enumerate() {
            let march = bin_opacities(start.opacity, end.opacity, lengths.march);
            let light = bin_opacities(start.opacity, end.opacity, lengths.light);
            let rows = [
                (start.color, march[0]),
                (end.color, march[1]),
                (start.emission, light[0]),
                (end.emission, light[1]),
            ];
            for (row, ([r, g, b], a)) in rows.into_iter().enumerate() {
                texels[row * bins + bin] = [r, g, b, a].map(|c| c as f32);
            }
            for (row, [r, g, b]) in [(5, start.source), (6, end.source)] {
                texels[row * bins + bin] = [r, g, b, 0.0].map(|c| c as f32);
            }
        }
        if let Some(table) = &self.preintegration {
            // The first and the last bin lie beyond the function's range.
            let places = &mut texels[4 * bins + 1..];
            for (texel, [start, end]) in places.iter_mut().zip(table.places()) {
                *texel = [*start, *end, 0.0, 0.0];
            }
        }
        texels
    }

    /// True when some bin is not linear and the shaders have to compute its opacities.
    pub(crate) fn has_exact_bins(&self, lengths: SampleLengths) -> bool {
        self.starts.iter().zip(&self.ends).any(|(start, end)| {
            [lengths.march, lengths.light]
                .iter()
                .any(|&length| bin_opacities(start.opacity, end.opacity, length)[1] < -0.5)
        })
    }

    /// Length that opacities refer to, mm.
    pub(super) fn unit_mm(&self) -> f64 {
        self.curve.unit_distance
    }

    /// Largest opacity over the unit distance of each bin.
    pub(super) fn largest_by_bin(&self) -> Vec<f64> {
        let bins = self.starts.iter().zip(&self.ends);
        bins.map(|(start, end)| start.opacity.max(end.opacity))
            .collect()
    }

    /// First and last bin that values in a range may fall into, and one more on either side for what the device may be off by.
    pub(super) fn bins_of(&self, range: [f64; 2]) -> [usize; 2] {
        let (scale, first) = self.bin_from_sample();
        let mut x = range.map(|v| (self.samples.sample(v) - first) * scale);
        x.sort_by(f64::total_cmp);
        let last = self.bins() - 1;
        // `as` saturates below at 0.
        let bin = |x: f64| (x as usize).min(last);
        [bin(x[0]), bin(x[1] + 2.0)]
    }

    fn at(&self, bin: usize, fraction: f64) -> bool {
        let (a, b) = (&self.starts[bin], &self.ends[bin]);
        (fraction < 1.0 && shows(a)) || (fraction > 0.0 && shows(b))
    }
}

/// Length of a whole sample of each pass, in unit distances of the transfer function (times gamma for light).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SampleLengths {
    pub(crate) march: f64,
    pub(crate) light: f64,
}

/// How far an opacity may be off for its bin to count as linear.
const LINEAR_TOLERANCE: f64 = 1e-6;

/// Opacities at the ends of a bin as the shaders take them.
fn bin_opacities(start: f64, end: f64, length: f64) -> [f64; 2] {
    let whole = |a: f64| -f64::exp_m1(length * f64::ln_1p(-a));
    let (first, last) = (whole(start), whole(end));
    let linear = [0.25, 0.5, 0.75].iter().all(|f| {
        (whole(start + (end - start) * f) - (first + (last - first) * f)).abs() <= LINEAR_TOLERANCE
    });
    if linear {
        [first, last]
    } else {
        [start, -1.0 - end]
    }
}

fn shows(o: &Optical) -> bool {
    o.opacity > 0.0 || o.emission.iter().chain(&o.source).any(|&e| e > 0.0)
}

/// The number of bins that puts control points nearest to bin borders; the largest such.
fn best_bins(values: &[f64]) -> usize {
    let low = values[0];
    let span = values[values.len() - 1] - low;
    let mut best = (f64::INFINITY, MAX_BINS);
    for bins in (MIN_BINS..=MAX_BINS).rev() {
        let mut miss = 0.0f64;
        for v in values {
            let x = (v - low) / span * bins as f64;
            miss = miss.max((x - x.round()).abs() / bins as f64);
            if miss >= best.0 {
                break;
            }
        }
        if miss < best.0 {
            best = (miss, bins);
        }
        if best.0 * best.1 as f64 <= ALIGNED {
            break;
        }
    }
    best.1
}

impl Classify for TransferTable {
    fn premultiplied(&self, value: f64) -> [f32; 7] {
        let o = self.curve.evaluate(value);
        let [r, g, b] = o.color.map(|c| (c * o.opacity) as f32);
        let [er, eg, eb] = std::array::from_fn(|i| (o.emission[i] + o.source[i]) as f32);
        [r, g, b, o.opacity as f32, er, eg, eb]
    }

    /// Widened by what the device may miss a bin by: samples and bins are computed there in 32 bits.
    fn visible(&self, range: [f64; 2]) -> bool {
        let (scale, first) = self.bin_from_sample();
        let sample = range.map(|v| self.samples.sample(v));
        let magnitude = sample[0].abs().max(sample[1].abs());
        // A texture unit's result is off by a few units in the last place, and so is the difference to `first`. A sample
        // of 0 is exact, and so is bin 1 of a function that starts there: a background of 0 stays invisible.
        let margin = (4e-7 * magnitude + 2e-7 * first.abs()) * scale.abs();
        if let Some(table) = &self.preintegration {
            return table.visible(range, margin * self.width);
        }
        let mut x = sample.map(|s| (s - first) * scale);
        x.sort_by(f64::total_cmp);
        let last = self.bins() as f64;
        let low = (1.0 + x[0] - margin - 2e-7 * x[0].abs()).clamp(0.0, last);
        let high = (1.0 + x[1] + margin + 2e-7 * x[1].abs()).clamp(0.0, last);
        let bin = |x: f64| (x as usize).min(self.bins() - 1);
        let (b_low, b_high) = (bin(low), bin(high));
        let (f_low, f_high) = (low - b_low as f64, high - b_high as f64);
        if b_low == b_high {
            return self.at(b_low, f_low) || self.at(b_low, f_high);
        }
        // The first bin from `low` to its end, the last from its start to `high`, all between.
        let between = self.shown_before[b_high] - self.shown_before[b_low + 1] > 0;
        shows(&self.ends[b_low])
            || self.at(b_low, f_low)
            || between
            || shows(&self.starts[b_high])
            || self.at(b_high, f_high)
    }
}

#[cfg(test)]
mod tests {
    use super::{Classify, SampleLengths, SampleScale, TransferTable, bin_opacities};
    use crate::scene::{ColorManagement, ControlPoint, Curve};

    const U8: SampleScale = SampleScale {
        scale: 255.0,
        offset: 0.0,
    };

    fn curve(points: &[(f64, f64)]) -> Curve {
        let points: Vec<_> = points
            .iter()
            .map(|&(value, opacity)| ControlPoint {
                value,
                color: [value.abs() / 1000.0, 0.5, 1.0 - value.abs() / 1000.0],
                opacity,
                emission: [0.0; 3],
                source: [0.0; 3],
            })
            .collect();
        Curve::new(1.0, &points, ColorManagement::None)
    }

    /// The shader's look-up, in f64.
    fn look_up(table: &TransferTable, texels: &[[f32; 4]], value: f64) -> [f64; 4] {
        let (scale, first) = table.bin_from_sample();
        let x = (table.samples.sample(value) - first) * scale + 1.0;
        let x = x.clamp(0.0, table.bins() as f64);
        let bin = (x.floor() as usize).min(table.bins() - 1);
        let f = x - bin as f64;
        let (a, b) = (texels[bin], texels[table.bins() + bin]);
        std::array::from_fn(|i| f64::from(a[i]) * (1.0 - f) + f64::from(b[i]) * f)
    }

    #[test]
    fn the_table_is_the_function() {
        let tables = [
            vec![(-1000.0, 0.0), (150.0, 0.0), (300.0, 0.4), (1200.0, 0.9)],
            vec![
                (0.0, 0.0),
                (100.0, 0.0),
                (100.0, 1.0),
                (101.0, 1.0),
                (101.0, 0.2),
                (255.0, 0.2),
            ],
            vec![(10.0, 0.3)],
            vec![(50.0, 0.0), (50.0, 0.7)],
        ];
        for points in tables {
            let curve = curve(&points);
            let table = TransferTable::new(&curve, U8, false);
            let texels = table.texels(SampleLengths {
                march: 1.0,
                light: 1.0,
            });
            for i in 0..10_000 {
                let value = -1100.0 + 0.2401 * f64::from(i);
                let exact = curve.evaluate(value);
                let got = look_up(&table, &texels, value);
                assert!(
                    (got[3] - exact.opacity).abs() < 2e-6,
                    "{points:?} at {value}: {got:?}"
                );
                assert!(
                    (got[0] - exact.color[0]).abs() < 2e-6,
                    "{points:?} at {value}: {got:?}"
                );
            }
        }
    }

    #[test]
    fn visibility_is_exact_at_the_borders_of_transparency() {
        let table =
            TransferTable::new(&curve(&[(0.0, 0.0), (100.0, 0.0), (200.0, 1.0)]), U8, false);
        assert!(!table.visible([0.0, 0.0]));
        assert!(!table.visible([-50.0, 99.9]));
        assert!(table.visible([0.0, 100.1]));
        assert!(table.visible([150.0, 150.0]));
        assert!(table.visible([300.0, 400.0]));
        // Background exactly where a ramp starts stays invisible: a texture unit returns 0 for 0.
        let ramp = TransferTable::new(&curve(&[(0.0, 0.0), (255.0, 1.0)]), U8, false);
        assert!(!ramp.visible([0.0, 0.0]));
        assert!(ramp.visible([0.0, 1.0]));
        // A peak of one bin between transparent ends is found from a range around it.
        let peak = TransferTable::new(
            &curve(&[
                (0.0, 0.0),
                (99.0, 0.0),
                (100.0, 1.0),
                (101.0, 0.0),
                (255.0, 0.0),
            ]),
            U8,
            false,
        );
        assert!(peak.visible([0.0, 255.0]));
        assert!(peak.visible([99.5, 99.5]));
        assert!(!peak.visible([101.5, 255.0]));
    }

    #[test]
    fn a_range_is_visible_whenever_a_value_in_it_is() {
        let curve = curve(&[
            (3.0, 0.0),
            (5.5, 0.0),
            (6.0, 0.25),
            (7.0, 0.0),
            (200.0, 0.0),
            (201.0, 0.5),
        ]);
        let table = TransferTable::new(&curve, U8, false);
        for low in 0..400 {
            for length in 0..40 {
                let (a, b) = (
                    f64::from(low) * 0.55,
                    f64::from(low) * 0.55 + f64::from(length) * 0.31,
                );
                let any = (0..=100)
                    .any(|i| curve.evaluate(a + (b - a) * f64::from(i) / 100.0).opacity > 1e-9);
                assert!(!any || table.visible([a, b]), "[{a}, {b}]");
            }
        }
    }

    #[test]
    fn opacities_over_a_sample_are_exact_between_the_ends_of_every_bin() {
        for length in [0.05, 0.5, 1.0, 3.0] {
            for (start, end) in [
                (0.0, 0.0),
                (0.2, 0.2003),
                (0.0, 0.9),
                (0.9995, 1.0),
                (1.0, 1.0),
                (1e-5, 2e-5),
            ] {
                let [a, b] = bin_opacities(start, end, length);
                for f in [0.0, 0.1, 0.5, 0.9, 1.0] {
                    let exact = 1.0 - (1.0 - (start + (end - start) * f)).powf(length);
                    let got = if b < -0.5 {
                        1.0 - (1.0 - (a + (-1.0 - b - a) * f)).powf(length)
                    } else {
                        a + (b - a) * f
                    };
                    assert!(
                        (got - exact).abs() < 2e-6,
                        "{start}..{end} over {length} at {f}: {got}, not {exact}"
                    );
                }
            }
        }
    }
}
