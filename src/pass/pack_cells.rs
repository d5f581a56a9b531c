//! The corners of voxel cells, packed.
//!
//! Reads   atlas (SampledRead)
//! Writes  the packed corners (Storage)
//! Grid    one workgroup for 8x8 texels of a slice
//! Method  copies: each voxel into the texels of the cells that it is a corner of
//! Limits  a dispatch takes at most `TEXELS_A_DISPATCH` texels, or one slice
//! Twin    none: values are moved, and every picture that is compared with a reference reads them

use std::sync::Arc;

use super::{Variants, sampled};
use crate::atlas::{Images, PackedCells};
use crate::error::Result;
use crate::gpu::{Access, Bound, Context, Recorder};
use crate::shader::generated::*;
use crate::shader::interface;
use crate::shader::structs::PartPush;

/// Bounds one dispatch.
const TEXELS_A_DISPATCH: u64 = 1 << 22;

/// The pass.
#[derive(Default)]
pub(crate) struct PackCellsPass {
    variants: Variants,
}

impl PackCellsPass {
    /// Packs the atlas.
    pub(crate) fn record(
        &mut self,
        context: &Arc<Context>,
        recorder: &mut Recorder<'_>,
        images: &Images,
        cells: &PackedCells,
    ) -> Result<()> {
        let constants = vec![(SPEC_PACKED_CELLS, cells.sample_bytes())];
        let pipeline = self
            .variants
            .get(context, &interface::PACK_CELLS, constants)?;
        recorder.use_image(&images.atlas, Access::SampledRead);
        recorder.use_image(&cells.image, Access::Storage);
        let bound = [
            (BINDING_ATLAS, sampled(&images.atlas, &images.nearest)),
            (
                BINDING_PACKED_CELLS_STORE,
                Bound::StorageImage(&cells.image),
            ),
        ];
        recorder.bind(pipeline, &bound)?;
        let [width, height, depth] = cells.image.extent();
        let slices = (TEXELS_A_DISPATCH / (u64::from(width) * u64::from(height))).max(1) as u32;
        for first in (0..depth).step_by(slices as usize) {
            let count = (depth - first).min(slices);
            let groups = [width.div_ceil(8), height.div_ceil(8), count];
            recorder.dispatch(pipeline, &PartPush { first, count }, groups);
        }
        recorder.use_image(&cells.image, Access::SampledGeneral);
        recorder.flush();
        Ok(())
    }
}
