//! Compositing front to back: emission and absorption, X-ray and isosurfaces.

use glam::DVec3;

use super::classify::classify;
use super::probe::Probe;
use super::{Pixel, Segment, Setup};

/// Halvings of a segment that find where it crosses a surface: to 6e-11 of its length.
const HALVINGS: u32 = 34;

/// What lies in front of the next event on a ray.
struct Front {
    radiance: DVec3,
    opacity: f64,
    depth: f64,
    median: f64,
    /// `sum w t` with `w = (1-A) alpha`; the sum of `w` is the opacity.
    distances: f64,
    samples: u32,
}

impl Front {
    fn nothing() -> Self {
        Self {
            radiance: DVec3::ZERO,
            opacity: 0.0,
            depth: f64::INFINITY,
            median: f64::INFINITY,
            distances: 0.0,
            samples: 0,
        }
    }

    /// Puts something of associated colour `source` behind what is there.
    fn add(&mut self, setup: &Setup, distance: f64, source: DVec3, alpha: f64) {
        let transparency = 1.0 - self.opacity;
        self.radiance += transparency * source;
        self.distances += transparency * alpha * distance;
        self.opacity += transparency * alpha;
        if self.opacity >= setup.depth_threshold {
            self.depth = self.depth.min(distance);
        }
        if self.opacity >= 0.5 {
            self.median = self.median.min(distance);
        }
    }

    fn ends(&self, setup: &Setup) -> bool {
        self.opacity >= setup.march.early_termination
    }

    fn pixel(self) -> Pixel {
        Pixel {
            rgba: self.radiance.extend(self.opacity).to_array(),
            depth: self.depth,
            median: self.median,
            expected: if self.opacity > 0.0 {
                self.distances / self.opacity
            } else {
                f64::INFINITY
            },
            value: f64::NAN,
            samples: self.samples,
        }
    }
}

/// Emission and absorption: each segment adds `(1-A) (C I D + C_E)` with its associated colour `C` and emission
/// `C_E`, light `I` and shading `D` at its middle. The ray ends with the segment after which `A` reaches
/// `march.early_termination`.
pub(super) fn emission_absorption(probe: &Probe, segments: impl Iterator<Item = Segment>) -> Pixel {
    let setup = probe.setup;
    let mut front = Front::nothing();
    for segment in segments {
        front.samples += 1;
        let contribution = classify(probe, segment);
        if contribution.depth > 0.0 {
            let emitted = if setup.lighting.emission {
                contribution.emission
            } else {
                DVec3::ZERO
            };
            let source = contribution.color * probe.light(segment.middle()) + emitted;
            front.add(setup, segment.middle(), source, contribution.alpha());
        }
        if front.ends(setup) {
            break;
        }
    }
    front.pixel()
}

/// Optical depth of the whole ray; black, with the opacity `1 - exp(-depth)`.
pub(super) fn xray(probe: &Probe, segments: impl Iterator<Item = Segment>) -> Pixel {
    let mut front = Front::nothing();
    let mut depth = 0.0;
    for segment in segments {
        front.samples += 1;
        let contribution = classify(probe, segment);
        depth += contribution.depth;
        front.add(
            probe.setup,
            segment.middle(),
            DVec3::ZERO,
            contribution.alpha(),
        );
    }
    Pixel {
        rgba: [0.0, 0.0, 0.0, -f64::exp_m1(-depth)],
        value: depth,
        ..front.pixel()
    }
}

/// Surfaces where the field passes a value, composited front to back with the opacity of each.
///
/// Every segment's two ends tell which surfaces it crosses: those with `(f < v) != (b < v)`. They are met in
/// the order of their values, and each is looked for by bisection. The ray ends as in [`emission_absorption`].
pub(super) fn isosurfaces(probe: &Probe, segments: impl Iterator<Item = Segment>) -> Pixel {
    let setup = probe.setup;
    let mut front = Front::nothing();
    for segment in segments {
        front.samples += 1;
        let [near, far] = [segment.start, segment.end].map(|end| probe.value(end));
        let mut crossed: Vec<_> = setup
            .surfaces
            .iter()
            .filter(|surface| (near < surface.value) != (far < surface.value))
            .collect();
        crossed.sort_by(|a, b| a.value.total_cmp(&b.value));
        if near > far {
            crossed.reverse();
        }
        for surface in crossed {
            let hit = crossing(probe, segment, surface.value);
            let label = probe.label(hit);
            if !label.shown {
                continue;
            }
            let color = DVec3::from_array(surface.color);
            let color = color.lerp(DVec3::from_array(label.color), label.tint) * probe.light(hit);
            front.add(setup, hit, surface.opacity * color, surface.opacity);
            if front.ends(setup) {
                return front.pixel();
            }
        }
    }
    front.pixel()
}

/// Where the field passes `value` in a segment whose ends are on different sides of it.
fn crossing(probe: &Probe, segment: Segment, value: f64) -> f64 {
    let Segment { mut start, mut end } = segment;
    let starts_below = probe.value(start) < value;
    for _ in 0..HALVINGS {
        let middle = 0.5 * (start + end);
        if (probe.value(middle) < value) == starts_below {
            start = middle;
        } else {
            end = middle;
        }
    }
    0.5 * (start + end)
}
