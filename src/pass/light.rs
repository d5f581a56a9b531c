//! Local ambient occlusion: one direction a frame for every sample of the light volume that can be seen.
//!
//! Reads   atlas, labels (SampledRead), index, skip, transfer, packed corners (SampledGeneral), brick table and work
//!         lists (storage buffers the host wrote)
//! Writes  the light volume (Storage: a running mean, so each direction reads what the last one wrote)
//! Grid    one workgroup for 4x4x4 samples of a brick; a second pass for samples that bricks share
//! Method  Hernell, Ljung, Ynnerman 2007, eq. 1-5; where distances grow, parts between samples are interpolated
//! Limits  a dispatch takes at most `GROUPS_A_DISPATCH` groups
//! Twin    src/reference/light.rs

use std::sync::Arc;

use super::{Reconstruction, Variants, use_field, use_index, use_labels};
use crate::atlas::{Images, LabelImages, LightLists, LightWork};
use crate::error::Result;
use crate::gpu::{Access, Bound, Context, Recorder, Uniforms};
use crate::shader::generated::*;
use crate::shader::interface;
use crate::shader::structs::{LightPush, PartPush};

/// Bounds one dispatch to about 2 million samples times the samples of a ray.
const GROUPS_A_DISPATCH: usize = 32768;

/// What the light passes work on.
pub(crate) struct LightResources<'a> {
    pub(crate) images: &'a Images,
    pub(crate) labels: Option<&'a LabelImages>,
    pub(crate) lists: &'a LightLists,
    pub(crate) work: &'a LightWork,
    /// The volume's parameters.
    pub(crate) volume: Uniforms,
}

/// What a trace does.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TraceVariant {
    pub(crate) reconstruction: Reconstruction,
    /// Distances between samples grow.
    pub(crate) grows: bool,
    /// Add up samples of the field instead of light.
    pub(crate) count: bool,
}

/// The pass.
#[derive(Default)]
pub(crate) struct LightPass {
    variants: Variants,
}

impl LightPass {
    /// Traces one direction; `push` holds all but the part of the list.
    pub(crate) fn trace(
        &mut self,
        context: &Arc<Context>,
        recorder: &mut Recorder<'_>,
        variant: TraceVariant,
        resources: &LightResources<'_>,
        push: LightPush,
    ) -> Result<()> {
        let mut constants = variant.reconstruction.constants();
        constants.push((SPEC_GROWTH, variant.grows.into()));
        constants.push((SPEC_COUNT, variant.count.into()));
        let pipeline = self
            .variants
            .get(context, &interface::LIGHT_TRACE, constants)?;
        let LightResources {
            images,
            labels,
            lists,
            work,
            volume,
        } = *resources;
        let mut bound = use_field(recorder, images);
        bound.extend(use_labels(recorder, images, labels));
        recorder.use_image(&images.light, Access::Storage);
        bound.extend([
            (BINDING_VOLUME, Bound::Uniform(volume)),
            (BINDING_BRICKS, Bound::Storage(&lists.bricks)),
            (BINDING_WORK, Bound::Storage(&lists.trace)),
            (BINDING_LIGHT_STORE, Bound::StorageImage(&images.light)),
        ]);
        recorder.bind(pipeline, &bound)?;
        for (first, count) in parts(0, work.trace.len()) {
            recorder.dispatch(
                pipeline,
                &LightPush {
                    first,
                    count,
                    ..push
                },
                [count, 1, 1],
            );
        }
        Ok(())
    }

    /// Makes the light continuous across bricks, coarsest level first.
    pub(crate) fn seam(
        &mut self,
        context: &Arc<Context>,
        recorder: &mut Recorder<'_>,
        reconstruction: Reconstruction,
        resources: &LightResources<'_>,
    ) -> Result<()> {
        let constants = vec![(SPEC_UNIFORM_GRID, reconstruction.uniform_grid.into())];
        let pipeline = self
            .variants
            .get(context, &interface::LIGHT_SEAM, constants)?;
        let LightResources {
            images,
            lists,
            work,
            volume,
            ..
        } = *resources;
        let [fetched, loaded] = use_index(recorder, images);
        let bound = [
            (BINDING_VOLUME, Bound::Uniform(volume)),
            fetched,
            loaded,
            (BINDING_BRICKS, Bound::Storage(&lists.bricks)),
            (BINDING_WORK, Bound::Storage(&lists.seam)),
            (BINDING_LIGHT_STORE, Bound::StorageImage(&images.light)),
        ];
        recorder.bind(pipeline, &bound)?;
        for level in work.seam_levels.windows(2).filter(|l| l[0] < l[1]) {
            // Each level follows the coarser ones before it.
            recorder.use_image(&images.light, Access::Storage);
            for (first, count) in parts(level[0], level[1]) {
                recorder.dispatch(pipeline, &PartPush { first, count }, [count, 1, 1]);
            }
        }
        Ok(())
    }
}

/// First entry and count of each dispatch over `[start, end)` of a list.
pub(super) fn parts(start: usize, end: usize) -> impl Iterator<Item = (u32, u32)> {
    (start..end)
        .step_by(GROUPS_A_DISPATCH)
        .map(move |first| (first as u32, (end - first).min(GROUPS_A_DISPATCH) as u32))
}
