//! What to draw: the scene file, its parts and what they resolve to.
//!
//! Every struct here is both the scene file's JSON (unknown keys are errors) and the library's settings.

mod ambient_occlusion;
mod boundaries;
mod camera;
mod color;
mod content;
mod directions;
mod environment_map;
mod first_picture;
mod framing;
mod histogram;
mod image;
mod labels;
mod lighting;
mod lights;
mod march;
mod palette;
mod parse;
mod phase;
mod presets;
mod procedural;
pub(crate) mod random;
mod scattering;
mod schema;
mod storage;
mod transfer_file;
mod transfer_function;
mod validate;
mod volume_color;

pub use ambient_occlusion::{AmbientOcclusion, RaySampling};
pub use camera::{Camera, Framed, Projection, View};
pub use color::{ColorManagement, linear_from_srgb, srgb_from_linear};
pub use content::{Guess, Modality};
pub use directions::{DirectionSet, directions};
pub use environment_map::EnvironmentMap;
pub use first_picture::FirstPicture;
pub use image::Image;
pub use labels::{LabelSource, LabelStyle, Labels};
pub use lighting::{Gradient, Lighting, OpticalModel, Reflectance, Shading};
pub use lights::{Environment, Light, MAX_LIGHTS};
pub use march::{Classification, Interpolation, Isosurface, March, RayProjection, Surface};
pub use parse::{Override, is_scene_file};
pub use phase::{MAX_ASYMMETRY, MAX_PHASE_VALUES, PhaseFunction};
pub use presets::{PRESETS, Preset};
pub use procedural::{Cloud, Ellipsoid, Procedural};
pub use scattering::{Majorant, Scattering, ScatteringMethod, ShadowMethod, Shadows};
pub use schema::schema;
pub use storage::Storage;
pub use transfer_file::{TRANSFER_TOLERANCE, TransferFile, TransferFormat};
pub use transfer_function::{ControlPoint, Curve, CurvePoint, Optical, TransferFunction};
pub(crate) use validate::check_together;
pub use validate::{
    MAX_EMISSION, MAX_EXPOSURE, MAX_IMAGE_SIZE, MAX_ISOSURFACES, MAX_RAYS, MAX_SAMPLES_PER_RAY,
    MIN_STEP,
};
pub use volume_color::VolumeColor;
pub(crate) use volume_color::check_data_color;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};

/// A whole scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Scene {
    /// The data.
    pub volume: VolumeSource,
    /// From where. Default: automatic.
    #[serde(default)]
    pub camera: Camera,
    /// Size and background of the picture.
    #[serde(default)]
    pub image: Image,
    /// Value to colour, opacity and emission. Default: automatic for what the file holds.
    #[serde(default)]
    pub transfer_function: TransferFunction,
    /// How rays are sampled.
    #[serde(default)]
    pub march: March,
    /// Optical model and surface shading.
    #[serde(default)]
    pub lighting: Lighting,
    /// Local ambient occlusion; `null` or absent: off.
    #[serde(default)]
    pub ambient_occlusion: Option<AmbientOcclusion>,
    /// Levels of detail and memory.
    #[serde(default)]
    pub storage: Storage,
}

/// Where the voxels come from.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VolumeSource {
    /// File, relative to the scene file.
    #[serde(default, skip_serializing_if = "is_empty")]
    pub path: std::path::PathBuf,
    /// A formula in place of a file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub procedural: Option<Procedural>,
    /// Only for headerless files: what the header would have said.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub raw: Option<RawDescription>,
    /// Which series of a DICOM folder: its UID, its number, or the start of its description. Default: the largest.
    /// Which grid of an OpenVDB file: its name. Default: the first.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub series: Option<String>,
    /// Which volume of a file that holds several in time, from 0. Default: the first.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub timestep: Option<u32>,
    /// Which component of voxels that have several, from 0. Default: the first; all of colours.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub channel: Option<u32>,
    /// Where the colours of a volume whose voxels are colours of 8 bits come from. Default: from the data, in compositing and
    /// without `channel`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub color: Option<VolumeColor>,
    /// Which resolution of an OME-Zarr image, from 0, the finest. Default: the finest within the limits.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub level: Option<u32>,
    /// Refuse what would have to be resampled (uneven or missing slices) or guessed (no spacing). Default false.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub strict: bool,
    /// A segmentation of the same place. Default: none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub labels: Option<LabelSource>,
}

fn is_empty(path: &std::path::Path) -> bool {
    path.as_os_str().is_empty()
}

impl VolumeSource {
    /// What is shown of it: the file, or what kind of formula.
    pub fn name(&self) -> String {
        match &self.procedural {
            Some(Procedural::Cloud(_)) => "procedural cloud".to_owned(),
            None => self.path.display().to_string(),
        }
    }

    fn validate(&self) -> Result<()> {
        match (&self.procedural, is_empty(&self.path)) {
            (None, true) => Err(Error::invalid(
                "volume.path",
                "missing or empty; give a file, or \"procedural\" in its place",
            )),
            (None, false) => Ok(()),
            (Some(procedural), true) => procedural.validate(),
            (Some(_), false) => Err(Error::invalid(
                "volume.procedural",
                "stands beside \"path\"; give one of them",
            )),
        }
    }
}

/// Describes a headerless file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RawDescription {
    /// Voxels on x, y, z; x is fastest in the file.
    #[schemars(inner(range(min = 2)))]
    pub size: [u32; 3],
    /// Voxel type.
    #[serde(rename = "type")]
    pub voxel_type: RawType,
    /// Distance between voxels on x, y, z, mm. Default 1.
    #[serde(default = "unit_spacing")]
    pub spacing: [f64; 3],
    /// Byte order. Default little.
    #[serde(default)]
    pub endian: Endian,
    /// Bytes before the first voxel. Default 0.
    #[serde(default)]
    pub offset: u64,
}

fn unit_spacing() -> [f64; 3] {
    [1.0; 3]
}

/// Voxel types of headerless files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum RawType {
    /// Unsigned 8-bit.
    U8,
    /// Signed 8-bit.
    I8,
    /// Unsigned 16-bit.
    U16,
    /// Signed 16-bit.
    I16,
    /// 32-bit float.
    F32,
}

/// Byte order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Endian {
    /// Least significant byte first.
    #[default]
    Little,
    /// Most significant byte first.
    Big,
}
