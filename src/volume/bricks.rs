//! What is stored of each block: the texels of its brick, continuous across blocks of any level.
//!
//! Between blocks of equal level the shared face holds the same samples in both. Where levels
//! differ, the finer brick takes its border from the coarser one: a border sample is the trilinear
//! interpolation of the *coarsest* resident block that contains it. Borders are resolved from
//! coarse to fine, so that a coarse brick already agrees with still coarser ones. As the samples of
//! a level are a subset of those of the next, the finer brick then reproduces the coarser one all
//! over the shared face, up to the rounding of integer texels. The exception is a last block of
//! fewer than 16 cells at the finest level, whose voxels need not lie on the samples of a coarse
//! neighbour: linear fields stay exact, others may show a small step there.

use rayon::prelude::*;

use super::Volume;
use super::blocks::{BlockGrid, FINEST, Levels, brick_extent, brick_texels};
use super::color::ColorChannel;
use super::filter::BlockFilter;
use super::texel::{Voxel, with_typed};
use crate::error::{Error, Result};

/// Makes the texels of any brick; coarse ones are kept, finest ones are copied out of the volume.
pub struct BrickBuilder<'a> {
    bricks: Box<dyn Write + 'a>,
    grid: &'a BlockGrid,
    levels: &'a Levels,
    texel_bytes: usize,
}

impl<'a> BrickBuilder<'a> {
    /// Builds the coarse bricks, from level 0 up, in parallel.
    ///
    /// They take `(2^lambda + 1)^3` texels of host memory each, as in the atlas.
    ///
    /// # Errors
    /// [`crate::error::Error::Invalid`] when `levels` do not fit `grid`, or `grid` does not fit the
    /// volume.
    pub fn new(volume: &'a Volume, grid: &'a BlockGrid, levels: &'a Levels) -> Result<Self> {
        check(volume, grid, levels)?;
        let bricks: Box<dyn Write + 'a> = with_typed!(
            volume.voxels(),
            voxels => Box::new(Bricks::new(voxels, grid, levels))
        );
        Ok(Self {
            bricks,
            grid,
            levels,
            texel_bytes: volume.voxels().voxel_type().bytes(),
        })
    }

    /// Of one kind of light (0 red, 1 green, 2 blue) of the volume's colours, a byte a texel. Coarse levels and borders are
    /// mixed as light where `decoded`, else as display values, which texels are.
    ///
    /// # Errors
    /// As [`BrickBuilder::new`], and when the volume has no colours.
    pub(crate) fn of_color(
        volume: &'a Volume,
        grid: &'a BlockGrid,
        levels: &'a Levels,
        kind: usize,
        decoded: bool,
    ) -> Result<Self> {
        check(volume, grid, levels)?;
        let Some(colors) = volume.colors() else {
            return Err(Error::invalid("volume", "its voxels are no colours"));
        };
        fn bricks<'a, const KIND: usize, const DECODED: bool>(
            colors: &'a [[u8; 4]],
            grid: &'a BlockGrid,
            levels: &'a Levels,
        ) -> Box<dyn Write + 'a> {
            let voxels: &[ColorChannel<KIND, DECODED>] = bytemuck::cast_slice(colors);
            Box::new(Bricks::new(voxels, grid, levels))
        }
        let make = match (kind, decoded) {
            (0, true) => bricks::<0, true>,
            (1, true) => bricks::<1, true>,
            (_, true) => bricks::<2, true>,
            (0, false) => bricks::<0, false>,
            (1, false) => bricks::<1, false>,
            (_, false) => bricks::<2, false>,
        };
        Ok(Self {
            bricks: make(colors, grid, levels),
            grid,
            levels,
            texel_bytes: 1,
        })
    }

    /// The blocks that bricks are of.
    pub fn grid(&self) -> &'a BlockGrid {
        self.grid
    }

    /// Level of every block.
    pub fn levels(&self) -> &'a Levels {
        self.levels
    }

    /// Texels of a brick on each axis, `2^lambda + 1`; 0 for a block that is not resident.
    pub fn extent(&self, block: usize) -> u32 {
        self.levels.by_block[block].map_or(0, brick_extent)
    }

    /// Bytes of a brick, tightly packed; 0 for a block that is not resident.
    pub fn bytes(&self, block: usize) -> usize {
        self.levels.by_block[block].map_or(0, brick_texels) * self.texel_bytes
    }

    /// Whether a brick is resident and its texels are the voxels of its block, none taken from a coarser neighbour.
    pub(super) fn holds_voxels(&self, block: usize) -> bool {
        self.levels.by_block[block] == Some(FINEST) && !self.bricks.has_coarser_neighbor(block)
    }

    /// Writes the texels of a brick, x fastest, to the first [`BrickBuilder::bytes`] of `to`.
    ///
    /// Signed voxels are offset by half their range. In a last block of fewer than 16 cells at the
    /// finest level the texels beyond its voxels repeat the last one. Nothing is written for a
    /// block that is not resident.
    ///
    /// # Panics
    /// When `to` is too short.
    pub fn write(&self, block: usize, to: &mut [u8]) {
        if let Some(level) = self.levels.by_block[block] {
            self.bricks
                .write(block, level, &mut to[..self.bytes(block)]);
        }
    }

    /// Like [`BrickBuilder::write`], but as stored voxels (before rescale): what sampling the atlas
    /// yields.
    ///
    /// # Panics
    /// When `to` holds fewer than `(2^lambda + 1)^3` samples.
    pub fn stored(&self, block: usize, to: &mut [f32]) {
        if let Some(level) = self.levels.by_block[block] {
            self.bricks
                .stored(block, level, &mut to[..brick_texels(level)]);
        }
    }
}

