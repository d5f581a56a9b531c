//! The table of pre-integrated classification.
//!
//! Reads   integrals along the transfer function (SampledGeneral)
//! Writes  the table, and that of emission (Storage)
//! Grid    one invocation an entry
//! Method  Engel, Kraus and Ertl 2001; exact integrals of up to 16 parts an entry, composited
//! Limits  one dispatch of at most 1021^2 entries
//! Twin    src/reference/preintegration.rs

use std::sync::Arc;

use super::{Variants, use_texels};
use crate::atlas::TableImages;
use crate::error::Result;
use crate::gpu::{Access, Bound, Context, Recorder, Sampler};
use crate::shader::generated::*;
use crate::shader::interface;

/// The pass.
#[derive(Default)]
pub(crate) struct PreintegratePass {
    variants: Variants,
}

impl PreintegratePass {
    /// Computes the table from `images.integrals`.
    pub(crate) fn record(
        &mut self,
        context: &Arc<Context>,
        recorder: &mut Recorder<'_>,
        images: &TableImages,
        nearest: &Sampler,
        emission: bool,
    ) -> Result<()> {
        let constants = vec![(SPEC_EMISSION, emission.into())];
        let pipeline = self
            .variants
            .get(context, &interface::PREINTEGRATE, constants)?;
        let integrals = use_texels(
            recorder,
            [BINDING_INTEGRALS, BINDING_INTEGRALS_LOADS],
            &images.integrals,
            nearest,
        );
        recorder.use_image(&images.table, Access::Storage);
        recorder.use_image(&images.emission, Access::Storage);
        let mut bound = Vec::from(integrals);
        bound.push((
            BINDING_PREINTEGRATED_STORE,
            Bound::StorageImage(&images.table),
        ));
        bound.push((
            BINDING_PREINTEGRATED_EMISSION_STORE,
            Bound::StorageImage(&images.emission),
        ));
        recorder.bind(pipeline, &bound)?;
        let [width, height, _] = images.table.extent();
        recorder.dispatch_plain(pipeline, [width.div_ceil(8), height.div_ceil(8), 1]);
        recorder.use_image(&images.table, Access::SampledGeneral);
        recorder.use_image(&images.emission, Access::SampledGeneral);
        recorder.flush();
        Ok(())
    }
}
