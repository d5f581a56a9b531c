//! A colour for each label.

use crate::scene::content::label_values;
use crate::scene::{ControlPoint, palette};
use crate::volume::Volume;

/// Opacity of what is shown, over one voxel.
const OPACITY: f64 = 0.95;
/// From this many labels on that fill the volume, only some are shown: the others would hide them.
const MANY: usize = 64;
/// Share of the voxels that have a label, from which on the volume counts as full.
const FULL: f64 = 0.6;
/// One in so many is shown then.
const ONE_IN: u64 = 12;

/// Each label from half a unit below to half a unit above it in a colour of its own; 0 is transparent.
pub(super) fn control_points(volume: &Volume) -> Vec<ControlPoint> {
    let labels: Vec<(u64, u64)> = label_values(volume)
        .into_iter()
        .filter(|&(value, _)| value > 0.0)
        .map(|(value, count)| (value as u64, count))
        .collect();
    let labelled: u64 = labels.iter().map(|&(_, count)| count).sum();
    let full = labelled as f64 >= FULL * volume.voxels().len() as f64;
    let thinned = full && labels.len() >= MANY;
    let shown = |label: u64| !thinned || scatter(label).is_multiple_of(ONE_IN);
    let mut points: Vec<ControlPoint> = Vec::new();
    for label in labels
        .into_iter()
        .map(|(label, _)| label)
        .filter(|&l| shown(l))
    {
        let color = palette::of_label(label);
        let value = label as f64;
        for (value, opacity) in [
            (value - 0.5, 0.0),
            (value - 0.5, OPACITY),
            (value + 0.5, OPACITY),
            (value + 0.5, 0.0),
        ] {
            points.push(ControlPoint {
                value,
                color,
                opacity,
                emission: [0.0; 3],
                source: [0.0; 3],
            });
        }
    }
    if points.is_empty() {
        points.push(ControlPoint {
            value: 0.0,
            color: [1.0; 3],
            opacity: OPACITY,
            emission: [0.0; 3],
            source: [0.0; 3],
        });
    }
    points
}

/// Spreads labels, which often ascend along an axis (Knuth, The Art of Computer Programming 3, 6.4).
fn scatter(label: u64) -> u64 {
    (label.wrapping_mul(2_654_435_769) & 0xffff_ffff) >> 16
}
