//! The bench's limit for light: as many samples for each sample of the light volume as a ray has parts, and nothing else.
//!
//! Reads   the atlas as if it were one texture of the whole volume (SampledRead), packed corners, transfer (SampledGeneral), brick
//!         table and work list
//! Writes  the light volume (Storage)
//! Grid    one workgroup for each group of 4x4x4 samples of the work list
//! Method  reads the texture and the light pass's opacity along the direction, wherever that leads; sums
//! Limits  as the light pass
//! Twin    none: its output is only there so that nothing is optimized away

use std::sync::Arc;

use super::light::{LightResources, parts};
use super::{Reconstruction, Variants, sampled, use_packed_cells, use_transfer};
use crate::error::Result;
use crate::gpu::{Access, Bound, Context, Recorder};
use crate::shader::generated::*;
use crate::shader::interface;
use crate::shader::structs::LightPush;

/// The pass.
#[derive(Default)]
pub(crate) struct BareLightPass {
    variants: Variants,
}

impl BareLightPass {
    /// One direction; `push` holds all but the part of the list.
    pub(crate) fn record(
        &mut self,
        context: &Arc<Context>,
        recorder: &mut Recorder<'_>,
        reconstruction: Reconstruction,
        resources: &LightResources<'_>,
        push: LightPush,
    ) -> Result<()> {
        let pipeline =
            self.variants
                .get(context, &interface::BARE_LIGHT, reconstruction.constants())?;
        let LightResources {
            images,
            lists,
            work,
            volume,
            ..
        } = *resources;
        recorder.use_image(&images.atlas, Access::SampledRead);
        recorder.use_image(&images.light, Access::Storage);
        let [transfer, transfer_loads] = use_transfer(recorder, images);
        let bound = [
            transfer,
            transfer_loads,
            (BINDING_VOLUME, Bound::Uniform(volume)),
            (BINDING_BRICKS, Bound::Storage(&lists.bricks)),
            (BINDING_WORK, Bound::Storage(&lists.trace)),
            (BINDING_LIGHT_STORE, Bound::StorageImage(&images.light)),
            (
                BINDING_VOXELS,
                sampled(&images.atlas, images.atlas_sampler()),
            ),
            use_packed_cells(recorder, images),
        ];
        recorder.bind(pipeline, &bound)?;
        for (first, count) in parts(0, work.trace.len()) {
            let push = LightPush {
                first,
                count,
                ..push
            };
            recorder.dispatch(pipeline, &push, [count, 1, 1]);
        }
        Ok(())
    }
}
