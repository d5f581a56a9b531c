//! Ranges and histograms against brute force.

use umbravox::volume::Voxels;
use umbravox::volume::blocks::{BlockGrid, FINEST, LEVELS, Levels};
use umbravox::volume::statistics::{BINS, BlockStatistics, Histogram};

use super::{Field, Random, closed_range, random_f32, random_u8, volume_of};

/// Least and most that each bin may count of what trilinear interpolation of a brick yields at the
/// voxels of its closed block. They differ by the values that lie on the border of two bins, to the
/// rounding of f32.
fn brute_force(field: &Field, block: usize, [low, high]: [f64; 2]) -> [Histogram; 2] {
    let grid = &field.grid;
    let (origin, cells) = (grid.origin_ix(block), grid.cells(block));
    let [mut least, mut most] = [[0; BINS]; 2];
    for k in 0..=cells[2] {
        for j in 0..=cells[1] {
            for i in 0..=cells[0] {
                let at = [origin[0] + i, origin[1] + j, origin[2] + k].map(f64::from);
                let bin = (field.sample(block, at) - low) / (high - low) * (BINS - 1) as f64;
                let [below, above] = [bin - 1e-5, bin + 1e-5].map(|b| b.round() as usize);
                most[below] += 1;
                if below == above {
                    least[below] += 1;
                } else {
                    most[above] += 1;
                }
            }
        }
    }
    [least, most]
}

#[test]
fn histograms_and_ranges_match_brute_force() {
    let mut random = Random(40);
    for (size, signed) in [
        ([33, 33, 17], false),
        ([40, 18, 29], false),
        ([35, 20, 26], true),
    ] {
        let grid = BlockGrid::new(size).unwrap();
        // Primes as ranges keep values off the borders of bins.
        let volume = if signed {
            volume_of(size, Voxels::I16, |at| match at.map(|c| c % 16) {
                [1, 1, 1] => -400,
                [0, 1, 1] => 609,
                _ => random.below(1010) as i16 - 400,
            })
        } else {
            volume_of(size, Voxels::U8, |at| match at.map(|c| c % 16) {
                [1, 1, 1] => 0,
                [0, 1, 1] => 191,
                _ => random.below(192) as u8,
            })
        };
        let statistics = BlockStatistics::of(volume.clone().into()).unwrap();
        for level in 0..=FINEST {
            // A lone resident block has no neighbours that could change its border.
            for block in 0..grid.len() {
                let mut levels = Levels {
                    by_block: vec![None; grid.len()],
                };
                levels.by_block[block] = Some(level);
                let field = Field::new(&volume, &levels);
                let range = closed_range(&volume, &grid, block);
                assert_eq!(statistics.stored_range(block).map(f64::from), range);
                let got = &statistics.histograms(block).unwrap()[level as usize];
                let [least, most] = brute_force(&field, block, range);
                for bin in 0..BINS {
                    assert!(
                        (least[bin]..=most[bin]).contains(&got[bin]),
                        "level {level}, block {block}, bin {bin}: {} is not in {}..={}",
                        got[bin],
                        least[bin],
                        most[bin]
                    );
                }
                let total: u64 = got.iter().map(|&n| u64::from(n)).sum();
                assert_eq!(total, statistics.mass(block));
            }
        }
    }
}

#[test]
fn blocks_of_one_value_keep_no_histogram() {
    let volume = volume_of([33, 17, 17], Voxels::U8, |at| u8::from(at[0] > 20));
    let statistics = BlockStatistics::of(volume.clone().into()).unwrap();
    assert!(statistics.histograms(0).is_none());
    assert!(statistics.histograms(1).is_some());
    assert_eq!(statistics.stored_range(0), [0.0, 0.0]);
}

#[test]
fn extreme_floats_are_counted() {
    for scale in [f32::MAX, f32::MIN_POSITIVE * 1e-6] {
        let volume = volume_of([17, 17, 17], Voxels::F32, |at| match at[0] % 3 {
            0 => -scale,
            1 => 0.0,
            _ => scale,
        });
        let statistics = BlockStatistics::of(volume.clone().into()).unwrap();
        let finest = &statistics.histograms(0).unwrap()[usize::from(FINEST)];
        assert_eq!(finest[0], 6 * 289, "scale {scale}");
        assert_eq!(finest[BINS - 1], 5 * 289, "scale {scale}");
    }
}

#[test]
fn histograms_are_counted_when_asked_for() {
    let mut random = Random(41);
    let size = [129, 113, 97];
    let voxels: f64 = size.iter().map(|&n| f64::from(n)).product();
    for volume in [random_u8(size, &mut random), random_f32(size, &mut random)] {
        let statistics = BlockStatistics::of(volume.into()).unwrap();
        let blocks = statistics.grid().len();
        let before = statistics.heap_bytes() as f64;
        assert!(before <= 0.14 * voxels, "{} per voxel", before / voxels);
        for block in 0..blocks {
            assert!(statistics.histograms(block).is_some());
        }
        let after = statistics.heap_bytes() as f64;
        let histograms = size_of::<[Histogram; LEVELS]>() * blocks;
        assert_eq!(after, before + histograms as f64);
        assert!(after <= 0.31 * voxels, "{} per voxel", after / voxels);
    }
}
