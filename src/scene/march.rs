//! How a ray is sampled.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Reconstruction of the field between voxels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Interpolation {
    /// The nearest voxel.
    Nearest,
    /// Trilinear.
    #[default]
    Linear,
}

/// When the transfer function is applied.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Classification {
    /// After interpolation of the value.
    #[default]
    Post,
}

/// Ray sampling. A ray's segments start where it enters the field (or at the eye, inside): segment i covers
/// `[i, i+1] * step`, the last one ends at the exit and is shorter; each is sampled at its own middle and its
/// opacity is corrected to its own length. With jitter the first segment is shortened by a random share.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct March {
    /// Segment length in voxels of the finest level (smallest spacing), > 0. Default 0.5.
    pub step: f64,
    /// Opacity at which a ray stops, in (0,1]; 1: never early. Default 0.99.
    pub early_termination: f64,
    /// Random length of each ray's first segment, by pixel, frame and seed. Default off.
    pub jitter: bool,
    /// Seed of the jitter. Default 0.
    pub seed: u32,
    /// Reconstruction filter. Default linear.
    pub interpolation: Interpolation,
    /// Order of interpolation and classification. Default post.
    pub classification: Classification,
    /// Skip regions that the transfer function makes invisible; changes no pixel. Default on.
    pub empty_space_skipping: bool,
    /// Interpolate across the borders of blocks. Off: each block by itself, as in Hernell et al. Default on.
    pub inter_block_interpolation: bool,
}

impl Default for March {
    fn default() -> Self {
        Self {
            step: 0.5,
            early_termination: 0.99,
            jitter: false,
            seed: 0,
            interpolation: Interpolation::Linear,
            classification: Classification::Post,
            empty_space_skipping: true,
            inter_block_interpolation: true,
        }
    }
}
