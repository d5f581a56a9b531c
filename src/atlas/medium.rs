//! The device side of the optical models: light volumes on grids of their own, phase function, environment.

use std::sync::Arc;

use ash::vk;

use crate::error::{Error, Result};
use crate::gpu::{Access, Buffer, Context, CopyBox, Filter, Image, ImageInfo, Recorder, Sampler};
use crate::scene::{EnvironmentMap, PhaseFunction};

/// Columns of the table of a phase function.
const PHASE_COLUMNS: u32 = 1025;

/// Points of a grid over the field: the first and the last of an axis lie on its borders.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct LightGrid {
    pub(crate) points: [u32; 3],
}

impl LightGrid {
    /// Points at most `spacing_mm` apart.
    pub(crate) fn spaced(lengths_mm: [f64; 3], spacing_mm: f64) -> Self {
        Self {
            points: lengths_mm.map(|l| (l / spacing_mm).ceil().clamp(1.0, 1023.0) as u32 + 1),
        }
    }

    /// `resolution` points along the longest axis.
    pub(crate) fn of_resolution(lengths_mm: [f64; 3], resolution: u32) -> Self {
        let longest = lengths_mm.into_iter().fold(0.0, f64::max);
        let cells = f64::from(resolution - 1);
        Self {
            points: lengths_mm.map(|l| (l / longest * cells - 1e-6).ceil().max(1.0) as u32 + 1),
        }
    }
}

/// Images of one medium and its lights.
pub(crate) struct MediumImages {
    /// Optical depth towards each light, one volume above the other; one texel without.
    pub(crate) shadow: Image,
    /// Scattered radiance towards the eye; one texel without.
    pub(crate) scattered: Image,
    /// Radiance from all around; one texel without a map.
    pub(crate) environment: Image,
    /// The phase function: cosines of equal probability (row 0), values at equal steps of the cosine (row 1).
    pub(crate) phase: Image,
    /// Largest extinction of each skip cell; one texel without.
    pub(crate) majorant: Image,
    pub(crate) linear: Sampler,
    pub(crate) nearest: Sampler,
    stale: bool,
}

/// What [`MediumImages`] are made for.
pub(crate) struct MediumExtents {
    /// Grid of the swept light volume, and the lights that it holds.
    pub(crate) shadow: Option<(LightGrid, u32)>,
    /// Grid of the scattered light.
    pub(crate) scattered: Option<LightGrid>,
    /// Size of the map.
    pub(crate) environment: Option<[u32; 2]>,
    /// Skip cells, where majorants are wanted.
    pub(crate) majorant: Option<[u32; 3]>,
}

/// What [`MediumImages`] are uploaded from.
pub(crate) struct MediumTexels<'a> {
    pub(crate) environment: Option<&'a EnvironmentMap>,
    pub(crate) phase: &'a PhaseFunction,
    /// By skip cell; empty without.
    pub(crate) majorants: &'a [f32],
}

