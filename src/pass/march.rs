//! Front-to-back march of the bricked volume into a target image.
//!
//! Reads   atlas, index, skip, transfer (SampledRead), light (SampledGeneral), the host's depth
//! Writes  the target (Storage; read too when it is blended over), depth and sample counts (Storage)
//! Grid    one workgroup for 8x8 pixels, one dispatch a tile
//! Method  emission-absorption with exact opacity correction; skipping by chessboard distances
//! Limits  a dispatch is one tile; its size is chosen so that no dispatch runs long, and changes no pixel
//! Twin    src/reference/march.rs

use std::sync::Arc;

use ash::vk;

use super::{Reconstruction, Variants, sampled, tile_groups, tiles, use_field};
use crate::atlas::Images;
use crate::error::Result;
use crate::gpu::{Access, Bound, Context, Image, ImageInfo, Recorder, Sampler, Uniforms};
use crate::shader::generated::*;
use crate::shader::structs::MarchPush;
use crate::shader::{PassInterface, interface};

/// What specializes the march.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct MarchVariant {
    pub(crate) reconstruction: Reconstruction,
    pub(crate) light: bool,
    pub(crate) diffuse: bool,
    pub(crate) jitter: bool,
    pub(crate) aux: bool,
    pub(crate) scene_depth: bool,
    pub(crate) encode_srgb: bool,
    /// Format of a target that is blended over.
    pub(crate) blend: Option<vk::Format>,
}

impl MarchVariant {
    fn interface(self) -> &'static PassInterface {
        match self.blend {
            None => &interface::MARCH,
            Some(vk::Format::R8G8B8A8_UNORM) => &interface::MARCH_BLEND_RGBA8,
            Some(vk::Format::R16G16B16A16_SFLOAT) => &interface::MARCH_BLEND_RGBA16F,
            Some(_) => &interface::MARCH_BLEND_RGBA32F,
        }
    }

    /// Formats of targets that can be blended over.
    pub(crate) const BLENDABLE: [vk::Format; 3] = [
        vk::Format::R8G8B8A8_UNORM,
        vk::Format::R16G16B16A16_SFLOAT,
        vk::Format::R32G32B32A32_SFLOAT,
    ];

    fn constants(self) -> Vec<(u32, u32)> {
        let mut constants = self.reconstruction.constants();
        constants.extend([
            (SPEC_LIGHT, self.light.into()),
            (SPEC_DIFFUSE, self.diffuse.into()),
            (SPEC_JITTER, self.jitter.into()),
            (SPEC_AUX, self.aux.into()),
            (SPEC_SCENE_DEPTH, self.scene_depth.into()),
            (SPEC_ENCODE_SRGB, self.encode_srgb.into()),
        ]);
        constants
    }
}

/// What the march of one frame works on.
pub(crate) struct MarchResources<'a> {
    pub(crate) images: &'a Images,
    pub(crate) volume: Uniforms,
    pub(crate) frame: Uniforms,
    /// The target, in `GENERAL`.
    pub(crate) target: vk::ImageView,
    /// The host's depth, in the layout given.
    pub(crate) scene_depth: Option<(vk::ImageView, vk::ImageLayout)>,
    /// Depth and sample counts.
    pub(crate) aux: Option<&'a Image>,
}

/// The pass.
pub(crate) struct MarchPass {
    variants: Variants,
    /// Stands in for depth images that a variant does not read, and for outputs it does not write.
    unused_sampled: Image,
    unused_storage: Image,
    nearest: Sampler,
}

impl MarchPass {
    pub(crate) fn new(context: &Arc<Context>) -> Result<Self> {
        let unused = |name, format, usage| {
            let extent = [1; 3];
            Image::new(
                context,
                &ImageInfo {
                    name,
                    extent,
                    format,
                    three_dimensional: false,
                    usage,
                },
            )
        };
        Ok(Self {
            variants: Variants::new(),
            unused_sampled: unused(
                "umbravox.march.no_depth",
                vk::Format::R32_SFLOAT,
                vk::ImageUsageFlags::SAMPLED,
            )?,
            unused_storage: unused(
                "umbravox.march.no_aux",
                vk::Format::R32G32B32A32_SFLOAT,
                vk::ImageUsageFlags::STORAGE,
            )?,
            nearest: Sampler::new(
                context,
                "umbravox.march.nearest",
                crate::gpu::Filter::Nearest,
            )?,
        })
    }

    /// Nothing is known of the state of the stand-ins; see [`Image::forget`].
    pub(crate) fn forget(&self) {
        self.unused_sampled.forget();
        self.unused_storage.forget();
    }

    pub(crate) fn record(
        &mut self,
        context: &Arc<Context>,
        recorder: &mut Recorder<'_>,
        variant: MarchVariant,
        resources: &MarchResources<'_>,
        size_px: [u32; 2],
        tile: u32,
    ) -> Result<()> {
        let Self {
            variants,
            unused_sampled,
            unused_storage,
            nearest,
        } = self;
        let pipeline = variants.get(context, variant.interface(), variant.constants())?;
        let MarchResources {
            images,
            volume,
            frame,
            target,
            scene_depth,
            aux,
        } = *resources;
        let [atlas, index, skip, transfer] = use_field(recorder, images);
        recorder.use_image(&images.light, Access::SampledGeneral);
        recorder.use_image(unused_sampled, Access::SampledRead);
        let aux = aux.unwrap_or(unused_storage);
        recorder.use_image(aux, Access::Storage);
        let bound = [
            (BINDING_VOLUME, Bound::Uniform(volume)),
            (BINDING_FRAME, Bound::Uniform(frame)),
            atlas,
            index,
            skip,
            transfer,
            (
                BINDING_LIGHT,
                Bound::Sampled {
                    image: &images.light,
                    sampler: &images.linear,
                    general: true,
                },
            ),
            (
                BINDING_SCENE_DEPTH,
                match scene_depth {
                    Some((view, layout)) => Bound::SampledView {
                        view,
                        layout,
                        sampler: nearest,
                    },
                    None => sampled(unused_sampled, nearest),
                },
            ),
            (BINDING_TARGET, Bound::StorageView(target)),
            (BINDING_AUX, Bound::StorageImage(aux)),
        ];
        recorder.bind(pipeline, &bound)?;
        for (tile_px, tile_end_px) in tiles(size_px, tile) {
            let push = MarchPush {
                tile_px,
                tile_end_px,
            };
            recorder.dispatch(pipeline, &push, tile_groups(tile_px, tile_end_px));
        }
        Ok(())
    }
}
