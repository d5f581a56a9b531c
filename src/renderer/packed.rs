//! Packed corners of voxel cells: whether there are some, and what fills them.

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
    let gradient_bytes = gradients.map_or(0, GradientVolume::bytes);
    packing_beside(context, store, residency, settings, gradient_bytes)
}

/// The same beside so many bytes of gradients.
pub(super) fn packing_beside(
    context: &Context,
    store: &Store,
    residency: &Residency,
    settings: &Settings,
    gradient_bytes: u64,
) -> Option<Packing> {
    if !settings.storage.packed_cells || !settings.interpolates() {
        return None;
    }
    let texel_bytes = other_texel_bytes(settings);
    let budget = settings.storage.budget_bytes();
    Packing::of(
        context,
        store,
        residency,
        texel_bytes,
        gradient_bytes,
        budget,
    )
}

impl Loaded {
    /// Packs the corners of all cells once the bricks are complete: light and pictures of a complete volume read nothing else.
    pub(super) fn record_packed_cells(
        &mut self,
        context: &Arc<Context>,
        recorder: &mut Recorder<'_>,
    ) -> Result<()> {
        if !self.uploads.bricks_complete() {
            return Ok(());
        }
        let missing = self
            .images
            .packed_cells
            .as_mut()
            .map(PackedCells::take_missing);
        let Self {
            images,
            pack_cells_pass,
            ..
        } = self;
        match &images.packed_cells {
            Some(cells) if missing == Some(true) => recorder
                .pass(pass_name::PACK_CELLS, |recorder| {
                    pack_cells_pass.record(context, recorder, images, cells)
                }),
            _ => Ok(()),
        }
    }

    /// Bytes of what is computed from the voxels and kept beside them: packed corners, gradients.
    pub(crate) fn derived_bytes(&self) -> (u64, u64) {
        let cells = self
            .images
            .packed_cells
            .as_ref()
            .map_or(0, |c| c.texels.buffer().bytes());
        let gradients = self.gradients.as_ref().map_or(0, GradientVolume::bytes);
        (cells, gradients)
    }

    /// Bytes of the samples whose packed corners passes read instead of filtering; 0 for none.
    pub(super) fn packed_sample_bytes(&self) -> u32 {
        let cells = self.images.packed_cells.as_ref();
        cells
            .filter(|cells| cells.is_complete() && self.uploads.bricks_complete())
            .map_or(0, PackedCells::sample_bytes)
    }
}
