//! How scattered light is computed.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Lighting;
use super::validate::{Number, finite, require};
use crate::error::Result;

/// How the light that reaches a point is found, in the models with shadows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ShadowMethod {
    /// Flux swept through the volume, layer by layer, into a light volume that all views share (Kajiya and Von Herzen 1984).
    #[default]
    Sweep,
    /// A ray to every light from every sample: exact, and as dear as that.
    Rays,
}

/// Shadows.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Shadows {
    /// Default "sweep".
    pub method: ShadowMethod,
    /// Distance between points of the swept light volume, voxels, >= 1. Default 2.
    pub spacing: f64,
}

impl Default for Shadows {
    fn default() -> Self {
        Self {
            method: ShadowMethod::Sweep,
            spacing: 2.0,
        }
    }
}

/// How multiple scattering is solved (Max 1995, section VII).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ScatteringMethod {
    /// Discrete ordinates: light in direction bins, propagated layer by layer and redistributed by the phase function until
    /// it no longer changes.
    #[default]
    Ordinates,
    /// Path tracing with null-collision tracking: unbiased, refined from frame to frame.
    MonteCarlo,
    /// Spherical harmonics of order one: diffusion, solved by finite differences.
    Diffusion,
    /// Radiosity between all pairs of zones; isotropic media on small grids.
    Zonal,
}

/// What null-collision tracking takes as the largest extinction around a place.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Majorant {
    /// That of the skip cell.
    #[default]
    Local,
    /// That of the whole volume.
    Global,
}

/// Multiple scattering.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Scattering {
    /// Default "ordinates".
    pub method: ScatteringMethod,
    /// Points of the light volume along the longest axis. Default 32 (ordinates), 64 (diffusion), 12 (zonal).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub resolution: Option<u32>,
    /// Direction bins of the discrete ordinates, 6 n^2: 24, 54, 96, 150 or 216. Default 96, as Max.
    pub directions: u32,
    /// Iterations at most. Default 64 (ordinates, zonal), 2048 (diffusion).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub iterations: Option<u32>,
    /// Largest change of an iteration, as a share of the largest value, at which it is done. Default 1e-4.
    pub tolerance: f64,
    /// Paths of every pixel at most. Default 64.
    pub samples: u32,
    /// Stop once the standard error of the mean picture is below this share of its mean; 0: never early. Default 0.
    pub noise: f64,
    /// Scatterings of a path at most. Default 1024; 1: single scattering.
    pub max_scatterings: u32,
    /// Default "local".
    pub majorant: Majorant,
}

impl Default for Scattering {
    fn default() -> Self {
        Self {
            method: ScatteringMethod::Ordinates,
            resolution: None,
            directions: 96,
            iterations: None,
            tolerance: 1e-4,
            samples: 64,
            noise: 0.0,
            max_scatterings: 1024,
            majorant: Majorant::Local,
        }
    }
}

impl Scattering {
    /// Points of the light volume along the longest axis.
    pub fn resolution(&self) -> u32 {
        self.resolution.unwrap_or(match self.method {
            ScatteringMethod::Ordinates => 32,
            ScatteringMethod::Diffusion => 64,
            ScatteringMethod::Zonal | ScatteringMethod::MonteCarlo => 12,
        })
    }

    /// Iterations at most.
    pub fn iterations(&self) -> u32 {
        self.iterations.unwrap_or(match self.method {
            ScatteringMethod::Diffusion => 2048,
            _ => 64,
        })
    }
}

/// Checks what a scattering model is computed by.
pub(super) fn check_scattering(lighting: &Lighting) -> Result<()> {
    let Shadows { spacing, .. } = lighting.shadows;
    require(
        finite(spacing) && spacing >= 1.0,
        "lighting.shadows.spacing",
        Number(spacing),
        "a number >= 1 (voxels)",
    )?;
    let scattering = &lighting.scattering;
    let at = |key: &str| format!("lighting.scattering.{key}");
    if let Some(resolution) = scattering.resolution {
        let most = match scattering.method {
            ScatteringMethod::Zonal => 20,
            _ => 256,
        };
        require(
            (2..=most).contains(&resolution),
            &at("resolution"),
            resolution,
            &format!("a whole number from 2 to {most} (points on the longest axis)"),
        )?;
    }
    require(
        matches!(scattering.directions, 24 | 54 | 96 | 150 | 216),
        &at("directions"),
        scattering.directions,
        "24, 54, 96, 150 or 216",
    )?;
    let counts = [
        ("iterations", scattering.iterations(), 65_536),
        ("samples", scattering.samples, 1 << 20),
        ("max_scatterings", scattering.max_scatterings, 1 << 20),
    ];
    for (key, count, most) in counts {
        let wanted = format!("a whole number from 1 to {most}");
        require((1..=most).contains(&count), &at(key), count, &wanted)?;
    }
    for (key, share) in [
        ("tolerance", scattering.tolerance),
        ("noise", scattering.noise),
    ] {
        let valid = (0.0..=1.0).contains(&share);
        require(valid, &at(key), Number(share), "a number from 0 to 1")?;
    }
    Ok(())
}
