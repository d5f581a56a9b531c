//! Flat multiresolution blocking: which block covers which cells, and what its brick holds at each
//! level.
//!
//! A *cell* is the cube between eight neighbouring voxels, so `n` voxels make `n - 1` cells. A
//! *block* is 16^3 cells and covers a closed region of index space; blocks share the voxels on
//! their borders. A *brick* is what is stored of a block at a level of detail `lambda` in 0..=4
//! (Ljung's flat blocking): `N^3` own samples and a one-sided apron, `(N + 1)^3` samples that cover
//! the closed block. Trilinear interpolation inside a block therefore needs its own brick only.

use crate::error::{Error, Result};

/// Cells of a block on each axis.
pub const BLOCK_CELLS: u32 = 16;

/// The finest level of detail, where a brick holds the voxels themselves.
pub const FINEST: u8 = 4;

/// Number of levels of detail.
pub const LEVELS: usize = FINEST as usize + 1;

/// Texels on each axis that a brick takes in the atlas: `2^lambda + 1`.
pub const fn brick_extent(level: u8) -> u32 {
    (1 << level) + 1
}

/// Texels that a brick takes in the atlas: `(2^lambda + 1)^3`.
pub const fn brick_texels(level: u8) -> usize {
    (brick_extent(level) as usize).pow(3)
}

/// The division of a volume into blocks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BlockGrid {
    size: [u32; 3],
    counts: [u32; 3],
}

impl BlockGrid {
    /// Blocks of a volume of `size` voxels.
    ///
    /// # Errors
    /// [`Error::Invalid`] when an axis has fewer than two voxels, or there are more than `u32::MAX`
    /// blocks.
    pub fn new(size: [u32; 3]) -> Result<Self> {
        if size.iter().any(|&n| n < super::MIN_SIZE) {
            return Err(Error::invalid(
                "volume size",
                format!("{size:?} voxels enclose no space; at least 2 on each axis are needed"),
            ));
        }
        let counts = size.map(|n| (n - 1).div_ceil(BLOCK_CELLS));
        let blocks = counts.iter().try_fold(1u32, |n, &c| n.checked_mul(c));
        if blocks.is_none() {
            return Err(Error::invalid(
                "volume size",
                format!("{size:?} voxels make more than {} blocks", u32::MAX),
            ));
        }
        Ok(Self { size, counts })
    }

    /// Voxels of the volume on x, y, z.
    pub fn size(&self) -> [u32; 3] {
        self.size
    }

    /// Blocks on x, y, z.
    pub fn counts(&self) -> [u32; 3] {
        self.counts
    }

    /// Number of blocks; at least 1.
    #[expect(
        clippy::len_without_is_empty,
        reason = "a grid has at least one block, by construction"
    )]
    pub fn len(&self) -> usize {
        self.counts.iter().map(|&c| c as usize).product()
    }

    /// Linear index of the block at `block_bx`, x fastest.
    pub fn index(&self, block_bx: [u32; 3]) -> usize {
        let [x, y, z] = block_bx.map(|c| c as usize);
        x + self.counts[0] as usize * (y + self.counts[1] as usize * z)
    }

    /// Position of a block in the grid, from its linear index.
    pub fn position(&self, block: usize) -> [u32; 3] {
        let [nx, ny, _] = self.counts.map(|c| c as usize);
        [block % nx, block / nx % ny, block / (nx * ny)].map(|c| c as u32)
    }

    /// Linear index of the block that holds a cell.
    pub fn block_of_cell(&self, cell_ix: [u32; 3]) -> usize {
        self.index(cell_ix.map(|c| c / BLOCK_CELLS))
    }

    /// The first voxel of a block.
    pub fn origin_ix(&self, block: usize) -> [u32; 3] {
        self.position(block).map(|b| b * BLOCK_CELLS)
    }

    /// Cells of a block on each axis, `m` in 1..=16; fewer than 16 only in the last block of an
    /// axis.
    pub fn cells(&self, block: usize) -> [u32; 3] {
        let first_ix = self.origin_ix(block);
        std::array::from_fn(|a| (self.size[a] - 1 - first_ix[a]).min(BLOCK_CELLS))
    }

    /// Intervals between the samples of a brick on each axis, `N`.
    ///
    /// Sample `i` in 0..=N of an axis lies `i m / N` cells into the block. Below the finest level
    /// `N = 2^lambda`; at the finest, samples are the voxels, `N = m`.
    pub fn intervals(&self, block: usize, level: u8) -> [u32; 3] {
        if level == FINEST {
            self.cells(block)
        } else {
            [1 << level; 3]
        }
    }

    /// Samples that a brick counts as its own, without the apron: `N^3`.
    pub fn own_voxels(&self, block: usize, level: u8) -> u64 {
        self.intervals(block, level)
            .iter()
            .map(|&n| u64::from(n))
            .product()
    }

    /// The block next to one, `None` outside the volume. `step` is -1, 0 or 1 on each axis.
    pub fn neighbor(&self, block: usize, step: [i32; 3]) -> Option<usize> {
        let from = self.position(block);
        let mut to = [0; 3];
        for a in 0..3 {
            to[a] = from[a].checked_add_signed(step[a])?;
            if to[a] >= self.counts[a] {
                return None;
            }
        }
        Some(self.index(to))
    }
}

/// The level of detail of every block.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Levels {
    /// By linear block index; `None` for a block that is not resident.
    pub by_block: Vec<Option<u8>>,
}

impl Levels {
    /// Every block at one level.
    pub fn uniform(grid: &BlockGrid, level: u8) -> Self {
        Self {
            by_block: vec![Some(level); grid.len()],
        }
    }

    /// Number of resident blocks at each level.
    pub fn count_by_level(&self) -> [usize; LEVELS] {
        let mut counts = [0; LEVELS];
        for &level in self.by_block.iter().flatten() {
            counts[level as usize] += 1;
        }
        counts
    }

    /// Number of resident blocks.
    pub fn resident(&self) -> usize {
        self.by_block.iter().flatten().count()
    }

    /// Checks that there is one level, 0..=4, for each block of `grid`.
    ///
    /// # Errors
    /// [`Error::Invalid`] when there is not.
    pub fn check(&self, grid: &BlockGrid) -> Result<()> {
        if self.by_block.len() != grid.len() {
            return Err(Error::invalid(
                "levels",
                format!(
                    "{} levels for {} blocks; one for each is needed",
                    self.by_block.len(),
                    grid.len()
                ),
            ));
        }
        match self.by_block.iter().flatten().find(|&&l| l > FINEST) {
            Some(level) => Err(Error::invalid(
                "levels",
                format!("level {level} does not exist; the finest is {FINEST}"),
            )),
            None => Ok(()),
        }
    }
}
