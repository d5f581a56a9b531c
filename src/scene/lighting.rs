//! Optical model and surface shading.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Environment, Light, PhaseFunction, Scattering, Shadows};

/// Optical model (Max 1995), in order of realism. `tau` is the extinction, `c` the transfer function's colour.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum OpticalModel {
    /// Particles that absorb: what is behind is seen through them, as in an X-ray picture.
    Absorption,
    /// Gas that emits `c tau`, the transfer function's emission and its `source`, and absorbs nothing; unbounded.
    Emission,
    /// Particles that emit and absorb: colour times opacity, composited front to back.
    #[default]
    EmissionAbsorption,
    /// Particles of albedo `c` that scatter the light of `lights` and `environment` once; nothing is in its way.
    SingleScattering,
    /// The same; the volume casts shadows on itself.
    ShadowedScattering,
    /// Light is scattered any number of times.
    MultipleScattering,
}

impl OpticalModel {
    /// True for models that scatter the light of `lights` and `environment`.
    pub fn scatters(self) -> bool {
        match self {
            Self::Absorption | Self::Emission | Self::EmissionAbsorption => false,
            Self::SingleScattering | Self::ShadowedScattering | Self::MultipleScattering => true,
        }
    }
}

/// What scatters light in the models of single scattering (Max 1995, section V).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Reflectance {
    /// Particles: albedo times extinction times the phase function.
    #[default]
    Particles,
    /// Surfaces as strong as the gradient, by Lambert's law (eq. 11).
    Lambert,
    /// Lambert's law and a highlight by Phong.
    Phong,
    /// Lambert's law and a highlight by Blinn's half vector.
    BlinnPhong,
    /// Lambert's law and microfacets by Cook and Torrance: Beckmann's distribution, their geometric term, Schlick's Fresnel term.
    CookTorrance,
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

impl Gradient {
    /// True for derivatives of a kernel of four voxels an axis; the others are interpolated between voxels.
    pub fn is_cubic(self) -> bool {
        matches!(self, Self::Bspline | Self::CatmullRom)
    }
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
    /// Estimate gradients once, at voxels, and read them: where all blocks are at the finest level (`storage.data_reduction` 1) and
    /// `storage.memory_budget_mib` has room, for estimators that go from voxel to voxel. In 10 bits for central differences of 8-bit
    /// volumes on CPU drivers, which is exact, else in halves. Off: estimated at every sample, in 32 bits. Default on.
    pub stored_gradients: bool,
    /// Unit-less direction from the scene towards the light, world space; absent: a headlight at the eye
    /// (opposite to each ray's direction).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub direction: Option<[f64; 3]>,
    /// Share of light that needs no surface orientation, >= 0. Default 0.3.
    pub ambient: f64,
    /// Share of light that follows Lambert's law, >= 0. Default 0.7.
    pub diffuse: f64,
    /// Factors on the extinction of red, green and blue, >= 0. Default 1. They change what is seen through the volume in every
    /// optical model; opacity, as picture and depths have it, is that of the mean.
    pub extinction: [f64; 3],
    /// Factors on the transfer function's colour where that is an albedo, 0 to 1. Default 1.
    pub albedo: [f64; 3],
    /// Into which directions particles scatter. Default isotropic.
    pub phase: PhaseFunction,
    /// What scatters, in the models of single scattering. Default particles.
    pub reflectance: Reflectance,
    /// Strength of surfaces: reflectance per unit of opacity over the unit distance and per share of the transfer function's range
    /// that the field passes, >= 0. Default 1.
    pub strength: f64,
    /// Weight of the highlight, >= 0. Default 0.3.
    pub specular: f64,
    /// Exponent of Phong's and Blinn's highlights, >= 1. Default 32.
    pub shininess: f64,
    /// Root mean square slope of Cook and Torrance's facets, in (0,1]. Default 0.3.
    pub roughness: f64,
    /// Lights of the scattering models; at most 8.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub lights: Vec<Light>,
    /// Light from all around, of the scattering models.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub environment: Option<Environment>,
    /// Of the models with shadows and of all but the Monte Carlo method of multiple scattering.
    pub shadows: Shadows,
    /// Of multiple scattering.
    pub scattering: Scattering,
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
            stored_gradients: true,
            direction: None,
            ambient: 0.3,
            diffuse: 0.7,
            extinction: [1.0; 3],
            albedo: [1.0; 3],
            phase: PhaseFunction::default(),
            reflectance: Reflectance::Particles,
            strength: 1.0,
            specular: 0.3,
            shininess: 32.0,
            roughness: 0.3,
            lights: Vec::new(),
            environment: None,
            shadows: Shadows::default(),
            scattering: Scattering::default(),
            emission: true,
        }
    }
}