fn check(volume: &Volume, grid: &BlockGrid, levels: &Levels) -> Result<()> {
    levels.check(grid)?;
    if grid.size() == volume.size() {
        return Ok(());
    }
    let (blocks, voxels) = (grid.size(), volume.size());
    let message = format!("blocks of {blocks:?} voxels do not fit a volume of {voxels:?}");
    Err(Error::invalid("blocks", message))
}

/// The voxel type erased.
trait Write: Send + Sync {
    fn write(&self, block: usize, level: u8, to: &mut [u8]);
    fn stored(&self, block: usize, level: u8, to: &mut [f32]);
    /// Of a block at the finest level.
    fn has_coarser_neighbor(&self, block: usize) -> bool;
}

struct Bricks<'a, V: Voxel> {
    voxels: &'a [V],
    map: Map<'a>,
    /// Coarse bricks, borders resolved, by level and then block.
    coarse: Vec<V::Texel>,
}

/// Where blocks lie, at which level, and where their coarse bricks begin in the cache.
struct Map<'a> {
    grid: &'a BlockGrid,
    levels: &'a Levels,
    /// By block; meaningful for resident blocks below the finest level.
    start: Vec<usize>,
}

impl<'a, V: Voxel> Bricks<'a, V> {
    fn new(voxels: &'a [V], grid: &'a BlockGrid, levels: &'a Levels) -> Self {
        let mut by_level: [Vec<usize>; FINEST as usize] = Default::default();
        for (block, level) in levels.by_block.iter().enumerate() {
            if let Some(level) = level.filter(|&l| l < FINEST) {
                by_level[usize::from(level)].push(block);
            }
        }
        let mut map = Map {
            grid,
            levels,
            start: vec![0; grid.len()],
        };
        let mut total = 0;
        for (level, blocks) in (0..FINEST).zip(&by_level) {
            for &block in blocks {
                map.start[block] = total;
                total += brick_texels(level);
            }
        }

        let mut coarse = vec![V::nearest_texel(0.0); total];
        let mut built = 0;
        for (level, blocks) in (0..FINEST).zip(&by_level) {
            let (coarser, rest) = coarse.split_at_mut(built);
            let length = blocks.len() * brick_texels(level);
            rest[..length]
                .par_chunks_exact_mut(brick_texels(level))
                .zip(blocks)
                .for_each_init(BlockFilter::new, |filter, (brick, &block)| {
                    filter.gather(
                        voxels,
                        grid.size(),
                        grid.origin_ix(block),
                        grid.cells(block),
                    );
                    filter.coarse::<V>(level, brick);
                    map.resolve_border::<V>(block, level, brick, coarser);
                });
            built += length;
        }
        Self {
            voxels,
            map,
            coarse,
        }
    }

