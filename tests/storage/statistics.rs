//! Ranges and histograms against brute force.

use umbravox::volume::Voxels;
use umbravox::volume::blocks::{BlockGrid, FINEST, LEVELS, Levels};
use umbravox::volume::statistics::{BINS, BlockStatistics, Histogram};

use super::{Field, Random, closed_range, random_f32, random_u8, volume_of};

/// Histogram of what trilinear interpolation of a brick yields at the voxels of its closed block.
fn brute_force(field: &Field, block: usize, [low, high]: [f64; 2]) -> Histogram {
    let grid = &field.grid;
    let (origin, cells) = (grid.origin_ix(block), grid.cells(block));
    let mut histogram = [0; BINS];
    for k in 0..=cells[2] {
        for j in 0..=cells[1] {
            for i in 0..=cells[0] {
                let at = [origin[0] + i, origin[1] + j, origin[2] + k].map(f64::from);
                let bin = (field.sample(block, at) - low) / (high - low) * (BINS - 1) as f64;
                histogram[bin.round() as usize] += 1;
            }
        }
    }
    histogram
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
        let volume = if signed {
            volume_of(size, Voxels::I16, |at| {
                at[0] as i16 * 40 - at[2] as i16 * 31 + random.below(200) as i16
            })
        } else {
            // With a range of 191 no bin border meets a value, so counts are exact.
            volume_of(size, Voxels::U8, |at| match at.map(|c| c % 16) {
                [1, 1, 1] => 0,
                [1, 2, 1] => 191,
                _ => random.below(192) as u8,
            })
        };
        let statistics = BlockStatistics::of(&volume).unwrap();
        for level in 0..=FINEST {
            // A lone resident block has no neighbours that could change its border.
            for block in 0..grid.len() {
                let mut levels = Levels {
                    by_block: vec![None; grid.len()],
                };
                levels.by_block[block] = Some(level);
                let field = Field::new(&volume, &levels);
                let range = closed_range(&volume, &grid, block);
                assert_eq!(statistics.stored_range(block, FINEST).map(f64::from), range);
                let n = grid.intervals(block, level).map(|n| n as usize);
                let samples = (0..=n[2])
                    .flat_map(|k| (0..=n[1]).flat_map(move |j| (0..=n[0]).map(move |i| [i, j, k])));
                let coarse = samples
                    .map(|at| field.texel(block, at))
                    .fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], v| {
                        [low.min(v), high.max(v)]
                    });
                assert_eq!(statistics.stored_range(block, level), coarse);
                let got = &statistics.histograms(block).unwrap()[level as usize];
                let expected = brute_force(&field, block, range);
                let total: u64 = got.iter().map(|&n| u64::from(n)).sum();
                assert_eq!(total, statistics.mass(block));
                let moved: u32 = got
                    .iter()
                    .zip(&expected)
                    .map(|(a, b)| u32::from(a.abs_diff(*b)))
                    .sum();
                // Two for each value that f32 puts on the other side of the border between two bins.
                assert!(
                    moved <= 4,
                    "level {level}, block {block}: {moved} counts differ"
                );
            }
        }
    }
}

#[test]
fn blocks_of_one_value_keep_no_histogram() {
    let volume = volume_of([33, 17, 17], Voxels::U8, |at| u8::from(at[0] > 20));
    let statistics = BlockStatistics::of(&volume).unwrap();
    assert!(statistics.histograms(0).is_none());
    assert!(statistics.histograms(1).is_some());
    for level in 0..=FINEST {
        assert_eq!(statistics.stored_range(0, level), [0.0, 0.0]);
    }
}

#[test]
fn extreme_floats_are_counted() {
    for scale in [f32::MAX, f32::MIN_POSITIVE * 1e-6] {
        let volume = volume_of([17, 17, 17], Voxels::F32, |at| match at[0] % 3 {
            0 => -scale,
            1 => 0.0,
            _ => scale,
        });
        let statistics = BlockStatistics::of(&volume).unwrap();
        let finest = &statistics.histograms(0).unwrap()[usize::from(FINEST)];
        assert_eq!(finest[0], 6 * 289, "scale {scale}");
        assert_eq!(finest[BINS - 1], 5 * 289, "scale {scale}");
    }
}

#[test]
fn memory_stays_below_a_fifth_of_a_byte_per_voxel() {
    let mut random = Random(41);
    let size = [129, 113, 97];
    let voxels: f64 = size.iter().map(|&n| f64::from(n)).product();
    for volume in [random_u8(size, &mut random), random_f32(size, &mut random)] {
        let statistics = BlockStatistics::of(&volume).unwrap();
        let bytes = statistics.heap_bytes() as f64;
        let histograms = size_of::<[Histogram; LEVELS]>() * statistics.grid().len();
        assert!(bytes > histograms as f64);
        assert!(bytes <= 0.2 * voxels, "{} per voxel", bytes / voxels);
    }
}
