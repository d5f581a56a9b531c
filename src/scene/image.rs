//! The picture's size, background and encoding.

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{ColorManagement, MAX_IMAGE_SIZE};

/// The picture.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Image {
    /// Width and height, pixels. Default 512 x 512.
    #[schemars(inner(range(min = 1, max = MAX_IMAGE_SIZE)))]
    pub size: [u32; 2],
    /// Colour behind the volume, display values from 0 to 1. Default black.
    pub background: [f64; 3],
    /// Picture behind the volume, PNG or OpenEXR, in place of `background`, stretched to the size; relative to the scene file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub background_image: Option<PathBuf>,
    /// Brightness of the volume's light in stops: PNG files and targets of engines show `2^exposure` times it. EXR files keep the
    /// radiance. Default 0.
    pub exposure: f64,
    /// Default "linear".
    pub color_management: ColorManagement,
    /// Bits per channel of PNG output, 8 or 16. Default 8.
    #[schemars(extend("enum" = [8, 16]))]
    pub png_bits: u8,
    /// Accumulated opacity above which a ray's depth is taken, in (0,1]. Default 0.05.
    pub depth_threshold: f64,
}

impl Default for Image {
    fn default() -> Self {
        Self {
            size: [512, 512],
            background: [0.0; 3],
            background_image: None,
            exposure: 0.0,
            color_management: ColorManagement::Linear,
            png_bits: 8,
            depth_threshold: 0.05,
        }
    }
}
