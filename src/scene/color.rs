//! Display colours and linear light.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub use crate::volume::linear_from_srgb;

/// What colours in the scene file and in the picture mean.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum ColorManagement {
    /// Scene colours are sRGB and are decoded; light is computed linearly; PNG is encoded to sRGB, EXR is linear.
    #[default]
    Linear,
    /// Numbers are used as they are on both ends (what VTK does).
    None,
}

/// IEC 61966-2-1 encoding of one channel. Values above 1 follow the same curve.
pub fn srgb_from_linear(linear: f64) -> f64 {
    if linear <= 0.003_130_8 {
        linear * 12.92
    } else {
        1.055 * linear.powf(1.0 / 2.4) - 0.055
    }
}

impl ColorManagement {
    /// A scene colour as linear light (or unchanged without colour management).
    pub fn decode(self, display: [f64; 3]) -> [f64; 3] {
        match self {
            Self::Linear => display.map(linear_from_srgb),
            Self::None => display,
        }
    }

    /// Linear light as a display colour (or unchanged without colour management).
    pub fn encode(self, linear: [f64; 3]) -> [f64; 3] {
        match self {
            Self::Linear => linear.map(srgb_from_linear),
            Self::None => linear,
        }
    }
}
