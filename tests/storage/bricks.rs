//! The texels of bricks: filtering, packing, types.

use umbravox::volume::blocks::{BlockGrid, FINEST, Levels, brick_extent, brick_texels};
use umbravox::volume::bricks::BrickBuilder;
use umbravox::volume::{Volume, Voxels};

use super::{Field, Random, random_f32, random_u8, volume_of};

/// A coarse sample of a full block, straight from the definition.
fn tent_filtered(volume: &Volume, origin: [u32; 3], level: u8, sample: [u32; 3]) -> f64 {
    let half = 16 >> level;
    let weights = |i: u32| -> Vec<(u32, f64)> {
        let center = (i * half) as i32;
        if i == 0 || i == 1 << level {
            return vec![(center as u32, 1.0)];
        }
        (0..=16)
            .map(|x: i32| {
                let w = (half as i32 - (x - center).abs()).max(0);
                (x as u32, f64::from(w) / f64::from(half * half))
            })
            .collect()
    };
    let mut sum = 0.0;
    for (z, wz) in weights(sample[2]) {
        for (y, wy) in weights(sample[1]) {
            for (x, wx) in weights(sample[0]) {
                let at = volume.offset(origin[0] + x, origin[1] + y, origin[2] + z);
                sum += wx * wy * wz * volume.voxels().get(at);
            }
        }
    }
    sum
}

#[test]
fn coarse_samples_are_tent_filtered_inside_their_block() {
    let mut random = Random(10);
    let size = [33, 17, 33];
    let grid = BlockGrid::new(size).unwrap();
    for (volume, tolerance) in [
        (random_f32(size, &mut random), f64::from(f32::EPSILON)),
        (random_u8(size, &mut random), 0.5),
    ] {
        for level in 0..FINEST {
            let field = Field::new(&volume, &Levels::uniform(&grid, level));
            let side = brick_extent(level);
            for block in 0..grid.len() {
                for i in 0..side.pow(3) {
                    let sample = [i % side, i / side % side, i / side.pow(2)];
                    let expected = tent_filtered(&volume, grid.origin_ix(block), level, sample);
                    let got = f64::from(field.texel(block, sample.map(|s| s as usize)));
                    assert!(
                        (got - expected).abs() <= tolerance,
                        "{got} for {expected}, level {level}, sample {sample:?}"
                    );
                }
            }
        }
    }
}

/// Decodes texel bytes to stored voxels.
fn decode(volume: &Volume, bytes: &[u8]) -> Vec<f32> {
    let wide = |b: &[u8]| f32::from(u16::from_ne_bytes([b[0], b[1]]));
    match volume.voxels() {
        Voxels::U8(_) => bytes.iter().map(|&b| b.into()).collect(),
        Voxels::I8(_) => bytes.iter().map(|&b| f32::from(b) - 128.0).collect(),
        Voxels::U16(_) => bytes.chunks(2).map(wide).collect(),
        Voxels::I16(_) => bytes.chunks(2).map(|b| wide(b) - 32768.0).collect(),
        Voxels::F32(_) => bytes
            .chunks(4)
            .map(|b| f32::from_ne_bytes([b[0], b[1], b[2], b[3]]))
            .collect(),
    }
}

#[test]
fn bytes_written_are_the_samples_at_any_alignment() {
    let mut random = Random(11);
    let size = [36, 20, 33];
    let grid = BlockGrid::new(size).unwrap();
    let volumes = [
        random_u8(size, &mut random),
        volume_of(size, Voxels::I8, |_| random.next() as i8),
        volume_of(size, Voxels::U16, |_| random.next() as u16),
        volume_of(size, Voxels::I16, |_| random.next() as i16),
        random_f32(size, &mut random),
    ];
    for volume in &volumes {
        for levels in [Levels::uniform(&grid, FINEST), random.levels(&grid, 5)] {
            let builder = BrickBuilder::new(volume, &grid, &levels).unwrap();
            for (block, level) in levels.by_block.iter().enumerate() {
                let texels = level.map_or(0, brick_texels);
                assert_eq!(
                    builder.bytes(block),
                    texels * volume.voxels().voxel_type().bytes()
                );
                assert_eq!(builder.extent(block), level.map_or(0, brick_extent));
                let mut samples = vec![f32::NAN; texels];
                builder.stored(block, &mut samples);
                let mut bytes = vec![0xaa; builder.bytes(block) + 2];
                builder.write(block, &mut bytes[1..]);
                assert_eq!(decode(volume, &bytes[1..=builder.bytes(block)]), samples);
                assert_eq!(
                    bytes[builder.bytes(block) + 1],
                    0xaa,
                    "wrote beyond the brick"
                );
            }
        }
    }
}

#[test]
fn texels_beyond_a_partial_block_repeat_its_last_voxels() {
    let mut random = Random(12);
    let size = [36, 20, 23];
    let grid = BlockGrid::new(size).unwrap();
    let volume = random_f32(size, &mut random);
    let mut mixed = Levels::uniform(&grid, FINEST);
    mixed.by_block[0] = Some(1);
    for levels in [Levels::uniform(&grid, FINEST), mixed] {
        let field = Field::new(&volume, &levels);
        let last = grid.len() - 1;
        let m = grid.cells(last).map(|m| m as usize);
        assert_eq!(m, [3, 3, 6]);
        for i in 0..17usize.pow(3) {
            let at = [i % 17, i / 17 % 17, i / 289];
            let inside = std::array::from_fn(|a| at[a].min(m[a]));
            assert_eq!(field.texel(last, at), field.texel(last, inside));
        }
    }
}
