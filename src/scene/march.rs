//! How a ray is sampled.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{ColorManagement, Curve, linear_from_srgb};

/// Reconstruction of the field between voxels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Interpolation {
    /// The nearest voxel.
    Nearest,
    /// Trilinear.
    #[default]
    Linear,
    /// Tri-cubic B-spline without prefilter: twice continuously differentiable, smooths.
    Bspline,
    /// Tri-cubic Catmull-Rom: goes through the voxels, sharp, may overshoot.
    CatmullRom,
}

impl Interpolation {
    /// True when the field has no jumps inside the volume.
    pub fn is_continuous(self) -> bool {
        self != Self::Nearest
    }

    /// True for the filters whose support is four voxels an axis.
    pub fn is_cubic(self) -> bool {
        matches!(self, Self::Bspline | Self::CatmullRom)
    }
}

/// When the transfer function is applied.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Classification {
    /// Before interpolation: voxels are classified, associated colours and opacities are interpolated.
    Pre,
    /// After interpolation of the value, at the middle of each segment.
    Post,
    /// Along each segment: the value runs linearly from the segment's start to its end, and what the transfer function
    /// makes of it is integrated (Engel, Kraus and Ertl 2001). Thin features of the transfer function are never missed.
    #[default]
    Preintegrated,
}

/// What a ray makes of the field.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum RayProjection {
    /// Emission and absorption, front to back.
    #[default]
    Composite,
    /// The largest sample, classified (maximum intensity projection).
    Maximum,
    /// The smallest sample, classified.
    Minimum,
    /// The mean of the samples, weighted by length, classified.
    Mean,
    /// Optical depth: extinction summed along the ray; the background shows through as `exp(-depth)`.
    Xray,
    /// Surfaces of equal value, those of [`March::isosurfaces`].
    Isosurface,
}

/// A surface of equal value.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Isosurface {
    /// The field's value on it, in the file's units.
    pub value: f64,
    /// Display colour. Default: the transfer function's at this value.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub color: Option<[f64; 3]>,
    /// Opacity of the surface, whatever the angle, in (0,1]. Default 1.
    #[serde(default = "opaque")]
    pub opacity: f64,
}

fn opaque() -> f64 {
    1.0
}

/// An [`Isosurface`] with everything that it leaves open filled in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// The field's value on it, in the file's units.
    pub value: f64,
    /// Linear, not premultiplied.
    pub color: [f64; 3],
    /// Whatever the angle, in (0,1].
    pub opacity: f64,
}

/// Ray sampling. A ray's segments start where it enters the field (or at the eye, inside): segment i covers
/// `[i, i+1] * step`, the last one ends at the exit and is shorter. Each is sampled at its own middle (with
/// pre-integration and for isosurfaces: at its two ends) and its opacity is corrected to its own length. With jitter the
/// first segment is shortened by a random share.
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
    /// Order of interpolation and classification; of use to the projections "composite" and "xray". Default: preintegrated,
    /// which comes closest to the integral; post where the field has jumps (nearest interpolation, blocks apart).
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Classification")]
    pub classification: Option<Classification>,
    /// What a ray makes of the field. Default composite.
    pub projection: RayProjection,
    /// The surfaces of the projection "isosurface", in any order; at most 8.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub isosurfaces: Vec<Isosurface>,
    /// Skip regions that the transfer function makes invisible; changes no pixel. Default on.
    pub empty_space_skipping: bool,
    /// Where the processor is the device, find out for 4 x 2 pixels together where something may show, unless those are farther apart
    /// than two voxels; changes no pixel, but which samples that show nothing are taken. Default on.
    pub beams: bool,
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
            classification: None,
            projection: RayProjection::Composite,
            isosurfaces: Vec::new(),
            empty_space_skipping: true,
            beams: true,
            inter_block_interpolation: true,
        }
    }
}

impl March {
    /// The order of interpolation and classification in force.
    pub fn classification(&self) -> Classification {
        self.classification
            .unwrap_or(if self.field_is_continuous() {
                Classification::Preintegrated
            } else {
                Classification::Post
            })
    }

    /// True when the reconstructed field has no jumps inside the volume.
    pub fn field_is_continuous(&self) -> bool {
        self.interpolation.is_continuous() && self.inter_block_interpolation
    }

    /// True when a segment's two ends are sampled, not its middle.
    pub fn samples_ends(&self) -> bool {
        match self.projection {
            RayProjection::Composite | RayProjection::Xray => {
                self.classification() == Classification::Preintegrated
            }
            RayProjection::Isosurface => true,
            RayProjection::Maximum | RayProjection::Minimum | RayProjection::Mean => false,
        }
    }

    /// The surfaces to draw, by value ascending; none unless the projection is "isosurface".
    pub fn surfaces(&self, curve: &Curve, colors: ColorManagement) -> Vec<Surface> {
        if self.projection != RayProjection::Isosurface {
            return Vec::new();
        }
        let decode = |display: [f64; 3]| match colors {
            ColorManagement::Linear => display.map(linear_from_srgb),
            ColorManagement::None => display,
        };
        let mut surfaces: Vec<Surface> = self
            .isosurfaces
            .iter()
            .map(|surface| Surface {
                value: surface.value,
                color: surface
                    .color
                    .map_or_else(|| curve.evaluate(surface.value).color, decode),
                opacity: surface.opacity,
            })
            .collect();
        surfaces.sort_by(|a, b| a.value.total_cmp(&b.value));
        surfaces
    }
}
