//! Sampling across block borders and level changes.

use umbravox::volume::blocks::{BlockGrid, FINEST, Levels};
use umbravox::volume::{Volume, Voxels};

use super::{
    Field, Random, closed_range, neighbor_steps, positions, random_f32, random_u8, sample_volume,
    volume_of,
};

#[test]
fn linear_ramps_are_reproduced_at_any_levels() {
    let mut random = Random(1);
    for size in [[49, 33, 49], [40, 50, 21], [18, 2, 37]] {
        for slope in [
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 1.0],
            [0.5, -2.0, 0.25],
        ] {
            let ramp = |at: [f64; 3]| -> f64 { (0..3).map(|a| slope[a] * at[a]).sum() };
            let volume = volume_of(size, Voxels::F32, |at| ramp(at.map(f64::from)) as f32);
            let grid = BlockGrid::new(size).unwrap();
            let largest = volume
                .stored_range()
                .map(f64::abs)
                .into_iter()
                .fold(0.0, f64::max);
            for _ in 0..8 {
                let levels = random.levels(&grid, 6);
                let field = Field::new(&volume, &levels);
                for (block, level) in field.resident() {
                    for at in positions(&grid, block, 14) {
                        let error = (field.sample(block, at) - ramp(at)).abs();
                        assert!(
                            error <= f64::from(f32::EPSILON) * largest,
                            "{error} at {at:?}, level {level}, size {size:?}, slope {slope:?}"
                        );
                    }
                }
            }
        }
    }
}

/// Largest difference between two resident blocks over the positions that they share.
fn largest_step(field: &Field, random: &mut Random) -> f64 {
    let grid = &field.grid;
    let mut largest: f64 = 0.0;
    for (block, _) in field.resident() {
        for step in neighbor_steps() {
            let Some(other) = grid.neighbor(block, step) else {
                continue;
            };
            if field.levels.by_block[other].is_none() {
                continue;
            }
            for _ in 0..60 {
                let at: [f64; 3] = std::array::from_fn(|a| {
                    let first = f64::from(grid.origin_ix(block)[a]);
                    let cells = f64::from(grid.cells(block)[a]);
                    match step[a] {
                        0 if random.below(2) == 0 => first + cells * random.unit(),
                        0 => first + random.below(cells as u64 + 1) as f64,
                        1 => first + cells,
                        _ => first,
                    }
                });
                largest = largest.max((field.sample(block, at) - field.sample(other, at)).abs());
            }
        }
    }
    largest
}

#[test]
fn fields_are_continuous_across_levels() {
    let mut random = Random(2);
    let size = [49, 65, 49];
    let grid = BlockGrid::new(size).unwrap();
    let float = random_f32(size, &mut random);
    let byte = random_u8(size, &mut random);
    for _ in 0..12 {
        let levels = random.levels(&grid, 8);
        let step = largest_step(&Field::new(&float, &levels), &mut random);
        assert!(
            step <= 2.0 * f64::from(f32::EPSILON),
            "step of {step} in f32"
        );
        // Both sides of an edge are rounded on their own, half a unit each.
        let step = largest_step(&Field::new(&byte, &levels), &mut random);
        assert!(step <= 1.0, "step of {step} in u8");
    }
}

#[test]
fn fields_of_partial_blocks_are_continuous_below_the_finest_level() {
    let mut random = Random(3);
    let size = [40, 27, 52];
    let grid = BlockGrid::new(size).unwrap();
    let volume = random_f32(size, &mut random);
    for _ in 0..12 {
        let mut levels = random.levels(&grid, 8);
        for level in levels.by_block.iter_mut().flatten() {
            *level = (*level).min(FINEST - 1);
        }
        let step = largest_step(&Field::new(&volume, &levels), &mut random);
        assert!(step <= 2.0 * f64::from(f32::EPSILON), "step of {step}");
    }
}

#[test]
fn neighbours_of_equal_level_share_their_samples() {
    let mut random = Random(4);
    let size = [40, 33, 23];
    let grid = BlockGrid::new(size).unwrap();
    let volumes = [
        random_f32(size, &mut random),
        volume_of(size, Voxels::I16, |_| random.next() as i16),
        random_u8(size, &mut random),
    ];
    for volume in &volumes {
        for level in 0..=FINEST {
            let field = Field::new(volume, &Levels::uniform(&grid, level));
            for block in 0..grid.len() {
                for axis in 0..3 {
                    let step = std::array::from_fn(|a| i32::from(a == axis));
                    let Some(other) = grid.neighbor(block, step) else {
                        continue;
                    };
                    let n = grid.intervals(block, level).map(|n| n as usize);
                    let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
                    for (i, j) in (0..=n[u]).flat_map(|i| (0..=n[v]).map(move |j| (i, j))) {
                        let mut here = [0; 3];
                        (here[u], here[v]) = (i, j);
                        let there = here;
                        here[axis] = n[axis];
                        assert_eq!(
                            field.texel(block, here).to_bits(),
                            field.texel(other, there).to_bits(),
                            "level {level}, axis {axis}, sample {here:?}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn the_finest_level_is_the_volume() {
    let mut random = Random(5);
    let size = [35, 18, 20];
    let grid = BlockGrid::new(size).unwrap();
    let volumes: [Volume; 5] = [
        random_u8(size, &mut random),
        volume_of(size, Voxels::I8, |_| random.next() as i8),
        volume_of(size, Voxels::U16, |_| random.next() as u16),
        volume_of(size, Voxels::I16, |_| random.next() as i16),
        random_f32(size, &mut random),
    ];
    for volume in &volumes {
        let field = Field::new(volume, &Levels::uniform(&grid, FINEST));
        for block in 0..grid.len() {
            for at in positions(&grid, block, 12) {
                let (bricked, plain) = (field.sample(block, at), sample_volume(volume, at));
                let scale = volume
                    .stored_range()
                    .map(f64::abs)
                    .into_iter()
                    .fold(0.0, f64::max);
                assert!(
                    (bricked - plain).abs() <= 1e-12 * scale,
                    "{bricked} for {plain} at {at:?}"
                );
            }
        }
    }
}

#[test]
fn samples_stay_within_every_block_that_contains_them() {
    let mut random = Random(6);
    for size in [[49, 49, 33], [38, 29, 43]] {
        let grid = BlockGrid::new(size).unwrap();
        // Blocks of very different ranges: any leak between them would show.
        let volume = volume_of(size, Voxels::F32, |at| {
            let block = grid.block_of_cell(std::array::from_fn(|a| at[a].min(size[a] - 2)));
            (block % 3) as f32 * 100.0 + random.unit() as f32
        });
        let ranges: Vec<_> = (0..grid.len())
            .map(|b| closed_range(&volume, &grid, b))
            .collect();
        for _ in 0..6 {
            let field = Field::new(&volume, &random.levels(&grid, 5));
            for (block, level) in field.resident() {
                for step in neighbor_steps() {
                    let Some(other) = grid.neighbor(block, step) else {
                        continue;
                    };
                    for at in positions(&grid, block, 11) {
                        let (first, m) = (grid.origin_ix(other), grid.cells(other));
                        let shared = (0..3).all(|a| {
                            (f64::from(first[a])..=f64::from(first[a] + m[a])).contains(&at[a])
                        });
                        let v = field.sample(block, at);
                        let [low, high] = ranges[other];
                        assert!(
                            !shared || (low - 1e-9..=high + 1e-9).contains(&v),
                            "{v} at {at:?}, level {level}, outside {low}..{high} of a neighbour"
                        );
                    }
                }
            }
        }
    }
}
