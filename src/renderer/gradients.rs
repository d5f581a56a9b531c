//! Stored gradients: whether there are some, and those that a frame adds.

use std::sync::Arc;

use super::loaded::{Loaded, NAME, other_texel_bytes, shading_reach, shown};
use super::packed::packing_beside;
use super::pass_name;
use super::settings::Settings;
use crate::atlas::{GradientVolume, Residency, Store, Uploads};
use crate::error::Result;
use crate::gpu::{Context, Recorder, Uniforms};
use crate::pass::gradients::GradientsResources;
use crate::volume::cells::SKIP_CELLS;
use crate::volume::select::Classify;

/// Skip cells of which voxels are looked at, at most about.
const CELLS_LOOKED_AT: usize = 1024;

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
    // Packed corners save more than texels that are read faster.
    let packs = |bytes| packing_beside(context, store, residency, settings, bytes).is_some();
    let prefers = |more, less| packs(more) || !packs(less);
    GradientVolume::new(
        context, NAME, store, residency, estimator, others, budget, prefers,
    )
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

    /// The share of voxels that show something, of those in skip cells where anything does, estimated from some of them.
    pub(super) fn share_shown(&self) -> f64 {
        let volume = &self.store.volume;
        let shown = shown(&self.table, &self.settings);
        let [width, height, _] = self.residency.cells.counts().map(|n| n as usize);
        let step = self.visibility.visible_cells().count() / CELLS_LOOKED_AT + 1;
        let (mut found, mut all) = (0u32, 0u32);
        for cell in self.visibility.visible_cells().step_by(step) {
            let at = [cell % width, cell / width % height, cell / (width * height)];
            for corner in 0..8 {
                let [x, y, z] = [0, 1, 2].map(|axis| {
                    let within = 1 + 2 * (corner >> axis & 1);
                    (SKIP_CELLS * at[axis] as u32 + within).min(volume.size()[axis] - 1)
                });
                let value = volume.value(x, y, z);
                found += u32::from(shown.visible([value, value]));
                all += 1;
            }
        }
        f64::from(found) / f64::from(all.max(1))
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
