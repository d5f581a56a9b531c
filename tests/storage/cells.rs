//! Skip cells and distances.

use umbravox::volume::blocks::{BlockGrid, FINEST, Levels};
use umbravox::volume::bricks::BrickBuilder;
use umbravox::volume::cells::CellGrid;
use umbravox::volume::statistics::BlockStatistics;
use umbravox::volume::{Rescale, Volume, Voxels};

use super::{Field, Random, positions, random_f32, random_u8, sample_volume, volume_of};

fn linear(counts: [u32; 3], cell: [u32; 3]) -> usize {
    (cell[0] + counts[0] * (cell[1] + counts[1] * cell[2])) as usize
}

fn cell_grid(builder: &BrickBuilder, volume: &Volume) -> CellGrid {
    let statistics = BlockStatistics::of(volume.clone().into()).unwrap();
    CellGrid::new(builder, &statistics)
}

#[test]
fn ranges_bound_every_sample() {
    let mut random = Random(20);
    for size in [[49, 33, 49], [40, 27, 22], [2, 9, 19]] {
        let grid = BlockGrid::new(size).unwrap();
        let volume = random_f32(size, &mut random);
        for _ in 0..6 {
            let levels = random.levels(&grid, 5);
            let builder = BrickBuilder::new(&volume, &grid, &levels).unwrap();
            let cells = cell_grid(&builder, &volume);
            let field = Field::new(&volume, &levels);
            for (block, level) in field.resident() {
                for at in positions(&grid, block, 21) {
                    // All closed skip cells of this block that hold the position.
                    let value = field.sample(block, at);
                    for corner in 0..8 {
                        let cell = std::array::from_fn(|a| {
                            let first = grid.origin_ix(block)[a];
                            let end = first + grid.cells(block)[a];
                            let low = ((at[a] / 4.0).ceil() as u32).max(1) - 1;
                            let high = (at[a] / 4.0).floor() as u32;
                            let cell = if corner >> a & 1 == 1 { high } else { low };
                            cell.clamp(first / 4, (end - 1) / 4)
                        });
                        let [low, high] = cells
                            .stored_range(linear(cells.counts(), cell))
                            .unwrap()
                            .map(f64::from);
                        assert!(
                            (low - 1e-12..=high + 1e-12).contains(&value),
                            "{value} at {at:?}, level {level}, outside {low}..{high}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn ranges_of_the_finest_level_are_exact() {
    let size = [37, 20, 18];
    let mut random = Random(21);
    let signed = volume_of(size, Voxels::I16, |_| random.below(2000) as i16 - 1000);
    for volume in [random_u8(size, &mut Random(21)), signed] {
        let grid = BlockGrid::new(size).unwrap();
        let levels = Levels::uniform(&grid, FINEST);
        let builder = BrickBuilder::new(&volume, &grid, &levels).unwrap();
        let rescale = Rescale {
            slope: -2.0,
            intercept: 10.0,
        };
        let voxels = volume.voxels().clone();
        let rescaled = Volume::new(voxels, size, volume.world_from_ix(), rescale).unwrap();
        let cells = cell_grid(&builder, &rescaled);
        assert_eq!(cells.counts(), [9, 5, 5]);
        for (k, j, i) in
            (0..5).flat_map(|k| (0..5).flat_map(move |j| (0..9).map(move |i| (k, j, i))))
        {
            let mut range = [f64::INFINITY, f64::NEG_INFINITY];
            for z in 4 * k..=(4 * k + 4).min(size[2] - 1) {
                for y in 4 * j..=(4 * j + 4).min(size[1] - 1) {
                    for x in 4 * i..=(4 * i + 4).min(size[0] - 1) {
                        let v = sample_volume(&volume, [x, y, z].map(f64::from));
                        range = [range[0].min(v), range[1].max(v)];
                    }
                }
            }
            let cell = linear(cells.counts(), [i, j, k]);
            assert_eq!(cells.stored_range(cell).unwrap().map(f64::from), range);
            assert_eq!(
                cells.value_range(cell).unwrap(),
                [10.0 - 2.0 * range[1], 10.0 - 2.0 * range[0]]
            );
        }
    }
}

#[test]
fn occupancy_follows_residency_and_visibility() {
    let mut random = Random(22);
    let size = [50, 40, 30];
    let volume = random_f32(size, &mut random);
    let grid = BlockGrid::new(size).unwrap();
    let levels = random.levels(&grid, 2);
    let builder = BrickBuilder::new(&volume, &grid, &levels).unwrap();
    let cells = cell_grid(&builder, &volume);
    let all = cells.occupancy(|_| true);
    let some = cells.occupancy(|range| range[1] > 0.97);
    let counts = cells.counts();
    let mut kinds = [0; 3];
    for k in 0..counts[2] {
        for j in 0..counts[1] {
            for i in 0..counts[0] {
                let cell = linear(counts, [i, j, k]);
                let block = grid.index([i / 4, j / 4, k / 4]);
                let resident = levels.by_block[block].is_some();
                assert_eq!(cells.stored_range(cell).is_some(), resident);
                assert_eq!(all[cell], u8::from(resident));
                let bright = cells.stored_range(cell).is_some_and(|r| r[1] > 0.97);
                assert_eq!(some[cell], u8::from(bright));
                kinds[usize::from(resident) + usize::from(bright)] += 1;
            }
        }
    }
    assert!(
        kinds.iter().all(|&n| n > 0),
        "not all kinds occur: {kinds:?}"
    );
}
