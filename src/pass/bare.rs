//! The bench's limit: a march that only samples one texture and classifies.
//!
//! Reads   the atlas as if it were one texture of the whole volume (SampledRead), packed corners, transfer (SampledGeneral)
//! Writes  a target image (Storage)
//! Grid    one workgroup for 8x8 pixels, one dispatch a tile
//! Method  as many samples as the march without skipping or early termination; sums what the transfer function says
//! Limits  as the march
//! Twin    none: its output is only there so that nothing is optimized away

use std::sync::Arc;

use ash::vk;

use super::{Rectangle, Variants, use_packed_cells, use_transfer};
use crate::atlas::Images;
use crate::error::Result;
use crate::gpu::{Access, Bound, Context, Recorder, Uniforms};
use crate::shader::generated::*;
use crate::shader::interface;
use crate::shader::structs::BarePush;

/// What the bare march works on.
pub(crate) struct BareResources<'a> {
    pub(crate) images: &'a Images,
    /// As [`super::Reconstruction::packed_cells`].
    pub(crate) packed_cells: u32,
    /// Voxels of the volume on x, y, z.
    pub(crate) size: [u32; 3],
    pub(crate) volume: Uniforms,
    pub(crate) frame: Uniforms,
    /// The target, in `GENERAL`.
    pub(crate) target: vk::ImageView,
}

/// The pass.
#[derive(Default)]
pub(crate) struct BarePass {
    variants: Variants,
}

impl BarePass {
    pub(crate) fn record(
        &mut self,
        context: &Arc<Context>,
        recorder: &mut Recorder<'_>,
        resources: &BareResources<'_>,
        size_px: [u32; 2],
        tile: u32,
    ) -> Result<()> {
        let BareResources {
            images,
            packed_cells,
            size,
            volume,
            frame,
            target,
        } = *resources;
        let constants = vec![(SPEC_PACKED_CELLS, packed_cells)];
        let pipeline = self.variants.get(context, &interface::BARE, constants)?;
        recorder.use_image(&images.atlas, Access::SampledRead);
        let sampled = |image, sampler| Bound::Sampled {
            image,
            sampler,
            general: false,
        };
        let [transfer, transfer_loads] = use_transfer(recorder, images);
        let bound = [
            transfer,
            transfer_loads,
            (BINDING_VOLUME, Bound::Uniform(volume)),
            (BINDING_FRAME, Bound::Uniform(frame)),
            (BINDING_TARGET, Bound::StorageView(target)),
            (
                BINDING_VOXELS,
                sampled(&images.atlas, images.atlas_sampler()),
            ),
            use_packed_cells(recorder, images),
        ];
        recorder.bind(pipeline, &bound)?;
        let extent_texel = size.map(|n| 1.0 / n as f32);
        for tile in Rectangle::of_size(size_px).tiles(tile) {
            let push = BarePush {
                tile_px: tile.first,
                tile_end_px: tile.end,
                extent_texel,
                pad0: 0.0,
            };
            recorder.dispatch(pipeline, &push, tile.groups());
        }
        Ok(())
    }
}
