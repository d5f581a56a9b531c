//! Packed corners of voxel cells: whether there are some, and those that a frame adds.

use std::sync::Arc;

use super::loaded::{Loaded, other_texel_bytes};
use super::pass_name;
use super::settings::Settings;
use crate::atlas::{GradientVolume, PackedCells, Packing, Residency, Store};
use crate::error::Result;
use crate::gpu::{Context, Recorder};

/// How corners are to be packed, where something interpolates and there is room beside what else is kept.
pub(super) fn packing(
    context: &Context,
    store: &Store,
    residency: &Residency,
    settings: &Settings,
    gradients: Option<&GradientVolume>,
) -> Option<Packing> {
    let wanted = settings.storage.packed_cells && settings.interpolates();
    let others = other_texel_bytes(settings) + gradients.map_or(0, GradientVolume::texel_bytes);
    let budget = settings.storage.budget_bytes();
    wanted
        .then(|| Packing::of(context, store, residency, others, budget))
        .flatten()
}

impl Loaded {
    /// Packs corners of the cells that are on the device, of about `budget` bytes.
    pub(super) fn record_packed_cells(
        &mut self,
        context: &Arc<Context>,
        recorder: &mut Recorder<'_>,
        budget: usize,
    ) -> Result<()> {
        if !self.uploads.bricks_complete() {
            return Ok(());
        }
        let Some(mut cells) = self.images.cells.take_if(|cells| !cells.is_complete()) else {
            return Ok(());
        };
        let slices = cells.next_slices(budget);
        let Self {
            images,
            pack_cells_pass,
            ..
        } = self;
        let recorded = recorder.pass(pass_name::PACK_CELLS, |recorder| {
            pack_cells_pass.record(context, recorder, images, &cells, slices)
        });
        self.images.cells = Some(cells);
        recorded
    }

    /// Bytes of what is computed from the voxels and kept beside them: packed corners, gradients.
    pub(crate) fn derived_bytes(&self) -> (u64, u64) {
        let cells = self.images.cells.as_ref().map_or(0, |c| c.image.bytes());
        let gradients = self.gradients.as_ref().map_or(0, |g| g.image.bytes());
        (cells, gradients)
    }

    /// Bytes of the packed samples that passes may read instead of filtering; 0 for none.
    pub(super) fn packed_sample_bytes(&self) -> u32 {
        let cells = self.images.cells.as_ref();
        cells
            .filter(|cells| cells.is_complete() && self.uploads.bricks_complete())
            .map_or(0, PackedCells::sample_bytes)
    }
}
