//! Flux from the lights, swept through the volume.
//!
//! Reads   atlas, labels (SampledRead), index, skip, transfer, packed corners (SampledGeneral)
//! Writes  optical depths towards the lights (Storage; each layer reads the one before)
//! Grid    one workgroup for 8x8 points of a layer, one dispatch a layer
//! Method  Kajiya and Von Herzen 1984; Max 1995, section VI
//! Limits  a dispatch is one layer of at most 1024x1024 points
//! Twin    src/reference/transport/quadrature.rs (by rays to the lights)

use std::sync::Arc;

use super::{Reconstruction, Variants, use_field, use_labels};
use crate::atlas::{Images, LabelImages, LightGrid, MediumImages};
use crate::error::Result;
use crate::gpu::{Access, Bound, Context, Recorder, Uniforms};
use crate::shader::generated::*;
use crate::shader::interface;
use crate::shader::structs::SweepPush;

/// The layers of a light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Sweep {
    pub(crate) light: u32,
    /// Across the layers.
    pub(crate) axis: usize,
    /// The light lies beyond the last layer, not before the first. `None`: it is inside, and every point looks for itself.
    pub(crate) from_end: Option<bool>,
}

impl Sweep {
    /// Each layer with the one before it.
    fn layers(self, grid: LightGrid) -> impl Iterator<Item = (i32, i32)> {
        let last = grid.points[self.axis] as i32 - 1;
        (0..=last).map(move |i| match self.from_end {
            None => (i, i),
            Some(false) => (i, (i - 1).max(0)),
            Some(true) => (last - i, (last - i + 1).min(last)),
        })
    }
}

/// What the pass works on.
pub(crate) struct ShadowResources<'a> {
    pub(crate) images: &'a Images,
    pub(crate) labels: Option<&'a LabelImages>,
    pub(crate) medium_images: &'a MediumImages,
    pub(crate) grid: LightGrid,
    pub(crate) volume: Uniforms,
    pub(crate) medium: Uniforms,
}

/// The pass.
#[derive(Default)]
pub(crate) struct ShadowPass {
    variants: Variants,
}

impl ShadowPass {
    pub(crate) fn record(
        &mut self,
        context: &Arc<Context>,
        recorder: &mut Recorder<'_>,
        reconstruction: Reconstruction,
        resources: &ShadowResources<'_>,
        sweeps: &[Sweep],
    ) -> Result<()> {
        let interface = &interface::SHADOW_SWEEP;
        let pipeline = self
            .variants
            .get(context, interface, reconstruction.constants())?;
        let shadow = &resources.medium_images.shadow;
        let mut bound = use_field(recorder, resources.images);
        let labels = use_labels(recorder, resources.images, resources.labels);
        recorder.use_image(shadow, Access::Storage);
        bound.extend(labels);
        bound.extend([
            (BINDING_VOLUME, Bound::Uniform(resources.volume)),
            (BINDING_MEDIUM, Bound::Uniform(resources.medium)),
            (BINDING_SHADOW_STORE, Bound::StorageImage(shadow)),
        ]);
        recorder.bind(pipeline, &bound)?;
        for sweep in sweeps {
            let [u, v] = [1, 2].map(|i| resources.grid.points[(sweep.axis + i) % 3]);
            for (layer, previous) in sweep.layers(resources.grid) {
                // Each layer follows the one before.
                recorder.use_image(shadow, Access::Storage);
                let push = SweepPush {
                    light: sweep.light,
                    axis: sweep.axis as u32,
                    layer,
                    previous,
                };
                recorder.dispatch(pipeline, &push, [u.div_ceil(8), v.div_ceil(8), 1]);
            }
        }
        Ok(())
    }
}
