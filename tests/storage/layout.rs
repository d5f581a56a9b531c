//! Packing of the atlas.

use umbravox::Error;
use umbravox::volume::blocks::{BlockGrid, FINEST, Levels, brick_extent, brick_texels};
use umbravox::volume::layout::AtlasLayout;

use super::Random;

/// Fails when two bricks overlap or one leaves the atlas.
fn assert_disjoint(layout: &AtlasLayout, levels: &Levels) {
    let [w, h, d] = layout.extent().map(|n| n as usize);
    let mut taken = vec![false; w * h * d];
    for (block, level) in levels.by_block.iter().enumerate() {
        let origin = layout.origins()[block];
        assert_eq!(origin.is_some(), level.is_some(), "block {block}");
        let Some(origin) = origin.map(|o| o.map(|c| c as usize)) else {
            assert_eq!(layout.copy_extent(block), [0; 3]);
            continue;
        };
        let extent = layout.copy_extent(block).map(|n| n as usize);
        for z in origin[2]..origin[2] + extent[2] {
            for y in origin[1]..origin[1] + extent[1] {
                for x in origin[0]..origin[0] + extent[0] {
                    assert!(x < w && y < h && z < d, "block {block} leaves the atlas");
                    let at = x + w * (y + h * z);
                    assert!(
                        !std::mem::replace(&mut taken[at], true),
                        "{x} {y} {z} is taken twice"
                    );
                }
            }
        }
    }
}

fn used(levels: &Levels) -> f64 {
    let resident = levels.by_block.iter().flatten();
    resident.map(|&l| brick_texels(l) as f64).sum()
}

#[test]
fn finest_bricks_lie_as_their_blocks() {
    for size in [[256, 256, 256], [2, 17, 40]] {
        let grid = BlockGrid::new(size).unwrap();
        let levels = Levels::uniform(&grid, FINEST);
        let layout = AtlasLayout::plan(&grid, &levels, 2048).unwrap();
        assert_disjoint(&layout, &levels);
        for block in 0..grid.len() {
            assert_eq!(
                layout.origins()[block],
                Some(grid.position(block).map(|b| 16 * b))
            );
        }
        let voxels: f64 = size.iter().map(|&n| f64::from(n)).product();
        assert_eq!(layout.texels() as f64, voxels, "the atlas is the volume");
        let copied: u64 = (0..grid.len())
            .map(|block| {
                layout
                    .copy_extent(block)
                    .map(u64::from)
                    .iter()
                    .product::<u64>()
            })
            .sum();
        assert_eq!(copied as f64, voxels, "every voxel is copied once");
    }
}

#[test]
fn bricks_of_all_levels_pack_tightly() {
    let mut random = Random(30);
    for round in 0..40 {
        let n = 129 + random.below(180) as u32;
        let grid = BlockGrid::new([n, n, 145]).unwrap();
        // Some levels frequent, some rare, to meet lopsided mixes.
        let share: [f64; 5] = std::array::from_fn(|_| random.unit().powi(1 + round % 8));
        let total: f64 = share.iter().sum();
        let levels = Levels {
            by_block: (0..grid.len())
                .map(|_| {
                    let mut pick = random.unit() * total * 1.02;
                    (0..5u8).find(|&l| {
                        pick -= share[usize::from(l)];
                        pick < 0.0
                    })
                })
                .collect(),
        };
        assert!(levels.resident() >= 500);
        let layout = AtlasLayout::plan(&grid, &levels, 2048).unwrap();
        assert_disjoint(&layout, &levels);
        let ratio = layout.texels() as f64 / used(&levels);
        assert!(ratio <= 1.1, "{ratio} for {:?}", levels.count_by_level());
        let extent = layout.extent();
        let [low, high] = [extent.iter().min(), extent.iter().max()].map(Option::unwrap);
        assert!(*high <= 3 * low, "{extent:?}");
    }
}

#[test]
fn few_bricks_and_none_have_a_place() {
    let grid = BlockGrid::new([40, 40, 40]).unwrap();
    for bricks in 0..5 {
        let mut levels = Levels {
            by_block: vec![None; grid.len()],
        };
        for level in 0..bricks {
            levels.by_block[level + 3] = Some(level as u8);
        }
        let layout = AtlasLayout::plan(&grid, &levels, 64).unwrap();
        assert_disjoint(&layout, &levels);
        assert!(layout.extent().iter().all(|&n| n >= 1));
    }
}

#[test]
fn a_small_limit_is_kept_or_refused() {
    let grid = BlockGrid::new([400, 33, 33]).unwrap();
    let levels = Levels::uniform(&grid, FINEST);
    // 100 bricks: 425 texels in a row do not fit, 5 x 5 x 4 bricks do.
    let layout = AtlasLayout::plan(&grid, &levels, 90).unwrap();
    assert!(layout.extent().iter().all(|&n| n <= 90));
    assert_disjoint(&layout, &levels);
    for block in 0..grid.len() {
        assert_eq!(layout.copy_extent(block), [brick_extent(FINEST); 3]);
    }
    for limit in [16, 60] {
        let error = AtlasLayout::plan(&grid, &levels, limit).unwrap_err();
        assert!(matches!(error, Error::Invalid { .. }), "{error}");
        assert!(error.to_string().contains(&limit.to_string()), "{error}");
    }
}
