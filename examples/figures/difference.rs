//! How far two pictures are apart to the eye.

use umbravox::picture::{Measured, Picture};
use umbravox::scene::{Image, linear_from_srgb, srgb_from_linear};

/// Opacity from which a pixel counts as covered.
const COVERED: f32 = 0.05;

/// CIE76 differences of two pictures as they would be stored: composited, encoded to sRGB and rounded to 8 bits. In
/// percent of the lightness range.
pub(crate) struct Difference {
    pub(crate) by_pixel: Vec<f64>,
    /// Over all pixels.
    pub(crate) mean: f64,
    /// Over the pixels that either picture covers.
    pub(crate) mean_covered: f64,
}

impl Difference {
    pub(crate) fn new(a: &Picture, b: &Picture, image: &Image) -> Self {
        let [lab_a, lab_b] = [a, b].map(|picture| lab(picture, image));
        let by_pixel: Vec<f64> = lab_a
            .iter()
            .zip(&lab_b)
            .map(|(a, b)| (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt())
            .collect();
        let covered: Vec<f64> = (0..by_pixel.len())
            .filter(|&at| a.rgba[at][3] >= COVERED || b.rgba[at][3] >= COVERED)
            .map(|at| by_pixel[at])
            .collect();
        Self {
            mean: mean(&by_pixel),
            mean_covered: mean(&covered),
            by_pixel,
        }
    }

    /// White where the difference is `full` percent or more.
    pub(crate) fn picture(&self, size: [u32; 2], full: f64) -> Picture {
        let grey = |&e: &f64| (e / full).min(1.0) as f32;
        Picture {
            size,
            rgba: self
                .by_pixel
                .iter()
                .map(grey)
                .map(|g| [g, g, g, 1.0])
                .collect(),
            depth: vec![0.0; self.by_pixel.len()],
            through: None,
            variance: None,
            median_depth: vec![0.0; self.by_pixel.len()],
            measure: vec![0.0; self.by_pixel.len()],
            measured: Measured::ExpectedDepth,
            samples: vec![0; self.by_pixel.len()],
        }
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

fn lab(picture: &Picture, image: &Image) -> Vec<[f64; 3]> {
    picture
        .over(image.color_management.decode(image.background))
        .map(|linear| {
            let stored =
                linear.map(|c| (srgb_from_linear(c.clamp(0.0, 1.0)) * 255.0).round() / 255.0);
            lab_from_linear(stored.map(linear_from_srgb))
        })
        .collect()
}

/// CIE 1976 L*a*b* under D65 of linear sRGB (IEC 61966-2-1 primaries).
fn lab_from_linear([r, g, b]: [f64; 3]) -> [f64; 3] {
    const WHITE: [f64; 3] = [0.950_47, 1.0, 1.088_83];
    let xyz = [
        0.412_456_4 * r + 0.357_576_1 * g + 0.180_437_5 * b,
        0.212_672_9 * r + 0.715_152_2 * g + 0.072_175_0 * b,
        0.019_333_9 * r + 0.119_192_0 * g + 0.950_304_1 * b,
    ];
    let f = |t: f64| {
        if t > (6.0f64 / 29.0).powi(3) {
            t.cbrt()
        } else {
            t / (3.0 * (6.0f64 / 29.0).powi(2)) + 4.0 / 29.0
        }
    };
    let [x, y, z] = [0, 1, 2].map(|i| f(xyz[i] / WHITE[i]));
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}
