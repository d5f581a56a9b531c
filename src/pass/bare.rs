//! The bench's limit: a march that only samples one texture and classifies.
//!
//! Reads   the volume as one 3D image, transfer (SampledRead)
//! Writes  a target image (Storage)
//! Grid    one workgroup for 8x8 pixels, one dispatch a tile
//! Method  as many samples as the march without skipping or early termination; sums what the transfer function says
//! Limits  as the march
//! Twin    none: its output is only there so that nothing is optimized away

use std::sync::Arc;

use super::{Variants, tile_groups, tiles};
use crate::error::Result;
use crate::gpu::{Access, Bound, Buffer, Context, Image, Recorder, Sampler};
use crate::shader::generated::*;
use crate::shader::interface;
use crate::shader::structs::BarePush;

/// What the bare march works on.
pub(crate) struct BareResources<'a> {
    pub(crate) voxels: &'a Image,
    pub(crate) transfer: &'a Image,
    pub(crate) linear: &'a Sampler,
    pub(crate) uniforms: &'a Buffer,
    pub(crate) volume: (u64, u64),
    pub(crate) frame: (u64, u64),
    pub(crate) target: &'a Image,
}

/// The pass.
pub(crate) struct BarePass {
    variants: Variants,
}

impl BarePass {
    pub(crate) fn new() -> Self {
        Self { variants: Variants::new() }
    }

    pub(crate) fn record(
        &mut self,
        context: &Arc<Context>,
        recorder: &mut Recorder<'_>,
        resources: &BareResources<'_>,
        tile: u32,
    ) -> Result<()> {
        let pipeline = self.variants.get(context, &interface::BARE, Vec::new())?;
        let BareResources { voxels, transfer, linear, uniforms, volume, frame, target } = *resources;
        recorder.use_image(voxels, Access::SampledRead);
        recorder.use_image(transfer, Access::SampledRead);
        recorder.use_image(target, Access::Storage);
        let bound = [
            (BINDING_VOLUME, Bound::Uniform { buffer: uniforms, offset: volume.0, bytes: volume.1 }),
            (BINDING_FRAME, Bound::Uniform { buffer: uniforms, offset: frame.0, bytes: frame.1 }),
            (BINDING_TRANSFER, Bound::Sampled { image: transfer, sampler: linear, general: false }),
            (BINDING_TARGET, Bound::StorageImage(target)),
            (BINDING_VOXELS, Bound::Sampled { image: voxels, sampler: linear, general: false }),
        ];
        recorder.bind(pipeline, &bound)?;
        let [width, height, _] = target.extent();
        let extent_texel = voxels.extent().map(|n| 1.0 / n as f32);
        for (tile_px, tile_end_px) in tiles([width, height], tile) {
            let push = BarePush { tile_px, tile_end_px, extent_texel, pad0: 0.0 };
            recorder.dispatch(pipeline, &push, tile_groups(tile_px, tile_end_px));
        }
        Ok(())
    }
}
