//! What the transfer function shows of the resident bricks.

use crate::volume::blocks::{BLOCK_CELLS, BlockGrid};
use crate::volume::cells::{MAX_DISTANCE, SKIP_CELLS, chessboard_distance};
use crate::volume::select::Classify as _;

use super::TransferTable;
use super::light_work::LightWork;
use super::residency::{Residency, Store};

/// Skip distances, and the samples of the light volume that can be seen.
pub(crate) struct Visibility {
    /// By skip cell: 0 where something shows, else the chessboard distance to the nearest such cell; 255 for a 0 whose
    /// whole block is 0, so that rays cross it in one run.
    pub(crate) distances: Vec<u8>,
    pub(crate) light: LightWork,
}

impl Visibility {
    /// `lit`: light is wanted.
    pub(crate) fn new(
        store: &Store,
        residency: &Residency,
        table: &TransferTable,
        lit: bool,
    ) -> Self {
        let counts = residency.cells.counts();
        let occupancy = residency.cells.occupancy(|range| table.visible(range));
        let light = if lit {
            LightWork::new(store.grid(), residency, counts, &occupancy)
        } else {
            LightWork::default()
        };
        let mut distances = chessboard_distance(counts, &occupancy);
        mark_whole_blocks(store.grid(), counts, &mut distances);
        Self { distances, light }
    }
}

/// The shaders' `WHOLE_BLOCK`; distances end below it.
const WHOLE_BLOCK: u8 = 255;
const _: () = assert!(MAX_DISTANCE < WHOLE_BLOCK);

/// Marks the cells of blocks of which every cell shows something.
fn mark_whole_blocks(grid: &BlockGrid, counts: [u32; 3], distances: &mut [u8]) {
    let [width, height, _] = counts.map(|n| n as usize);
    let per_block = BLOCK_CELLS / SKIP_CELLS;
    for block in 0..grid.len() {
        let ranges: [std::ops::Range<usize>; 3] = std::array::from_fn(|a| {
            let first = grid.position(block)[a] * per_block;
            first as usize..(first + per_block).min(counts[a]) as usize
        });
        let [x, y, z] = ranges;
        let rows: Vec<usize> = z
            .flat_map(|z| y.clone().map(move |y| width * (y + height * z)))
            .collect();
        let whole = rows
            .iter()
            .all(|r| distances[r + x.start..r + x.end].iter().all(|&d| d == 0));
        if whole {
            for r in rows {
                distances[r + x.start..r + x.end].fill(WHOLE_BLOCK);
            }
        }
    }
}
