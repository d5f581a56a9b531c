//! Colours that the data itself has, brick by brick beside the atlas.

use ash::vk;

use crate::error::Result;
use crate::gpu::Image;
use crate::scene::ColorManagement;
use crate::volume::Volume;
use crate::volume::blocks::{BlockGrid, Levels};
use crate::volume::bricks::BrickBuilder;

/// Bytes of a texel of the data's colours.
pub(crate) const COLOR_TEXEL_BYTES: u32 = 4;

/// Display colours, packed like the atlas.
pub(crate) struct ColorAtlas {
    pub(crate) image: Image,
    pub(crate) management: ColorManagement,
}

impl ColorAtlas {
    /// Four bytes that the texture unit turns into light, or leaves as they are. Every device samples and filters both.
    pub(crate) fn format(management: ColorManagement) -> vk::Format {
        match management {
            ColorManagement::Linear => vk::Format::R8G8B8A8_SRGB,
            ColorManagement::None => vk::Format::R8G8B8A8_UNORM,
        }
    }
}

/// Makes the texels of any brick of colours. What is between voxels is mixed as the texture unit mixes it.
pub(super) struct ColorBricks<'a> {
    /// Red, green, blue.
    kinds: [BrickBuilder<'a>; 3],
}

impl<'a> ColorBricks<'a> {
    pub(super) fn new(
        volume: &'a Volume,
        grid: &'a BlockGrid,
        levels: &'a Levels,
        management: ColorManagement,
    ) -> Result<Self> {
        let decoded = management == ColorManagement::Linear;
        let kind = |kind| BrickBuilder::of_color(volume, grid, levels, kind, decoded);
        Ok(Self {
            kinds: [kind(0)?, kind(1)?, kind(2)?],
        })
    }

    /// See [`BrickBuilder::bytes`].
    pub(super) fn bytes(&self, block: usize) -> usize {
        let [red, ..] = &self.kinds;
        red.bytes(block) * COLOR_TEXEL_BYTES as usize
    }

    /// See [`BrickBuilder::write`].
    pub(super) fn write(&self, block: usize, to: &mut [u8]) {
        let [red, ..] = &self.kinds;
        let mut texels = vec![0; red.bytes(block)];
        for (kind, builder) in self.kinds.iter().enumerate() {
            builder.write(block, &mut texels);
            for (texel, color) in texels.iter().zip(to.as_chunks_mut::<4>().0) {
                color[kind] = *texel;
                color[3] = u8::MAX;
            }
        }
    }
}
