//! What the transfer function makes of a segment, by the order of classification and interpolation.

use glam::{DVec3, DVec4, Vec4Swizzles};

use super::Segment;
use super::preintegration::preintegrate;
use super::probe::Probe;
use crate::analytic::extinction;
use crate::scene::{Classification, Optical};

/// What a segment does to the light that passes it and adds to it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Contribution {
    /// Optical depth; infinite in opaque matter.
    pub depth: f64,
    /// Associated (premultiplied) linear colour, in white light.
    pub color: DVec3,
    /// Associated linear emitted colour.
    pub emission: DVec3,
}

impl Contribution {
    /// `length` mm of the same all along: `alpha = 1 - (1 - a)^(length / u)`.
    fn homogeneous(optical: Optical, unit_distance: f64, length: f64) -> Self {
        let depth = extinction(optical.opacity, unit_distance) * length;
        let alpha = -(-depth).exp_m1();
        Self {
            depth,
            color: alpha * DVec3::from_array(optical.color),
            emission: alpha * DVec3::from_array(optical.emission),
        }
    }

    /// Opacity of the segment: `1 - exp(-depth)`.
    pub fn alpha(self) -> f64 {
        -(-self.depth).exp_m1()
    }
}

/// Classifies a segment in the order that the march asks for; colour of the data and label are those at its middle, and the
/// label has the last word.
pub(super) fn classify(probe: &Probe, segment: Segment) -> Contribution {
    let label = probe.label(segment.middle());
    if !label.shown {
        return Contribution::default();
    }
    let mut contribution = classify_values(probe, segment);
    if let Some(color) = probe.data_color(segment.middle()) {
        contribution.color = contribution.alpha() * color;
    }
    let labelled = contribution.alpha() * DVec3::from_array(label.color);
    Contribution {
        color: contribution.color.lerp(labelled, label.tint),
        ..contribution
    }
}

fn classify_values(probe: &Probe, segment: Segment) -> Contribution {
    let curve = probe.setup.curve;
    let homogeneous =
        |optical| Contribution::homogeneous(optical, curve.unit_distance, segment.length());
    match probe.setup.march.classification() {
        Classification::Pre => homogeneous(classified_voxels(probe, segment.middle())),
        Classification::Post => homogeneous(curve.evaluate(probe.value(segment.middle()))),
        Classification::Preintegrated => {
            let [front, back] = [segment.start, segment.end].map(|end| probe.value(end));
            preintegrate(curve, front, back, segment.length())
        }
    }
}

/// Interpolated associated colours: `a = sum w_i a_i`, `c = sum w_i a_i c_i / a`.
fn classified_voxels(probe: &Probe, distance: f64) -> Optical {
    let curve = probe.setup.curve;
    let ix = probe.ix(distance);
    let interpolation = probe.setup.march.interpolation;
    let associated = |part: fn(Optical) -> [f64; 3]| {
        probe.field.interpolate(ix, interpolation, |value| {
            let optical = curve.evaluate(value);
            optical.opacity * DVec3::from_array(part(optical)).extend(1.0)
        })
    };
    let [color, emission] = [associated(|o| o.color), associated(|o| o.emission)];
    let dissociated = |sum: DVec4| {
        if sum.w > 0.0 {
            sum.xyz() / sum.w
        } else {
            DVec3::ZERO
        }
    };
    Optical {
        color: dissociated(color).to_array(),
        opacity: color.w,
        emission: dissociated(emission).to_array(),
        source: [0.0; 3],
    }
}
