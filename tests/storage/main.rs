//! Bricked multiresolution storage on the CPU: statistics, selection, bricks, skip cells, atlas
//! layout.

mod bricks;
mod cells;
mod fingerprint;
mod layout;
mod leaps;
mod seams;
mod select;
mod statistics;

use umbravox::volume::blocks::{BlockGrid, FINEST, Levels, brick_extent, brick_texels};
use umbravox::volume::bricks::BrickBuilder;
use umbravox::volume::{Volume, Voxels};

/// SplitMix64 (Steele, Lea, Flood 2014).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, n: u64) -> u64 {
        self.next() % n
    }

    /// In [0, 1).
    fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A level for every block; about one in `absent_one_in` is not resident.
    fn levels(&mut self, grid: &BlockGrid, absent_one_in: u64) -> Levels {
        Levels {
            by_block: (0..grid.len())
                .map(|_| (self.below(absent_one_in) > 0).then(|| self.below(5) as u8))
                .collect(),
        }
    }
}

/// A volume of unit spacing with voxel values from a function of the index.
fn volume_of<T>(
    size: [u32; 3],
    wrap: impl Fn(Vec<T>) -> Voxels,
    mut voxel: impl FnMut([u32; 3]) -> T,
) -> Volume {
    let mut voxels = Vec::new();
    for k in 0..size[2] {
        for j in 0..size[1] {
            for i in 0..size[0] {
                voxels.push(voxel([i, j, k]));
            }
        }
    }
    Volume::axis_aligned(wrap(voxels), size, [1.0; 3]).unwrap()
}

fn random_f32(size: [u32; 3], random: &mut Random) -> Volume {
    volume_of(size, Voxels::F32, |_| random.unit() as f32)
}

fn random_u8(size: [u32; 3], random: &mut Random) -> Volume {
    volume_of(size, Voxels::U8, |_| random.below(256) as u8)
}

/// Bricks as the atlas holds them, sampled as a shader would, in f64.
struct Field {
    grid: BlockGrid,
    levels: Levels,
    bricks: Vec<Vec<f32>>,
}

impl Field {
    fn new(volume: &Volume, levels: &Levels) -> Self {
        let grid = BlockGrid::new(volume.size()).unwrap();
        let builder = BrickBuilder::new(volume, &grid, levels).unwrap();
        let bricks = (0..grid.len())
            .map(|block| {
                let mut samples = vec![0.0; levels.by_block[block].map_or(0, brick_texels)];
                builder.stored(block, &mut samples);
                samples
            })
            .collect();
        Self {
            grid,
            levels: levels.clone(),
            bricks,
        }
    }

    fn resident(&self) -> impl Iterator<Item = (usize, u8)> {
        let levels = self.levels.by_block.iter().enumerate();
        levels.filter_map(|(block, level)| Some((block, (*level)?)))
    }

    /// A stored sample of a brick.
    fn texel(&self, block: usize, at: [usize; 3]) -> f32 {
        let side = brick_extent(self.levels.by_block[block].unwrap()) as usize;
        self.bricks[block][at[0] + side * (at[1] + side * at[2])]
    }

    /// Trilinear interpolation inside one brick at a position of its closed block, in index space.
    fn sample(&self, block: usize, at_ix: [f64; 3]) -> f64 {
        let level = self.levels.by_block[block].unwrap();
        let intervals = self.grid.intervals(block, level);
        let cells = self.grid.cells(block);
        let origin = self.grid.origin_ix(block);
        let place: [(usize, f64); 3] = std::array::from_fn(|a| {
            let local = at_ix[a] - f64::from(origin[a]);
            assert!((0.0..=f64::from(cells[a])).contains(&local));
            let t = local * f64::from(intervals[a]) / f64::from(cells[a]);
            let below = (t as u32).min(intervals[a] - 1);
            (below as usize, t - f64::from(below))
        });
        trilinear(place, |at| f64::from(self.texel(block, at)))
    }
}

