//! Volumes that are computed instead of read.

mod cloud;
mod noise;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::error::Result;
use crate::volume::Volume;

pub use cloud::{Cloud, Ellipsoid};

/// A volume made by a formula: the same on every machine.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum Procedural {
    /// A cloud of water droplets (Max 1995).
    Cloud(Cloud),
}

impl Procedural {
    /// Checks the range of every parameter.
    ///
    /// # Errors
    /// [`crate::error::Error::Invalid`] names the parameter by its scene key.
    pub fn validate(&self) -> Result<()> {
        match self {
            Self::Cloud(cloud) => cloud.validate(),
        }
    }

    /// Computes the voxels.
    ///
    /// # Errors
    /// As [`Procedural::validate`]; [`crate::error::Error::OutOfMemory`] when they do not fit in host memory.
    pub fn volume(&self) -> Result<Volume> {
        match self {
            Self::Cloud(cloud) => cloud.volume(),
        }
    }
}
