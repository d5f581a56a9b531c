//! What the transfer function shows of the resident bricks.

use crate::volume::cells::chessboard_distance;
use crate::volume::select::Classify as _;

use super::TransferTable;
use super::light_work::LightWork;
use super::residency::{Residency, Store};

/// Skip distances, and the samples of the light volume that can be seen.
pub(crate) struct Visibility {
    /// By skip cell: 0 where something shows, else the chessboard distance to the nearest such cell.
    pub(crate) distances: Vec<u8>,
    pub(crate) light: LightWork,
}

impl Visibility {
    pub(crate) fn new(store: &Store, residency: &Residency, table: &TransferTable) -> Self {
        let counts = residency.cells.counts();
        let occupancy = residency.cells.occupancy(|range| table.visible(range));
        let light = LightWork::new(store.grid(), residency, counts, &occupancy);
        let distances = chessboard_distance(counts, &occupancy);
        Self { distances, light }
    }
}
