//! The corners of voxel cells, packed.
//!
//! Reads   atlas (SampledRead)
//! Writes  the packed corners (Storage)
//! Grid    two workgroups for a page of texels
//! Method  copies: each voxel into the texels of the cells that it is a corner of
//! Limits  a dispatch takes at most `PAGES_A_DISPATCH` pages
//! Twin    none: values are moved, and every picture that is compared with a reference reads them

use std::sync::Arc;

use super::{Variants, sampled};
use crate::atlas::{Images, PackedCells};
use crate::error::Result;
use crate::gpu::{Access, Bound, Context, Recorder, TexelBuffer};
use crate::shader::generated::*;
use crate::shader::interface;
use crate::shader::structs::PackPush;

/// Bounds one dispatch.
const PAGES_A_DISPATCH: u32 = 1 << 14;

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
        recorder.use_buffer(cells.texels.buffer(), Access::Storage);
        let bound = [
            (BINDING_ATLAS, sampled(&images.atlas, &images.nearest)),
            (BINDING_PACKED_CELLS_STORE, Bound::Texels(&cells.texels)),
        ];
        recorder.bind(pipeline, &bound)?;
        let pages = cells.pages().counts().iter().product();
        for first in (0..pages).step_by(PAGES_A_DISPATCH as usize) {
            let push = PackPush {
                first,
                unused: 0,
                pages: cells.pages().strides(),
            };
            let count = (pages - first).min(PAGES_A_DISPATCH);
            recorder.dispatch(pipeline, &push, [count, 2, 1]);
        }
        recorder.use_buffer(cells.texels.buffer(), TexelBuffer::LOADED);
        recorder.flush();
        Ok(())
    }
}
