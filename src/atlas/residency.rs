//! Which bricks are on the device, at which level and where.

use std::sync::Arc;

use crate::error::Result;
use crate::scene;
use crate::volume::Volume;
use crate::volume::blocks::BlockGrid;
use crate::volume::bricks::BrickBuilder;
use crate::volume::cells::CellGrid;
use crate::volume::layout::AtlasLayout;
use crate::volume::select::{Request, Selection, select};
use crate::volume::statistics::BlockStatistics;

use super::Shown;

/// A volume and the statistics of its blocks; made once for each volume.
pub(crate) struct Store {
    pub(crate) volume: Arc<Volume>,
    pub(crate) statistics: BlockStatistics,
}

impl Store {
    pub(crate) fn new(volume: Arc<Volume>) -> Result<Self> {
        let statistics = BlockStatistics::of(volume.clone())?;
        Ok(Self { volume, statistics })
    }

    pub(crate) fn grid(&self) -> &BlockGrid {
        self.statistics.grid()
    }
}

/// A choice of levels with the atlas layout and the value ranges of skip cells that follow from it.
pub(crate) struct Residency {
    pub(crate) selection: Selection,
    pub(crate) layout: AtlasLayout,
    pub(crate) cells: CellGrid,
}

impl Residency {
    /// Chooses levels for what is shown; a texel has `other_texel_bytes` beside its value.
    pub(crate) fn select(
        store: &Store,
        shown: &Shown<'_>,
        storage: &scene::Storage,
        other_texel_bytes: u32,
    ) -> Result<Selection> {
        let voxel_bytes = store.volume.voxels().voxel_type().bytes() as u32;
        select(
            &store.statistics,
            shown,
            &Request {
                data_reduction: storage.data_reduction,
                max_bytes: storage.budget_bytes(),
                bytes_per_texel: voxel_bytes + other_texel_bytes,
            },
        )
    }

    /// Says where there was no room for what was asked for.
    pub(crate) fn warn_of_coarser(&self, storage: &scene::Storage) {
        let selection = &self.selection;
        // Asked for everything at the finest level.
        if storage.data_reduction == 1.0 && selection.error > 0.0 {
            tracing::warn!(
                "storage.memory_budget_mib: {} MiB hold one of {:.1} voxels; what shows is drawn coarser{}",
                storage.memory_budget_mib,
                selection.data_reduction,
                match selection.dropped {
                    0 => String::new(),
                    dropped => format!(", {dropped} blocks of it not at all"),
                }
            );
        }
    }

    /// Lays out the bricks of a selection.
    pub(crate) fn new(store: &Store, selection: Selection, max_extent_3d: u32) -> Result<Self> {
        let layout = AtlasLayout::plan(store.grid(), &selection.levels, max_extent_3d)?;
        let cells = {
            let bricks = BrickBuilder::new(&store.volume, store.grid(), &selection.levels)?;
            CellGrid::new(&bricks, &store.statistics)
        };
        Ok(Self {
            selection,
            layout,
            cells,
        })
    }
}
