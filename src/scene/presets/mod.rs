//! Built-in transfer functions. Opacities hold over one voxel of the finest level unless the scene gives
//! `unit_distance`.

mod hounsfield;
mod labels;
mod relative;

use std::sync::LazyLock;

use super::histogram::ValueHistogram;
use super::{ControlPoint, boundaries};
use crate::error::{Error, Result};
use crate::volume::Volume;

/// A named transfer function.
#[derive(Clone, Copy, Debug)]
pub struct Preset {
    /// What scene files call it.
    pub name: &'static str,
    /// What it shows.
    pub description: &'static str,
    scale: Scale,
}

/// A place, display colour and opacity.
type Points = &'static [(f64, [f64; 3], f64)];

/// What the places of a preset's points are.
#[derive(Clone, Copy, Debug)]
enum Scale {
    /// Values in Hounsfield units.
    Hounsfield(Points),
    /// Shares of the voxels above the background, [0,1].
    Foreground(Points),
    /// The same of a field, whose background is less distinct.
    Field(Points),
    /// There are none: [`boundaries`] finds them.
    Boundaries,
    /// There are none: matter begins at 0.
    LevelSet,
    /// There are none: each label gets its own.
    Labels,
}

const BOUNDARIES: Preset = Preset {
    name: "boundaries",
    description: "surfaces between materials, found from value and gradient (Kindlmann and Durkin 1998)",
    scale: Scale::Boundaries,
};

const LEVEL_SET: Preset = Preset {
    name: "level-set",
    description: "signed distances: solid where they are negative",
    scale: Scale::LevelSet,
};

const LABELS: Preset = Preset {
    name: "labels",
    description: "a colour for each label; of many that fill the volume, one in twelve",
    scale: Scale::Labels,
};

/// Every built-in transfer function.
pub static PRESETS: LazyLock<Vec<Preset>> = LazyLock::new(|| {
    let mut presets = hounsfield::PRESETS.to_vec();
    presets.extend(relative::PRESETS);
    presets.extend([BOUNDARIES, LEVEL_SET, LABELS]);
    presets
});

/// The preset of a name.
///
/// # Errors
/// [`Error::Invalid`] listing every name, the nearest first.
pub(super) fn find(name: &str) -> Result<&'static Preset> {
    PRESETS.iter().find(|p| p.name == name).ok_or_else(|| {
        let mut names: Vec<&str> = PRESETS.iter().map(|p| p.name).collect();
        let nearest = names
            .iter()
            .copied()
            .min_by_key(|valid| strsim::damerau_levenshtein(name, valid))
            .unwrap_or_default();
        names.sort_unstable();
        Error::invalid(
            "transfer_function.preset",
            format!(
                "{name:?} is not available; did you mean \"{nearest}\"? This version has {}",
                names.join(", ")
            ),
        )
    })
}

impl Preset {
    /// As a scene file would list them, for what `volume` holds.
    pub fn control_points(&self, volume: &Volume) -> Vec<ControlPoint> {
        match self.scale {
            Scale::Hounsfield(points) => points.iter().copied().map(control_point).collect(),
            Scale::Foreground(points) => relative_points(points, &ValueHistogram::of(volume)),
            Scale::Field(points) => relative_points(points, &ValueHistogram::of_field(volume)),
            Scale::Labels => labels::control_points(volume),
            Scale::LevelSet => level_set_points(volume),
            Scale::Boundaries => {
                let histogram = ValueHistogram::of(volume);
                // Where nothing stands out, values are all there is to go by.
                boundaries::control_points(volume, &histogram)
                    .unwrap_or_else(|| relative_points(relative::RAMP, &histogram))
            }
        }
    }

    /// The same without a volume; `None` for presets that follow the values of one.
    pub fn fixed_points(&self) -> Option<Vec<ControlPoint>> {
        match self.scale {
            Scale::Hounsfield(points) => Some(points.iter().copied().map(control_point).collect()),
            _ => None,
        }
    }
}

/// Rises over one voxel about the surface.
fn level_set_points(volume: &Volume) -> Vec<ControlPoint> {
    let half = 0.5 * volume.min_spacing();
    let color = [0.85, 0.82, 0.76];
    vec![
        control_point((-half, color, 0.95)),
        control_point((half, color, 0.0)),
    ]
}

fn relative_points(points: Points, histogram: &ValueHistogram) -> Vec<ControlPoint> {
    let place = |&(share, color, opacity): &(f64, [f64; 3], f64)| {
        control_point((histogram.foreground_quantile(share), color, opacity))
    };
    points.iter().map(place).collect()
}

fn control_point((value, color, opacity): (f64, [f64; 3], f64)) -> ControlPoint {
    ControlPoint {
        value,
        color,
        opacity,
        emission: [0.0; 3],
        source: [0.0; 3],
    }
}