    fn coarse_brick(&self, block: usize, level: u8) -> &[V::Texel] {
        &self.coarse[self.map.start[block]..][..brick_texels(level)]
    }

    /// Rows of voxels of a finest brick, in order; each has `m + 1` voxels and is to be repeated to
    /// 17.
    fn finest_rows(&self, block: usize) -> impl Iterator<Item = &[V]> {
        let [width, height, _] = self.map.grid.size().map(|n| n as usize);
        let [x, y, z] = self.map.grid.origin_ix(block).map(|c| c as usize);
        let [mx, my, mz] = self.map.grid.cells(block).map(|m| m as usize);
        let side = brick_extent(FINEST) as usize;
        (0..side * side).map(move |row| {
            let (j, k) = ((row % side).min(my), (row / side).min(mz));
            let at = x + width * (y + j + height * (z + k));
            &self.voxels[at..=at + mx]
        })
    }

    /// A finest brick with its border taken from coarser neighbours.
    fn resolved_finest(&self, block: usize) -> Vec<V::Texel> {
        let side = brick_extent(FINEST) as usize;
        let mut brick = Vec::with_capacity(brick_texels(FINEST));
        for row in self.finest_rows(block) {
            let last = row[row.len() - 1].texel();
            brick.extend(row.iter().map(|v| v.texel()));
            brick.extend(std::iter::repeat_n(last, side - row.len()));
        }
        self.map
            .resolve_border::<V>(block, FINEST, &mut brick, &self.coarse);
        self.map.repeat_last(block, &mut brick);
        brick
    }
}

impl<V: Voxel> Write for Bricks<'_, V> {
    fn has_coarser_neighbor(&self, block: usize) -> bool {
        self.map.has_coarser_neighbor(block, FINEST)
    }

    fn write(&self, block: usize, level: u8, to: &mut [u8]) {
        if level < FINEST {
            to.copy_from_slice(bytemuck::cast_slice(self.coarse_brick(block, level)));
        } else if self.map.has_coarser_neighbor(block, level) {
            to.copy_from_slice(bytemuck::cast_slice(&self.resolved_finest(block)));
        } else {
            let texel_bytes = size_of::<V::Texel>();
            let row_bytes = brick_extent(FINEST) as usize * texel_bytes;
            for (row, to) in self.finest_rows(block).zip(to.chunks_exact_mut(row_bytes)) {
                let (own, rest) = to.split_at_mut(row.len() * texel_bytes);
                V::write_row(row, own);
                for texel in rest.chunks_exact_mut(texel_bytes) {
                    V::write_row(&row[row.len() - 1..], texel);
                }
            }
        }
    }

    fn stored(&self, block: usize, level: u8, to: &mut [f32]) {
        let decode = |texels: &[V::Texel], to: &mut [f32]| {
            for (to, &texel) in to.iter_mut().zip(texels) {
                *to = V::stored(texel);
            }
        };
        if level < FINEST {
            decode(self.coarse_brick(block, level), to);
        } else if self.map.has_coarser_neighbor(block, level) {
            decode(&self.resolved_finest(block), to);
        } else {
            let side = brick_extent(FINEST) as usize;
            for (row, to) in self.finest_rows(block).zip(to.chunks_exact_mut(side)) {
                let (own, rest) = to.split_at_mut(row.len());
                for (to, voxel) in own.iter_mut().zip(row) {
                    *to = voxel.to_f32();
                }
                rest.fill(own[own.len() - 1]);
            }
        }
    }
}

/// The 26 faces, edges and corners of a block, by the side (-1, 0 or 1) they lie on; 0 runs along
/// the axis.
fn border_features() -> impl Iterator<Item = [i32; 3]> {
    (0..27)
        .filter(|&i| i != 13)
        .map(|i| [i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1])
}