/// Trilinear interpolation; on each axis, the sample below and the fraction toward the next.
fn trilinear(place: [(usize, f64); 3], sample: impl Fn([usize; 3]) -> f64) -> f64 {
    (0..8usize)
        .map(|corner| {
            let side = |a: usize| corner >> a & 1;
            let weight: f64 = (0..3)
                .map(|a| match side(a) {
                    0 => 1.0 - place[a].1,
                    _ => place[a].1,
                })
                .product();
            weight * sample(std::array::from_fn(|a| place[a].0 + side(a)))
        })
        .sum()
}

/// Plain trilinear interpolation of the stored voxels.
fn sample_volume(volume: &Volume, at_ix: [f64; 3]) -> f64 {
    let place = std::array::from_fn(|a| {
        let below = (at_ix[a] as u32).min(volume.size()[a] - 2);
        (below as usize, at_ix[a] - f64::from(below))
    });
    trilinear(place, |[i, j, k]| {
        volume
            .voxels()
            .get(volume.offset(i as u32, j as u32, k as u32))
    })
}

/// Positions spread over a closed block, its borders and corners among them.
fn positions(grid: &BlockGrid, block: usize, per_axis: u32) -> impl Iterator<Item = [f64; 3]> {
    let origin = grid.origin_ix(block).map(f64::from);
    let cells = grid.cells(block).map(f64::from);
    (0..per_axis.pow(3)).map(move |i| {
        let step = [i, i / per_axis, i / per_axis.pow(2)].map(|s| s % per_axis);
        std::array::from_fn(|a| origin[a] + cells[a] * f64::from(step[a]) / f64::from(per_axis - 1))
    })
}

/// Smallest and largest stored voxel of a closed block.
fn closed_range(volume: &Volume, grid: &BlockGrid, block: usize) -> [f64; 2] {
    let (origin, cells) = (grid.origin_ix(block), grid.cells(block));
    let mut range = [f64::INFINITY, f64::NEG_INFINITY];
    for k in 0..=cells[2] {
        for j in 0..=cells[1] {
            for i in 0..=cells[0] {
                let at = volume.offset(origin[0] + i, origin[1] + j, origin[2] + k);
                let v = volume.voxels().get(at);
                range = [range[0].min(v), range[1].max(v)];
            }
        }
    }
    range
}

/// Every step to a neighbouring block.
fn neighbor_steps() -> impl Iterator<Item = [i32; 3]> {
    (0..27)
        .filter(|&i| i != 13)
        .map(|i| [i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1])
}

#[test]
fn blocks_cover_every_cell_once() {
    for size in [[2, 17, 18], [33, 34, 50], [257, 16, 3]] {
        let grid = BlockGrid::new(size).unwrap();
        let cells: u64 = (0..grid.len()).map(|b| grid.own_voxels(b, FINEST)).sum();
        let expected: u64 = size.iter().map(|&n| u64::from(n) - 1).product();
        assert_eq!(cells, expected, "{size:?}");
        for block in 0..grid.len() {
            assert_eq!(grid.index(grid.position(block)), block);
            let (first, m) = (grid.origin_ix(block), grid.cells(block));
            let last = std::array::from_fn(|a| first[a] + m[a] - 1);
            assert_eq!(grid.block_of_cell(first), block);
            assert_eq!(grid.block_of_cell(last), block);
        }
    }
    assert!(BlockGrid::new([1, 8, 8]).is_err());
}

#[test]
fn levels_that_do_not_fit_the_blocks_are_refused() {
    let volume = random_u8([20, 20, 20], &mut Random(0));
    let grid = BlockGrid::new(volume.size()).unwrap();
    for by_block in [vec![Some(4); 7], vec![Some(5); 8]] {
        let levels = Levels { by_block };
        assert!(BrickBuilder::new(&volume, &grid, &levels).is_err());
    }
    let other = BlockGrid::new([20, 20, 21]).unwrap();
    let levels = Levels::uniform(&other, FINEST);
    assert!(BrickBuilder::new(&volume, &other, &levels).is_err());
}
