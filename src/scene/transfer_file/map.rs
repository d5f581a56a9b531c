//! Transfer functions as other programs keep them, and their way to control points and back.

use super::color_space::{ColorSpace, lerp};
use crate::scene::{ColorManagement, ControlPoint};

/// Largest difference, in display values and opacities, between a function and the control points that stand for it.
pub const TOLERANCE: f64 = 1.0 / 512.0;
/// Halvings of an interval at most.
const MAX_DEPTH: u32 = 8;
/// Jumps are written as ramps of this share of the whole range: other programs keep one point per value.
const JUMP: f64 = 1e-6;

/// A point of a curve, with VTK's shape of the way to the next one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Node<const N: usize> {
    pub(super) x: f64,
    pub(super) y: [f64; N],
    /// Where the way to the next node has come halfway, (0,1); 0.5 is straight.
    pub(super) midpoint: f64,
    /// From 0, linear, to 1, a step at the midpoint.
    pub(super) sharpness: f64,
}

impl<const N: usize> Node<N> {
    pub(super) fn linear(x: f64, y: [f64; N]) -> Self {
        Self {
            x,
            y,
            midpoint: 0.5,
            sharpness: 0.0,
        }
    }

    /// How far the way to the next node has come at `share` of the distance (`GetTable` of VTK's transfer functions,
    /// of which only that of colours, three to a node, ends in a step).
    fn progress(&self, share: f64) -> f64 {
        let s = if share < self.midpoint {
            0.5 * share / self.midpoint
        } else {
            0.5 + 0.5 * (share - self.midpoint) / (1.0 - self.midpoint)
        };
        if N == 3 && self.sharpness > 0.99 {
            return if s < 0.5 { 0.0 } else { 1.0 };
        }
        if self.sharpness < 0.01 {
            return s;
        }
        let power = 1.0 + 10.0 * self.sharpness;
        let s = if s < 0.5 {
            0.5 * (2.0 * s).powf(power)
        } else {
            1.0 - 0.5 * (2.0 * (1.0 - s)).powf(power)
        };
        // A cubic Hermite curve whose slopes at both ends are those of the line, less the sharpness.
        let slope = 1.0 - self.sharpness;
        let (s2, s3) = (s * s, s * s * s);
        let curve = 3.0 * s2 - 2.0 * s3 + slope * (s3 - 2.0 * s2 + s) + slope * (s3 - s2);
        curve.clamp(0.0, 1.0)
    }
}

/// A transfer function with colours and opacities of their own places. Colours are display (sRGB) values.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Map {
    pub(super) space: ColorSpace,
    /// By place ascending; at least one.
    pub(super) colors: Vec<Node<3>>,
    /// By place ascending; at least one.
    pub(super) opacities: Vec<Node<1>>,
}

impl Map {
    /// Control points that interpolate, under a colour management, to the same display colours and opacities within
    /// [`TOLERANCE`].
    pub(super) fn control_points(&self, management: ColorManagement) -> Vec<ControlPoint> {
        let exact = |x: f64| {
            let [r, g, b] = along(&self.colors, x, |a, b, share| self.space.mix(a, b, share));
            let [opacity] = along(&self.opacities, x, lerp);
            [r, g, b, opacity]
        };
        let mut knots = knots(&self.colors);
        knots.extend(self::knots(&self.opacities));
        let mix = |a, b, share| mix_managed(management, a, b, share);
        sampled(knots, exact, mix)
            .into_iter()
            .map(|(value, [r, g, b, opacity])| ControlPoint {
                value,
                color: [r, g, b].map(|c| c.clamp(0.0, 1.0)),
                opacity: opacity.clamp(0.0, 1.0),
                emission: [0.0; 3],
                source: [0.0; 3],
            })
            .collect()
    }

    /// The function of control points, which are interpolated under a colour management, as one that is linear in
    /// display colours within [`TOLERANCE`]. Emission is lost.
    pub(super) fn of_control_points(points: &[ControlPoint], management: ColorManagement) -> Self {
        let nodes: Vec<Node<4>> = points
            .iter()
            .map(|p| {
                let [r, g, b] = p.color;
                Node::linear(p.value, [r, g, b, p.opacity])
            })
            .collect();
        let exact = |x: f64| {
            along(&nodes, x, |a, b, share| {
                mix_managed(management, a, b, share)
            })
        };
        let knots: Vec<f64> = nodes.iter().map(|n| n.x).collect();
        let range = match (knots.first(), knots.last()) {
            (Some(first), Some(last)) if last > first => last - first,
            _ => 1.0,
        };
        let mut samples = sampled(knots, exact, lerp);
        let mut previous = f64::NEG_INFINITY;
        for (x, _) in &mut samples {
            if *x <= previous {
                *x = previous + JUMP * range;
            }
            previous = *x;
        }
        Self {
            space: ColorSpace::Rgb,
            colors: samples
                .iter()
                .map(|&(x, [r, g, b, _])| Node::linear(x, [r, g, b]))
                .collect(),
            opacities: samples
                .iter()
                .map(|&(x, [.., opacity])| Node::linear(x, [opacity]))
                .collect(),
        }
    }
}

