//! Z-tests: whether two pictures of random means show the same.
//!
//! `Z = (a - b) / sqrt(var a + var b)` of every block of pixels and channel is standard normal where both are means of many
//! samples and neither is biased: 0.27 % of them are beyond 3, their mean is 0 and their root mean square 1.

use std::fmt;

use glam::DVec3;
use umbravox::reference::transport::Estimate;

/// Share of a normal distribution beyond three standard deviations, both sides.
const BEYOND_THREE: f64 = 0.002_7;

/// Share of the brightest block below which one is dim.
const DIM: f64 = 0.02;
/// Share of the brightest block that not one lit sample can hide.
const DARK: f64 = 1e-3;

/// What the Z of all blocks come to.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ZScores {
    /// Blocks and channels that some sample lit.
    pub(crate) tested: u32,
    /// Those with `|Z| > 3`.
    pub(crate) beyond_three: u32,
    pub(crate) mean: f64,
    pub(crate) root_mean_square: f64,
    /// Root of the summed squared differences, as a share of that of the summed squared values.
    pub(crate) relative_difference: f64,
}

/// Compares the means of blocks of `block` by `block` pixels. Blocks make few and skewed samples per pixel normal; those
/// that the reference has dimmer than [`DIM`], where few paths are lit at all, are summed up to one more.
///
/// Where nothing varies, not a sample was lit, and both must be dark.
pub(crate) fn z_test(ours: &Estimate, reference: &Estimate, block: u32) -> ZScores {
    assert_eq!(ours.size, reference.size);
    let [mut a, mut b] = [ours, reference].map(|estimate| blocks(estimate, block));
    let brightest = b.iter().map(|(mean, _)| mean.max_element());
    let brightest = brightest.fold(0.0, f64::max);
    assert!(brightest > 0.0, "nothing is lit");
    let is_dim: Vec<bool> = b
        .iter()
        .map(|(mean, _)| mean.max_element() < DIM * brightest)
        .collect();
    for sums in [&mut a, &mut b] {
        pool(sums, &is_dim);
    }
    let mut all = Vec::new();
    let [mut differences, mut values] = [0.0; 2];
    for ((mean_a, variance_a), (mean_b, variance_b)) in a.into_iter().zip(b) {
        for channel in 0..3 {
            let difference = mean_a[channel] - mean_b[channel];
            differences += difference * difference;
            values += mean_b[channel] * mean_b[channel];
            let variance = variance_a[channel] + variance_b[channel];
            if variance > 0.0 {
                all.push(difference / variance.sqrt());
            } else {
                let share = difference.abs() / brightest;
                assert!(share < DARK, "{difference} where nothing is lit");
            }
        }
    }
    let count = all.len() as f64;
    ZScores {
        tested: all.len() as u32,
        beyond_three: all.iter().filter(|z| z.abs() > 3.0).count() as u32,
        mean: all.iter().sum::<f64>() / count,
        root_mean_square: (all.iter().map(|z| z * z).sum::<f64>() / count).sqrt(),
        relative_difference: (differences / values).sqrt(),
    }
}

/// Puts the sum of the blocks that are dim in their place.
fn pool(sums: &mut Vec<(DVec3, DVec3)>, is_dim: &[bool]) {
    let mut pooled = (DVec3::ZERO, DVec3::ZERO);
    let mut bright = Vec::new();
    for (sum, is_dim) in sums.iter().zip(is_dim) {
        if *is_dim {
            pooled.0 += sum.0;
            pooled.1 += sum.1;
        } else {
            bright.push(*sum);
        }
    }
    bright.push(pooled);
    *sums = bright;
}

/// Sums of the pixels of every block, and their variances: pixels are independent.
fn blocks(estimate: &Estimate, block: u32) -> Vec<(DVec3, DVec3)> {
    let [width, height] = estimate.size;
    let columns = width.div_ceil(block);
    let mut sums = vec![(DVec3::ZERO, DVec3::ZERO); (columns * height.div_ceil(block)) as usize];
    let pixels = estimate.mean.iter().zip(&estimate.variance);
    for (at, (mean, variance)) in (0..).zip(pixels) {
        let [x, y]: [u32; 2] = [at % width, at / width];
        let sum = &mut sums[(y / block * columns + x / block) as usize];
        sum.0 += *mean;
        sum.1 += *variance;
    }
    sums
}

impl ZScores {
    /// Expected number of `|Z| > 3`.
    pub(crate) fn expected_beyond_three(&self) -> f64 {
        BEYOND_THREE * f64::from(self.tested)
    }

    /// `None` when the mean is within four of its standard errors and not more `|Z|` are beyond 3 than four standard
    /// deviations of their number above the expected one; else what is wrong. Channels share their samples: a third of the Z
    /// count as independent.
    pub(crate) fn complaint(&self, what: &str) -> Option<String> {
        let independent = f64::from(self.tested) / 3.0;
        let expected = self.expected_beyond_three();
        let most = expected + 4.0 * (3.0 * expected).sqrt().max(1.0);
        let same =
            self.mean.abs() <= 4.0 / independent.sqrt() && f64::from(self.beyond_three) <= most;
        (!same).then(|| format!("{what}: {self}"))
    }

    /// Panics with what is wrong.
    pub(crate) fn assert_same(&self, what: &str) {
        if let Some(complaint) = self.complaint(what) {
            panic!("{complaint}");
        }
    }
}

impl fmt::Display for ZScores {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(
            f,
            "mean Z {:+.3}, RMS {:.3}, {} of {} beyond 3 ({:.1} expected), pictures {:.2} % apart",
            self.mean,
            self.root_mean_square,
            self.beyond_three,
            self.tested,
            self.expected_beyond_three(),
            100.0 * self.relative_difference,
        )
    }
}
