//! The corners of voxel cells, packed: a second copy of the atlas, for drivers that filter on the processor.
//!
//! A filter reads eight texels for a sample, each with an address of its own. Here the eight lie in two texels, four of each
//! slice: `glsl/include/packed_cells.glsl` loads and interpolates them in less than half the time. Texels lie in pages ([`Pages`]).

use std::sync::Arc;

use ash::vk;

use super::pages::Pages;
use super::residency::{Residency, Store};
use crate::error::Result;
use crate::gpu::{Context, TexelBuffer};
use crate::volume::VoxelType;

/// Cells of a row of a texel; the shader's `CELLS_A_ROW`.
const CELLS_A_ROW: u32 = 3;
/// Largest index whose texel the shader finds (`third_of`).
const MAX_INDEX: u32 = 32767;

const TEXEL_BYTES: u32 = 16;

/// What packed corners would be like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Packing {
    pages: Pages,
    /// Bytes of a sample, 1 or 2.
    sample_bytes: u32,
}

impl Packing {
    /// `None` where the device filters faster itself, samples have more than two bytes, or the budget, which the texels of the atlas
    /// and what belongs to each share with `other_bytes`, has no room.
    pub(crate) fn of(
        context: &Context,
        store: &Store,
        residency: &Residency,
        other_texel_bytes: u32,
        other_bytes: u64,
        budget_bytes: u64,
    ) -> Option<Self> {
        let [width, height, depth] = residency.layout.extent();
        let sample_bytes = match store.volume.voxels().voxel_type() {
            VoxelType::U8 | VoxelType::I8 => 1,
            VoxelType::U16 | VoxelType::I16 => 2,
            VoxelType::F32 => return None,
        };
        if !context.capabilities().loads_texels || width.max(height) > MAX_INDEX + 1 {
            return None;
        }
        // The shapes of pages are the shader's (packed_pages.glsl).
        let (rows, page) = if sample_bytes == 1 {
            (height.div_ceil(CELLS_A_ROW), [4, 4, 16])
        } else {
            (height, [4, 8, 8])
        };
        // One slice more: samples on the last one load the next, of which they take nothing.
        let extent = [width.div_ceil(CELLS_A_ROW), rows, depth + 1];
        let pages = Pages::of(extent, page, TEXEL_BYTES);
        let texel_bytes = u64::from(sample_bytes + other_texel_bytes);
        let texels = residency.layout.texels().saturating_mul(texel_bytes);
        let beside = texels.saturating_add(other_bytes);
        let bytes = pages.bytes();
        let fits = bytes.saturating_add(beside) <= budget_bytes
            && bytes <= TexelBuffer::max_bytes(context, TEXEL_BYTES);
        fits.then_some(Self {
            pages,
            sample_bytes,
        })
    }
}

/// Packed corners on the device.
pub(crate) struct PackedCells {
    pub(crate) texels: TexelBuffer,
    packing: Packing,
    complete: bool,
}

impl PackedCells {
    pub(crate) const FORMAT: vk::Format = vk::Format::R32G32B32A32_UINT;

    /// # Errors
    /// [`crate::Error::OutOfMemory`].
    pub(crate) fn new(context: &Arc<Context>, name: &str, packing: Packing) -> Result<Self> {
        let name = format!("{name}.cells");
        Ok(Self {
            texels: TexelBuffer::new(context, &name, Self::FORMAT, packing.pages.bytes())?,
            packing,
            complete: false,
        })
    }

    pub(crate) fn packing(&self) -> Packing {
        self.packing
    }

    pub(crate) fn pages(&self) -> Pages {
        self.packing.pages
    }

    /// Bytes of a sample, 1 or 2.
    pub(crate) fn sample_bytes(&self) -> u32 {
        self.packing.sample_bytes
    }

    /// See [`crate::gpu::Buffer::forget`]. Everything is packed again.
    pub(crate) fn forget(&mut self) {
        self.texels.buffer().forget();
        self.complete = false;
    }

    pub(crate) fn is_complete(&self) -> bool {
        self.complete
    }

    /// True once: everything is to be packed, and counts as packed from now on.
    pub(crate) fn take_missing(&mut self) -> bool {
        !std::mem::replace(&mut self.complete, true)
    }
}
