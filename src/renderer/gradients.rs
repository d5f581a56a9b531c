//! Stored gradients: whether there are some, and those that a frame adds.

use std::sync::Arc;

use super::loaded::{Loaded, NAME, other_texel_bytes, shading_reach};
use super::pass_name;
use super::settings::Settings;
use crate::atlas::{GradientVolume, Residency, Store, Uploads};
use crate::error::Result;
use crate::gpu::{Context, Recorder, Uniforms};
use crate::pass::gradients::GradientsResources;

/// The volume of gradients, where samples need gradients and it can be had.
pub(super) fn gradients(
    context: &Arc<Context>,
    store: &Store,
    residency: &Residency,
    settings: &Settings,
) -> Result<Option<GradientVolume>> {
    let Some(estimator) = settings.stored_gradient() else {
        return Ok(None);
    };
    let others = other_texel_bytes(settings);
    let budget = settings.storage.budget_bytes();
    GradientVolume::new(context, NAME, store, residency, estimator, others, budget)
}

/// The gradients that samples read: those of voxels that are all there.
pub(super) fn read<'a>(
    gradients: Option<&'a GradientVolume>,
    uploads: &Uploads,
) -> Option<&'a GradientVolume> {
    gradients.filter(|_| uploads.bricks_complete())
}

impl Loaded {
    /// The gradients that samples read, if they do.
    pub(super) fn read_gradients(&self) -> Option<&GradientVolume> {
        read(self.gradients.as_ref(), &self.uploads)
    }

    /// Estimates the gradients that are seen for the first time.
    pub(super) fn record_gradients(
        &mut self,
        context: &Arc<Context>,
        recorder: &mut Recorder<'_>,
        volume: Uniforms,
    ) -> Result<()> {
        if self.read_gradients().is_none() {
            return Ok(());
        }
        let reconstruction = self.reconstruction(false);
        let reach = shading_reach(&self.store, &self.settings);
        let Self {
            gradients: Some(gradients),
            gradients_pass,
            images,
            residency,
            visibility,
            ..
        } = self
        else {
            return Ok(());
        };
        let chunks = gradients.next_chunks(residency, visibility, reach);
        if chunks.is_empty() {
            return Ok(());
        }
        let resources = GradientsResources {
            images,
            gradients,
            chunks: &chunks,
            volume,
        };
        recorder.pass(pass_name::GRADIENTS, |recorder| {
            gradients_pass.record(context, recorder, reconstruction, resources)
        })
    }
}