impl MediumImages {
    /// # Errors
    /// [`Error::OutOfMemory`], [`Error::Unsupported`] for extents beyond the device's limits.
    pub(crate) fn new(context: &Arc<Context>, name: &str, extents: &MediumExtents) -> Result<Self> {
        let volume = |part: &str, extent: [u32; 3], format| {
            let name = format!("{name}.{part}");
            let max = context.capabilities().max_extent_3d;
            if extent.iter().any(|&n| n > max) {
                return Err(Error::Unsupported {
                    device: context.capabilities().name.clone(),
                    need: format!("a 3D image of {extent:?} texels for {name}"),
                    have: format!(
                        "at most {max} on an axis; give a larger lighting.shadows.spacing, or fewer lights"
                    ),
                });
            }
            if !context.filters_linearly(format) {
                return Err(Error::Unsupported {
                    device: context.capabilities().name.clone(),
                    need: format!(
                        "linear filtering of {format:?} (light volumes of optical models)"
                    ),
                    have: "sampling without it".into(),
                });
            }
            let usage = vk::ImageUsageFlags::SAMPLED
                | vk::ImageUsageFlags::STORAGE
                | vk::ImageUsageFlags::TRANSFER_DST;
            Image::new(
                context,
                &ImageInfo {
                    name: &name,
                    extent,
                    format,
                    three_dimensional: true,
                    usage,
                },
            )
        };
        let flat = |part: &str, [width, height]: [u32; 2]| {
            Image::new(
                context,
                &ImageInfo {
                    name: &format!("{name}.{part}"),
                    extent: [width, height, 1],
                    format: vk::Format::R32G32B32A32_SFLOAT,
                    three_dimensional: false,
                    usage: vk::ImageUsageFlags::SAMPLED | vk::ImageUsageFlags::TRANSFER_DST,
                },
            )
        };
        let shadow = extents.shadow.map_or([1; 3], |(grid, lights)| {
            let [x, y, z] = grid.points;
            [x, y, z * lights]
        });
        let scattered = extents.scattered.map_or([1; 3], |grid| grid.points);
        Ok(Self {
            shadow: volume("shadow", shadow, vk::Format::R32_SFLOAT)?,
            scattered: volume("scattered", scattered, vk::Format::R32G32B32A32_SFLOAT)?,
            environment: flat("environment", extents.environment.unwrap_or([1; 2]))?,
            majorant: volume(
                "majorant",
                extents.majorant.unwrap_or([1; 3]),
                vk::Format::R32_SFLOAT,
            )?,
            phase: flat("phase", [PHASE_COLUMNS, 2])?,
            linear: Sampler::new(context, &format!("{name}.medium.linear"), Filter::Linear)?,
            nearest: Sampler::new(context, &format!("{name}.medium.nearest"), Filter::Nearest)?,
            stale: true,
        })
    }

    /// See [`Image::forget`].
    pub(crate) fn forget(&mut self) {
        for image in [
            &self.shadow,
            &self.scattered,
            &self.environment,
            &self.phase,
            &self.majorant,
        ] {
            image.forget();
        }
        self.stale = true;
    }

    /// Uploads map and phase function where they are missing.
    pub(crate) fn record(
        &mut self,
        context: &Arc<Context>,
        recorder: &mut Recorder<'_>,
        texels: &MediumTexels<'_>,
    ) -> Result<()> {
        if !std::mem::take(&mut self.stale) {
            return Ok(());
        }
        for image in [&self.shadow, &self.scattered] {
            recorder.clear(image);
        }
        let mut upload = |name: &str, bytes: &[u8], to: &Image| -> Result<()> {
            let from = Buffer::upload(context, name, bytes, vk::BufferUsageFlags::TRANSFER_SRC)?;
            recorder.upload(&from, to, &[CopyBox::packed(0, [0; 3], to.extent())]);
            recorder.use_image(to, Access::SampledRead);
            Ok(())
        };
        let radiance: Vec<[f32; 4]> = match texels.environment {
            Some(map) => map
                .radiance()
                .iter()
                .map(|&[r, g, b]| [r, g, b, 1.0])
                .collect(),
            None => vec![[0.0; 4]],
        };
        let radiance = bytemuck::cast_slice(&radiance);
        upload("umbravox.upload.environment", radiance, &self.environment)?;
        let phase = phase_texels(texels.phase);
        upload(
            "umbravox.upload.phase",
            bytemuck::cast_slice(&phase),
            &self.phase,
        )?;
        let majorants = if texels.majorants.is_empty() {
            &[0.0]
        } else {
            texels.majorants
        };
        let majorants = bytemuck::cast_slice(majorants);
        upload("umbravox.upload.majorant", majorants, &self.majorant)?;
        recorder.flush();
        Ok(())
    }
}

/// Cosines of equal probability, then values at equal steps of the cosine.
fn phase_texels(phase: &PhaseFunction) -> Vec<[f32; 4]> {
    let last = PHASE_COLUMNS - 1;
    let cosines = phase.equal_probability_cosines(last);
    let values = (0..=last).map(|i| phase.evaluate(2.0 * f64::from(i) / f64::from(last) - 1.0));
    let texel = |value: f64| [value as f32, 0.0, 0.0, 0.0];
    cosines.into_iter().chain(values).map(texel).collect()
}
