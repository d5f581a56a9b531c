//! Settings of local ambient occlusion (Hernell, Ljung, Ynnerman 2007).

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{DirectionSet, MAX_RAYS};

/// Local ambient occlusion. Lengths are in voxels of the finest level (smallest spacing), isotropic in mm.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct AmbientOcclusion {
    /// Directions, >= 1. Subdivided solids give at least as many. Default 32.
    #[schemars(range(min = 1, max = MAX_RAYS))]
    pub rays: u32,
    /// Radius of the sphere, > offset. Default 16.
    pub radius: f64,
    /// Where a ray starts, >= 0. Default 1.
    pub offset: f64,
    /// Upper bound of the sample distance, > 0: `ceil((radius - offset) / step)` samples a ray. Default 1.
    pub step: f64,
    /// Where on its parts of length `step` a ray takes samples. Default uniform.
    pub sampling: RaySampling,
    /// Only with `sampling` `distance`: by how many parts each distance between samples is longer than the one before, 0.05 to 1.
    /// `null`: the largest of 1, 0.6, 0.4 and 0.15 whose light is within 1/255 RMS of uniform sampling's, as estimated on some
    /// thousand voxels; uniform where none is.
    pub growth: Option<f64>,
    /// Contrast: exponent on the transparency of a sample, >= 0. Default 1.
    pub gamma: f64,
    /// Light added everywhere, >= 0. Default 0.
    pub bias: f64,
    /// Where the directions come from. Default Fibonacci.
    pub directions: DirectionSet,
    /// One weight from 0 to 1 per direction; `null`: all 1.
    pub weights: Option<Vec<f64>>,
    /// Explicit directions (towards the light, any length > 0, world space) in place of `rays` and `directions`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub explicit_directions: Option<Vec<[f64; 3]>>,
    /// Add the transfer function's emission to the light (eq. 4). Off: eq. 1. Default on.
    pub emission: bool,
}

/// Where a ray of local ambient occlusion takes samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum RaySampling {
    /// One in the middle of each part of length `step`: equation 2.
    #[default]
    Uniform,
    /// Farther apart with distance from the voxel; parts between are interpolated. Faster, and not quite the same light.
    Distance,
}

impl Default for AmbientOcclusion {
    fn default() -> Self {
        Self {
            rays: 32,
            radius: 16.0,
            offset: 1.0,
            step: 1.0,
            sampling: RaySampling::Uniform,
            growth: None,
            gamma: 1.0,
            bias: 0.0,
            directions: DirectionSet::Fibonacci,
            weights: None,
            explicit_directions: None,
            emission: true,
        }
    }
}

/// Share of a sample by which a ray may be too long for a whole number of them.
const ROUNDING: f64 = 1e-6;

impl AmbientOcclusion {
    /// Parts of a ray of the finest level, `M`; uniform sampling takes one sample in each.
    pub fn samples_per_ray(&self) -> u32 {
        // Lengths in decimals are rarely a whole number of steps in binary: 1.2 / 0.4 is above 3.
        (((self.radius - self.offset) / self.step) - ROUNDING)
            .ceil()
            .max(1.0) as u32
    }

    /// The unit directions and their weights, in the order in which they are traced.
    pub fn weighted_directions(&self) -> Vec<([f64; 3], f64)> {
        let dirs = match &self.explicit_directions {
            Some(explicit) => explicit
                .iter()
                .map(|d| {
                    glam::DVec3::from_array(*d)
                        .normalize_or(glam::DVec3::Z)
                        .to_array()
                })
                .collect(),
            None => super::directions(self.directions, self.rays),
        };
        dirs.into_iter()
            .enumerate()
            .map(|(k, d)| {
                (
                    d,
                    self.weights
                        .as_ref()
                        .and_then(|w| w.get(k))
                        .copied()
                        .unwrap_or(1.0),
                )
            })
            .collect()
    }
}