/// Colours are mixed as light, opacities as they are.
fn mix_managed(management: ColorManagement, a: [f64; 4], b: [f64; 4], share: f64) -> [f64; 4] {
    let light = |[r, g, b, _]: [f64; 4]| management.decode([r, g, b]);
    let [r, g, blue] = management.encode(lerp(light(a), light(b), share));
    [r, g, blue, a[3] + (b[3] - a[3]) * share]
}

/// Places where a curve may have kinks or jumps.
fn knots<const N: usize>(nodes: &[Node<N>]) -> Vec<f64> {
    let own = nodes.iter().map(|n| n.x);
    let middles = nodes
        .windows(2)
        .filter(|pair| pair[0].midpoint != 0.5 || pair[0].sharpness > 0.0)
        .map(|pair| pair[0].x + (pair[1].x - pair[0].x) * pair[0].midpoint);
    own.chain(middles).collect()
}

/// The curve at `x`; its ends hold outside.
fn along<const N: usize>(
    nodes: &[Node<N>],
    x: f64,
    mix: impl Fn([f64; N], [f64; N], f64) -> [f64; N],
) -> [f64; N] {
    let above = nodes.partition_point(|n| n.x <= x);
    let Some(to) = nodes.get(above) else {
        return nodes.last().map_or([0.0; N], |n| n.y);
    };
    let Some(from) = above.checked_sub(1).and_then(|i| nodes.get(i)) else {
        return to.y;
    };
    mix(from.y, to.y, from.progress((x - from.x) / (to.x - from.x)))
}

type Sample = (f64, [f64; 4]);

/// Places and values between which `mix` stays within [`TOLERANCE`] of `exact`; two of one place make a jump.
fn sampled(
    mut knots: Vec<f64>,
    exact: impl Fn(f64) -> [f64; 4],
    mix: impl Fn([f64; 4], [f64; 4], f64) -> [f64; 4],
) -> Vec<Sample> {
    knots.sort_by(f64::total_cmp);
    knots.dedup();
    let mut samples: Vec<Sample> = Vec::new();
    let push = |samples: &mut Vec<Sample>, sample: Sample| {
        let known = samples
            .last()
            .is_some_and(|last| last.0 == sample.0 && differ(last.1, sample.1) <= TOLERANCE * 1e-3);
        if !known {
            samples.push(sample);
        }
    };
    if let Some(&first) = knots.first() {
        push(&mut samples, (first, exact(first)));
    }
    for pair in knots.windows(2) {
        let [a, b] = [pair[0], pair[1]];
        // Just inside of the interval, where there is no jump.
        let inside = |x: f64| {
            let margin = 1e-9 * (b - a);
            exact(x.clamp(a + margin, b - margin))
        };
        let mut ends = vec![(b, 0)];
        let mut from = a;
        push(&mut samples, (a, inside(a)));
        while let Some(&(to, depth)) = ends.last() {
            let is_line = [0.25, 0.5, 0.75].into_iter().all(|share| {
                let there = inside(from + (to - from) * share);
                differ(mix(inside(from), inside(to), share), there) <= TOLERANCE
            });
            if is_line || depth == MAX_DEPTH {
                push(&mut samples, (to, inside(to)));
                from = to;
                ends.pop();
            } else {
                if let Some(last) = ends.last_mut() {
                    last.1 += 1;
                }
                ends.push((0.5 * (from + to), depth + 1));
            }
        }
    }
    if let Some(&last) = knots.last() {
        push(&mut samples, (last, exact(last)));
    }
    samples
}

fn differ(a: [f64; 4], b: [f64; 4]) -> f64 {
    std::array::from_fn::<f64, 4, _>(|i| (a[i] - b[i]).abs())
        .into_iter()
        .fold(0.0, f64::max)
}
