//! Value to colour, opacity and emission.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::{ColorManagement, Guess, TransferFile, presets, transfer_file};
use crate::error::Result;
use crate::volume::{Volume, hexadecimal};

/// One control point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ControlPoint {
    /// In the file's own units (Hounsfield in CT).
    pub value: f64,
    /// Display colour, each 0 to 1.
    pub color: [f64; 3],
    /// Opacity over `unit_distance`, 0 to 1.
    pub opacity: f64,
    /// Display colour of emitted light, >= 0; may exceed 1. Default none.
    #[serde(default)]
    pub emission: [f64; 3],
    /// Radiance added per `unit_distance` whatever the opacity, linear, >= 0: Max's `g` given by itself, for gas that glows
    /// and absorbs nothing. Default none.
    #[serde(default, skip_serializing_if = "is_dark")]
    pub source: [f64; 3],
}

fn is_dark(color: &[f64; 3]) -> bool {
    *color == [0.0; 3]
}

/// Piecewise linear between its points, constant outside.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct TransferFunction {
    /// Length that opacities refer to, mm, > 0. Default 1 with `points`; with `file`, what that says; else the smallest
    /// spacing of the volume.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unit_distance: Option<f64>,
    /// Control points, by value ascending; two of equal value make a jump.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub points: Option<Vec<ControlPoint>>,
    /// A built-in function, in place of `points`. With neither, one is chosen for what the file holds.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub preset: Option<String>,
    /// A file of ParaView (JSON, XML), 3D Slicer (.vp, .vp.json) or ours, in place of `points`; relative to the scene file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<std::path::PathBuf>,
    /// Lowest and highest value that the range of `file` is stretched to, as ParaView rescales presets. Default: as in the file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub range: Option<[f64; 2]>,
}

impl TransferFunction {
    /// Explicit points, the named preset, the file's function, or one chosen for what `volume` holds, with colours decoded.
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] as [`TransferFunction::validate`]; what [`TransferFile::read`] says of the file.
    pub fn curve(&self, volume: &Volume, colors: ColorManagement) -> Result<Curve> {
        self.curve_as(volume, colors, || Guess::of(volume).preset)
    }

    /// The same, with the name of the preset that suits what `volume` holds.
    pub(super) fn curve_as(
        &self,
        volume: &Volume,
        colors: ColorManagement,
        suitable: impl FnOnce() -> &'static str,
    ) -> Result<Curve> {
        self.validate()?;
        let preset = |name: &str| {
            let points = presets::find(name)?.control_points(volume);
            Ok((points, volume.min_spacing()))
        };
        let (points, default_unit) = match (&self.points, &self.preset, &self.file) {
            (Some(points), ..) => (points.clone(), 1.0),
            (None, Some(name), _) => preset(name)?,
            (None, None, Some(path)) => {
                let file = TransferFile::read(path)?;
                let mut points = file.control_points(colors);
                if let Some(range) = self.range {
                    transfer_file::stretch(&mut points, range);
                }
                (points, file.unit_distance.unwrap_or(volume.min_spacing()))
            }
            (None, None, None) => preset(suitable())?,
        };
        let unit_distance = self.unit_distance.unwrap_or(default_unit);
        Ok(Curve::new(unit_distance, &points, colors))
    }
}

/// What the transfer function says of a value; colours linear (decoded).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Optical {
    /// Linear colour.
    pub color: [f64; 3],
    /// Opacity over the unit distance.
    pub opacity: f64,
    /// Linear emitted colour.
    pub emission: [f64; 3],
    /// Radiance added per unit distance, whatever the opacity.
    pub source: [f64; 3],
}

/// A control point with decoded colours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurvePoint {
    /// In the file's own units.
    pub value: f64,
    /// What holds there.
    pub optical: Optical,
}

/// A transfer function ready for use: checked, sorted, colours decoded.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Length that opacities refer to, mm.
    pub unit_distance: f64,
    /// At least one, by value ascending.
    pub points: Vec<CurvePoint>,
}

impl Curve {
    /// Decodes the colours of control points; they must be sorted by value and not empty.
    pub fn new(unit_distance: f64, points: &[ControlPoint], colors: ColorManagement) -> Self {
        Self {
            unit_distance,
            points: points
                .iter()
                .map(|p| CurvePoint {
                    value: p.value,
                    optical: Optical {
                        color: colors.decode(p.color),
                        opacity: p.opacity,
                        emission: colors.decode(p.emission),
                        source: p.source,
                    },
                })
                .collect(),
        }
    }

    /// The exact piecewise linear function. At a jump the right-hand side holds.
    pub fn evaluate(&self, value: f64) -> Optical {
        let above = self.points.partition_point(|p| p.value <= value);
        let Some(hi) = self.points.get(above) else {
            return self.points.last().map(|p| p.optical).unwrap_or_default();
        };
        let Some(lo) = above.checked_sub(1).map(|i| &self.points[i]) else {
            return hi.optical;
        };
        let s = (value - lo.value) / (hi.value - lo.value);
        let mix = |a: f64, b: f64| a + (b - a) * s;
        let mix3 = |a: [f64; 3], b: [f64; 3]| std::array::from_fn(|i| mix(a[i], b[i]));
        Optical {
            color: mix3(lo.optical.color, hi.optical.color),
            opacity: mix(lo.optical.opacity, hi.optical.opacity),
            emission: mix3(lo.optical.emission, hi.optical.emission),
            source: mix3(lo.optical.source, hi.optical.source),
        }
    }

    /// The function just below a value: the left-hand side of a jump.
    pub fn before(&self, value: f64) -> Optical {
        let at = self.points.partition_point(|p| p.value < value);
        match self.points.get(at) {
            Some(p) if p.value == value => p.optical,
            _ => self.evaluate(value),
        }
    }

    /// True when some point adds light whatever its opacity.
    pub fn glows(&self) -> bool {
        let mut sources = self.points.iter().flat_map(|p| p.optical.source);
        sources.any(|s| s > 0.0)
    }

    /// SHA-256 of the unit distance and every control point, as 64 hexadecimal digits, whatever file or preset they came from.
    pub fn fingerprint(&self) -> String {
        // Numbers are written so that they are read back as they are.
        hexadecimal(Sha256::new_with_prefix(format!("{self:?}")))
    }

    /// True when some point emits.
    pub fn emits(&self) -> bool {
        self.points
            .iter()
            .any(|p| p.optical.emission.iter().any(|&e| e > 0.0))
    }
}
