//! Projections that classify one value a ray: its largest, smallest or mean sample of those that labels do not hide.

use glam::DVec3;

use super::probe::Probe;
use super::{Pixel, Segment, Setup};

/// The first sample that `replaces` all before it; samples lie at the segments' middles.
pub(super) fn extremum(
    probe: &Probe,
    segments: impl Iterator<Item = Segment>,
    replaces: fn(&f64, &f64) -> bool,
) -> Pixel {
    let mut found: Option<(f64, f64)> = None;
    let mut samples = 0;
    for segment in segments.filter(|s| probe.label(s.middle()).shown) {
        samples += 1;
        let value = probe.value(segment.middle());
        if found.is_none_or(|(extremum, _)| replaces(&value, &extremum)) {
            found = Some((value, segment.middle()));
        }
    }
    found.map_or_else(Pixel::nothing, |(value, distance)| Pixel {
        rgba: classified(probe.setup, value),
        depth: distance,
        median: distance,
        expected: distance,
        value,
        samples,
    })
}

/// The mean of the samples at the segments' middles, weighted by the segments' lengths.
pub(super) fn mean(probe: &Probe, segments: impl Iterator<Item = Segment>) -> Pixel {
    let (mut sum, mut length, mut samples) = (0.0, 0.0, 0);
    for segment in segments.filter(|s| probe.label(s.middle()).shown) {
        samples += 1;
        sum += segment.length() * probe.value(segment.middle());
        length += segment.length();
    }
    if samples == 0 {
        return Pixel::nothing();
    }
    let value = sum / length;
    Pixel {
        rgba: classified(probe.setup, value),
        value,
        samples,
        ..Pixel::nothing()
    }
}

/// Associated colour and opacity of a value, whatever the length: `a (c + c_E)` and `a`.
fn classified(setup: &Setup, value: f64) -> [f64; 4] {
    let optical = setup.curve.evaluate(value);
    let mut color = DVec3::from_array(optical.color);
    if setup.lighting.emission {
        color += DVec3::from_array(optical.emission);
    }
    (optical.opacity * color.extend(1.0)).to_array()
}
