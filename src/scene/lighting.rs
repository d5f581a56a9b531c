//! Optical model and surface shading.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Optical model (Max 1995).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum OpticalModel {
    /// Particles that emit and absorb: colour times opacity, composited front to back.
    #[default]
    EmissionAbsorption,
}

/// Surface shading from the field's gradient.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Shading {
    /// None: the transfer function's colour (times ambient occlusion, if on).
    #[default]
    None,
    /// Lambert: colour times `ambient + diffuse * |n . l|`, `n` the unit gradient. Where the gradient is
    /// zero there is no surface and the colour is unchanged.
    Diffuse,
}

/// How the field's gradient is estimated. All but the last two are the trilinear interpolation of estimates at voxels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Gradient {
    /// Differences of the neighbours one voxel away on each axis.
    #[default]
    CentralDifferences,
    /// Separable filter of four taps an axis, `(1/12, -2/3, 0, 2/3, -1/12)` (Ebert and Rheingans 2001): exact for cubics.
    FourPoint,
    /// Linear regression over the 26 neighbours, weighted by `1/distance` (Neumann et al. 2000).
    Regression,
    /// Sobel's operator: differences on one axis, smoothed by (1, 2, 1)/4 on the others.
    Sobel,
    /// Derivative of the tri-cubic B-spline: continuous, smooths.
    Bspline,
    /// Derivative of the tri-cubic Catmull-Rom spline.
    CatmullRom,
}

/// Lighting.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Lighting {
    /// Optical model.
    pub model: OpticalModel,
    /// Surface shading. Default none.
    pub shading: Shading,
    /// How the gradient is estimated, whatever the march's interpolation. Default central differences.
    pub gradient: Gradient,
    /// Unit-less direction from the scene towards the light, world space; absent: a headlight at the eye
    /// (opposite to each ray's direction).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub direction: Option<[f64; 3]>,
    /// Share of light that needs no surface orientation, >= 0. Default 0.3.
    pub ambient: f64,
    /// Share of light that follows Lambert's law, >= 0. Default 0.7.
    pub diffuse: f64,
    /// Add the transfer function's emission to the picture. Off: tissue that emits is seen only by the light that it
    /// casts on its surroundings, through ambient occlusion. Default on.
    pub emission: bool,
}

impl Default for Lighting {
    fn default() -> Self {
        Self {
            model: OpticalModel::EmissionAbsorption,
            shading: Shading::None,
            gradient: Gradient::CentralDifferences,
            direction: None,
            ambient: 0.3,
            diffuse: 0.7,
            emission: true,
        }
    }
}
