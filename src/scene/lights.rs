//! Lights around a volume, for the optical models that scatter.

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::validate::{
    Number, all_finite, check_direction, finite, not_negative, numbers, require,
};
use crate::error::Result;

/// Most lights of a scene.
pub const MAX_LIGHTS: usize = 8;

/// A light outside or inside the volume. Colours are linear radiometric units, not display values.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
pub enum Light {
    /// Parallel light from infinitely far away.
    Directional {
        /// From the scene towards the light, world space; any length.
        direction: [f64; 3],
        /// Power per area across the beam.
        #[serde(default = "white")]
        irradiance: [f64; 3],
    },
    /// The same in all directions from a point.
    Point {
        /// World space, mm.
        position: [f64; 3],
        /// Power per solid angle: the irradiance at a distance of `d` mm is `intensity / d^2`.
        intensity: [f64; 3],
    },
    /// A cone of light from a point.
    Spot {
        /// World space, mm.
        position: [f64; 3],
        /// From the light along the axis of its beam; any length.
        direction: [f64; 3],
        /// On the axis, as of a point light.
        intensity: [f64; 3],
        /// Angle from the axis, degrees, up to which the intensity is whole. Default three quarters of `cutoff_angle`.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        beam_angle: Option<f64>,
        /// Angle from the axis, degrees, at which the intensity has fallen to 0, linearly in the angle. Default 20.
        #[serde(default = "cutoff")]
        cutoff_angle: f64,
    },
}

fn white() -> [f64; 3] {
    [1.0; 3]
}

fn cutoff() -> f64 {
    20.0
}

/// Radiance from all around.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Environment {
    /// Linear radiance, the same from everywhere; in place of `path`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub radiance: Option<[f64; 3]>,
    /// Equirectangular picture of linear radiance, OpenEXR or Radiance HDR, relative to the scene file: its middle column lies
    /// towards world +x (turned by `up`), its upper edge towards `up`, and columns run clockwise seen from there.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub path: Option<PathBuf>,
    /// Factor on the picture, >= 0. Default 1.
    pub scale: f64,
    /// Towards the upper edge of the picture, world space. Default +z.
    pub up: [f64; 3],
    /// Draw it behind the volume in place of the background. Default true.
    pub visible: bool,
}

impl Default for Environment {
    fn default() -> Self {
        Self {
            radiance: None,
            path: None,
            scale: 1.0,
            up: [0.0, 0.0, 1.0],
            visible: true,
        }
    }
}

impl Light {
    /// Checks the ranges of light `index` of a scene.
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] naming the key that is wrong.
    pub fn validate(&self, index: usize) -> Result<()> {
        let at = |key: &str| format!("lighting.lights.{index}.{key}");
        let radiance = |key: &str, value: [f64; 3]| {
            let valid = value.into_iter().all(not_negative);
            require(valid, &at(key), numbers(value), "three numbers >= 0")
        };
        let place = |value: [f64; 3]| {
            let wanted = "three finite numbers (mm)";
            require(all_finite(value), &at("position"), numbers(value), wanted)
        };
        match self {
            Self::Directional {
                direction,
                irradiance,
            } => {
                check_direction(&at("direction"), *direction)?;
                radiance("irradiance", *irradiance)
            }
            Self::Point {
                position,
                intensity,
            } => {
                place(*position)?;
                radiance("intensity", *intensity)
            }
            Self::Spot {
                position,
                direction,
                intensity,
                beam_angle,
                cutoff_angle,
            } => {
                place(*position)?;
                check_direction(&at("direction"), *direction)?;
                radiance("intensity", *intensity)?;
                require(
                    *cutoff_angle > 0.0 && *cutoff_angle <= 180.0,
                    &at("cutoff_angle"),
                    Number(*cutoff_angle),
                    "a number > 0 and <= 180 (degrees from the axis)",
                )?;
                let beam = beam_angle.unwrap_or(0.75 * cutoff_angle);
                require(
                    beam >= 0.0 && beam < *cutoff_angle,
                    &at("beam_angle"),
                    Number(beam),
                    &format!("a number >= 0 and < cutoff_angle, {cutoff_angle} (degrees)"),
                )
            }
        }
    }
}

impl Environment {
    /// The same radiance from everywhere.
    pub fn constant(radiance: [f64; 3]) -> Self {
        Self {
            radiance: Some(radiance),
            ..Self::default()
        }
    }

    /// # Errors
    /// [`crate::Error::Invalid`] naming the key that is wrong.
    pub(super) fn validate(&self) -> Result<()> {
        let at = |key: &str| format!("lighting.environment.{key}");
        require(
            self.radiance.is_some() != self.path.is_some(),
            "lighting.environment",
            format_args!(
                "with {} of them",
                usize::from(self.radiance.is_some()) + usize::from(self.path.is_some())
            ),
            "either \"radiance\" or \"path\"",
        )?;
        if let Some(radiance) = self.radiance {
            let valid = radiance.into_iter().all(not_negative);
            require(
                valid,
                &at("radiance"),
                numbers(radiance),
                "three numbers >= 0",
            )?;
        }
        let valid = finite(self.scale) && self.scale >= 0.0;
        require(valid, &at("scale"), Number(self.scale), "a number >= 0")?;
        check_direction(&at("up"), self.up)
    }
}