impl Map<'_> {
    fn has_coarser_neighbor(&self, block: usize, level: u8) -> bool {
        border_features().any(|step| {
            self.grid
                .neighbor(block, step)
                .and_then(|n| self.levels.by_block[n])
                .is_some_and(|l| l < level)
        })
    }

    /// The coarsest resident block below `level` that shares a face, edge or corner, with the step
    /// to it.
    fn coarsest_at(
        &self,
        block: usize,
        level: u8,
        feature: [i32; 3],
    ) -> Option<(usize, u8, [i32; 3])> {
        (1..8)
            .map(|subset| {
                std::array::from_fn(|a| if subset >> a & 1 == 1 { feature[a] } else { 0 })
            })
            .filter(|step| *step != [0; 3])
            .filter_map(|step| {
                let neighbor = self.grid.neighbor(block, step)?;
                let coarser = self.levels.by_block[neighbor].filter(|&l| l < level)?;
                Some((neighbor, coarser, step))
            })
            .min_by_key(|&(_, coarser, _)| coarser)
    }

    /// Overwrites the border samples of a brick that a coarser block determines.
    ///
    /// `coarse` holds the resolved bricks of all levels below `level`.
    fn resolve_border<V: Voxel>(
        &self,
        block: usize,
        level: u8,
        brick: &mut [V::Texel],
        coarse: &[V::Texel],
    ) {
        let side = brick_extent(level) as usize;
        let own = self.grid.intervals(block, level).map(|n| n as usize);
        for feature in border_features() {
            let Some((neighbor, coarser, step)) = self.coarsest_at(block, level, feature) else {
                continue;
            };
            let coarse_brick = &coarse[self.start[neighbor]..][..brick_texels(coarser)];
            let other = 1usize << coarser;
            // Samples in the relative interior of the feature; its own border belongs to other
            // features.
            let range = |a: usize| match feature[a] {
                0 => 1..own[a],
                1 => own[a]..own[a] + 1,
                _ => 0..1,
            };
            // Where a sample of this brick lies among the neighbour's.
            let place = |a: usize, i: usize| match (feature[a], step[a]) {
                (0, _) => {
                    let below = i * other / own[a];
                    let s = (i * other % own[a]) as f64 / own[a] as f64;
                    (below, s)
                }
                (1, 0) | (-1, -1) => (other, 0.0),
                _ => (0, 0.0),
            };
            for k in range(2) {
                let z = place(2, k);
                for j in range(1) {
                    let y = place(1, j);
                    for i in range(0) {
                        let at = i + side * (j + side * k);
                        brick[at] = V::nearest_texel(interpolate::<V>(
                            coarse_brick,
                            other + 1,
                            [place(0, i), y, z],
                        ));
                    }
                }
            }
        }
    }

    /// Repeats the last voxel of each axis of a finest brick over the texels beyond.
    fn repeat_last<T: Copy>(&self, block: usize, brick: &mut [T]) {
        let side = brick_extent(FINEST) as usize;
        let last = self.grid.cells(block).map(|m| m as usize);
        if last == [side - 1; 3] {
            return;
        }
        for k in 0..side {
            for j in 0..side {
                for i in 0..side {
                    let from = i.min(last[0]) + side * (j.min(last[1]) + side * k.min(last[2]));
                    brick[i + side * (j + side * k)] = brick[from];
                }
            }
        }
    }
}

/// Trilinear interpolation inside a brick; on each axis, the sample below and the fraction toward
/// the next.
fn interpolate<V: Voxel>(brick: &[V::Texel], side: usize, at: [(usize, f64); 3]) -> f64 {
    let sample = |corner: usize| {
        let index = |a: usize| at[a].0 + (corner >> a & 1);
        f64::from(V::stored(
            brick[index(0) + side * (index(1) + side * index(2))],
        ))
    };
    // Corners of weight 0 may lie outside the brick.
    (0..8usize)
        .filter_map(|corner| {
            let weight: f64 = (0..3)
                .map(|a| {
                    let s = at[a].1;
                    if corner >> a & 1 == 1 { s } else { 1.0 - s }
                })
                .product();
            (weight > 0.0).then(|| weight * sample(corner))
        })
        .sum()
}
