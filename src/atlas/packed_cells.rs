//! The corners of voxel cells, packed: a second copy of the atlas, for drivers that filter on the processor.
//!
//! A filter reads eight texels for a sample, each with an address of its own. Here the eight lie in two texels, four of each
//! slice: `glsl/include/packed_cells.glsl` loads and interpolates them in less than half the time.

use std::sync::Arc;

use ash::vk;

use super::residency::{Residency, Store};
use crate::error::Result;
use crate::gpu::{Context, Image, ImageInfo};
use crate::volume::VoxelType;

/// Cells of a row of a texel; the shader's `CELLS_A_ROW`.
const CELLS_A_ROW: u32 = 3;
/// Largest index whose texel the shader finds (`third_of`).
const MAX_INDEX: u32 = 49151;

const TEXEL_BYTES: u64 = 16;
/// Most bytes of samples of two bytes, 5.3 for a voxel: larger copies wait for memory longer than filters compute.
const MAX_BYTES_OF_TWO: u64 = 64 << 20;

/// What packed corners would be like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Packing {
    extent: [u32; 3],
    /// Bytes of a sample, 1 or 2.
    sample_bytes: u32,
}

impl Packing {
    /// `None` where the device filters faster itself, samples have more than two bytes, those of two would take more than
    /// [`MAX_BYTES_OF_TWO`], or the budget, which the texels of the atlas and what belongs to each share, has no room.
    pub(crate) fn of(
        context: &Context,
        store: &Store,
        residency: &Residency,
        other_texel_bytes: u32,
        budget_bytes: u64,
    ) -> Option<Self> {
        let [width, height, depth] = residency.layout.extent();
        let sample_bytes = match store.volume.voxels().voxel_type() {
            VoxelType::U8 | VoxelType::I8 => 1,
            VoxelType::U16 | VoxelType::I16 => 2,
            VoxelType::F32 => return None,
        };
        if !context.capabilities().loads_texels
            || !context.can_store(PackedCells::FORMAT)
            || width.max(height) > MAX_INDEX
            || depth >= context.capabilities().max_extent_3d
        {
            return None;
        }
        // One slice more: samples on the last one load the next, of which they take nothing.
        let rows = if sample_bytes == 1 {
            height.div_ceil(CELLS_A_ROW)
        } else {
            height
        };
        let extent = [width.div_ceil(CELLS_A_ROW), rows, depth + 1];
        let texels = extent.iter().map(|&n| u64::from(n)).product::<u64>();
        let texel_bytes = u64::from(sample_bytes + other_texel_bytes);
        let beside = residency.layout.texels().saturating_mul(texel_bytes);
        let bytes = texels.saturating_mul(TEXEL_BYTES);
        let worth_it = sample_bytes == 1 || bytes <= MAX_BYTES_OF_TWO;
        let fits = bytes.saturating_add(beside) <= budget_bytes;
        (worth_it && fits).then_some(Self {
            extent,
            sample_bytes,
        })
    }
}

/// Packed corners on the device.
pub(crate) struct PackedCells {
    pub(crate) image: Image,
    sample_bytes: u32,
    complete: bool,
}

impl PackedCells {
    pub(crate) const FORMAT: vk::Format = vk::Format::R32G32B32A32_UINT;

    /// # Errors
    /// [`crate::Error::OutOfMemory`].
    pub(crate) fn new(context: &Arc<Context>, name: &str, packing: Packing) -> Result<Self> {
        let image = Image::new(
            context,
            &ImageInfo {
                name: &format!("{name}.cells"),
                extent: packing.extent,
                format: Self::FORMAT,
                three_dimensional: true,
                usage: vk::ImageUsageFlags::STORAGE,
            },
        )?;
        Ok(Self {
            image,
            sample_bytes: packing.sample_bytes,
            complete: false,
        })
    }

    pub(crate) fn packing(&self) -> Packing {
        Packing {
            extent: self.image.extent(),
            sample_bytes: self.sample_bytes,
        }
    }

    /// Bytes of a sample, 1 or 2.
    pub(crate) fn sample_bytes(&self) -> u32 {
        self.sample_bytes
    }

    /// See [`Image::forget`]. Everything is packed again.
    pub(crate) fn forget(&mut self) {
        self.image.forget();
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
