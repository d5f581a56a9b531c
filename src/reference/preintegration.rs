//! The transfer function along a segment on which the value runs linearly.
//!
//! Klaus Engel, Martin Kraus, Thomas Ertl: "High-Quality Pre-Integrated Volume Rendering Using
//! Hardware-Accelerated Pixel Shading" (2001), equations 4 to 6, with self-attenuation, without a table.

use std::sync::LazyLock;

use glam::DVec3;

use super::classify::Contribution;
use crate::analytic::mean_extinction;
use crate::scene::{Curve, CurvePoint, Optical};

/// A segment of `length` mm with the values `front` and `back` at its ends, and `v(s)` between them:
/// optical depth `int tau(v(s)) ds` and source `int c(v(s)) tau(v(s)) exp(-int_0^s tau) ds`.
///
/// Both are integrated from one control point to the next, where the transfer function is linear.
pub fn preintegrate(curve: &Curve, front: f64, back: f64, length: f64) -> Contribution {
    let lengths = length / curve.unit_distance;
    let mut whole = Contribution::default();
    for piece in pieces(curve, front, back) {
        let transparency = (-whole.depth).exp();
        let part = piece.contribution(lengths * piece.share);
        whole.color += transparency * part.color;
        whole.emission += transparency * part.emission;
        whole.depth += part.depth;
    }
    whole
}

/// A part of a segment on which the transfer function is linear.
struct Piece {
    /// At the near end.
    first: Optical,
    /// At the far end.
    last: Optical,
    /// Of the segment's length.
    share: f64,
}

/// The parts of a segment, from front to back.
fn pieces(curve: &Curve, front: f64, back: f64) -> Vec<Piece> {
    let (Some(lowest), Some(highest)) = (curve.points.first(), curve.points.last()) else {
        return Vec::new();
    };
    if front == back {
        let optical = curve.evaluate(front);
        return vec![Piece {
            first: optical,
            last: optical,
            share: 1.0,
        }];
    }
    let [low, high] = [front.min(back), front.max(back)];
    // The function is constant outside its points.
    let below = CurvePoint {
        value: lowest.value.min(low),
        ..*lowest
    };
    let above = CurvePoint {
        value: highest.value.max(high),
        ..*highest
    };
    let knots: Vec<&CurvePoint> = std::iter::once(&below)
        .chain(&curve.points)
        .chain(std::iter::once(&above))
        .collect();
    let mut pieces: Vec<Piece> = knots
        .windows(2)
        .filter_map(|pair| {
            let (a, b) = (pair[0], pair[1]);
            let [from, to] = [a.value.max(low), b.value.min(high)];
            (from < to).then(|| Piece {
                first: between(a, b, from),
                last: between(a, b, to),
                share: (to - from) / (high - low),
            })
        })
        .collect();
    if front > back {
        pieces.reverse();
        for piece in &mut pieces {
            std::mem::swap(&mut piece.first, &mut piece.last);
        }
    }
    pieces
}

/// On the line between two control points.
fn between(a: &CurvePoint, b: &CurvePoint, value: f64) -> Optical {
    let s = (value - a.value) / (b.value - a.value);
    let mix = |a: f64, b: f64| a * (1.0 - s) + b * s;
    let mix3 = |a: [f64; 3], b: [f64; 3]| std::array::from_fn(|i| mix(a[i], b[i]));
    Optical {
        color: mix3(a.optical.color, b.optical.color),
        opacity: mix(a.optical.opacity, b.optical.opacity),
        emission: mix3(a.optical.emission, b.optical.emission),
        source: mix3(a.optical.source, b.optical.source),
    }
}

impl Piece {
    /// What a piece of `lengths` unit distances adds.
    ///
    /// With `alpha(x)` the opacity of the first `x` of it, the source is `int c d(alpha)`, by parts
    /// `c_last alpha(1) - (c_last - c_first) int_0^1 alpha(x) dx`: colours are linear.
    fn contribution(&self, lengths: f64) -> Contribution {
        let [first, last] = [self.first.opacity, self.last.opacity];
        let depth_to = |x: f64| {
            let opacity = first + (last - first) * x;
            lengths * x * mean_extinction(first, opacity)
        };
        let depth = lengths * mean_extinction(first, last);
        let alpha = -(-depth).exp_m1();
        let mean_alpha = if depth == 0.0 || depth.is_infinite() {
            alpha
        } else {
            integrate(|x| -(-depth_to(x)).exp_m1())
        };
        let source = |first: [f64; 3], last: [f64; 3]| {
            let [first, last] = [first, last].map(DVec3::from_array);
            alpha * last - mean_alpha * (last - first)
        };
        Contribution {
            depth,
            color: source(self.first.color, self.last.color),
            emission: source(self.first.emission, self.last.emission),
        }
    }
}

/// Positions and weights of the double exponential rule (Takahasi and Mori 1974) on (0,1):
/// `x = 1 / (1 + exp(-pi sinh t))` at multiples of 1/16. Steep ends, as of dense matter, do not disturb it:
/// of homogeneous matter of an optical depth up to 1e7 the error is below 4e-11.
static NODES: LazyLock<Vec<(f64, f64)>> = LazyLock::new(|| {
    use std::f64::consts::PI;
    const PER_UNIT: f64 = 16.0;
    (-52..=52)
        .map(|k| {
            let t = f64::from(k) / PER_UNIT;
            let [near, far] = [-1.0, 1.0].map(|sign| 1.0 / (1.0 + (sign * PI * t.sinh()).exp()));
            (near, PI * t.cosh() * near * far / PER_UNIT)
        })
        .collect()
});

/// Integral over (0,1).
fn integrate(integrand: impl Fn(f64) -> f64) -> f64 {
    NODES.iter().map(|&(x, weight)| weight * integrand(x)).sum()
}
