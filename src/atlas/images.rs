//! The device side of the volume.

use std::sync::Arc;

use ash::vk;

use super::{
    ColorAtlas, GradientTexels, INTEGRAL_ROWS, LightWork, PackedCells, Residency, Store,
    TransferTable,
};
use crate::error::{Error, Result};
use crate::gpu::memory::MemoryLocation;
use crate::gpu::{Buffer, Context, Filter, Image, ImageInfo, Sampler, TexelBuffer};
use crate::scene::ColorManagement;
use crate::volume::VoxelType;
use crate::volume::shown_cells::ShownCells;

/// Format of the light volume.
pub(crate) const LIGHT_FORMAT: vk::Format = vk::Format::R16G16B16A16_SFLOAT;
/// Bytes of a texel of the light volume.
pub(crate) const LIGHT_TEXEL_BYTES: u32 = 8;

/// Images and buffers of one volume under one choice of levels.
pub(crate) struct Images {
    /// Voxels, brick by brick.
    pub(crate) atlas: Image,
    /// Block to place and level: RGBA, texel origin and level + 1; 0 for none.
    pub(crate) index: Image,
    /// Leaps through skip cells.
    pub(crate) skip: Image,
    /// Corners of voxel cells, packed; what fills them decides when they can be read.
    pub(crate) packed_cells: Option<PackedCells>,
    /// Bits of cells between voxels that may show something (see [`super::Visibility::cells`]), where beams look them up.
    pub(crate) shown_cells: Option<TexelBuffer>,
    /// Stands in for texel buffers that are not there.
    pub(crate) no_texels: NoTexels,
    /// Colours of the data, where they are drawn.
    pub(crate) color: Option<ColorAtlas>,
    /// Transfer-function table.
    pub(crate) transfer: Image,
    /// Local ambient occlusion, packed like the atlas; one texel when it is off.
    pub(crate) light: Image,
    /// The voxel format cannot be filtered by this device's texture units: the shaders do it.
    pub(crate) manual_filter: bool,
    pub(crate) linear: Sampler,
    pub(crate) nearest: Sampler,
}

/// The texture format that keeps a voxel type's precision.
pub(crate) fn voxel_format(voxel_type: VoxelType) -> vk::Format {
    match voxel_type {
        VoxelType::U8 | VoxelType::I8 => vk::Format::R8_UNORM,
        VoxelType::U16 | VoxelType::I16 => vk::Format::R16_UNORM,
        VoxelType::F32 => vk::Format::R32_SFLOAT,
    }
}

impl Images {
    pub(crate) fn new(
        context: &Arc<Context>,
        name: &str,
        store: &Store,
        residency: &Residency,
        lit: bool,
        color: Option<ColorManagement>,
    ) -> Result<Self> {
        let max = context.capabilities().max_extent_3d;
        let volume_image = |part: &str, extent: [u32; 3], format, usage| {
            let name = format!("{name}.{part}");
            if extent.iter().any(|&n| n > max) {
                return Err(Error::Unsupported {
                    device: context.capabilities().name.clone(),
                    need: format!("a 3D image of {extent:?} texels for {name}"),
                    have: format!("at most {max} on an axis"),
                });
            }
            Image::new(
                context,
                &ImageInfo {
                    name: &name,
                    extent,
                    format,
                    three_dimensional: true,
                    usage,
                },
            )
        };
        let sampled = vk::ImageUsageFlags::SAMPLED | vk::ImageUsageFlags::TRANSFER_DST;
        let format = voxel_format(store.volume.voxels().voxel_type());
        if !context.can_sample(format) {
            return Err(Error::Unsupported {
                device: context.capabilities().name.clone(),
                need: format!("sampling of {format:?} (the volume's voxels)"),
                have: "no such format".into(),
            });
        }
        let extent = residency.layout.extent();
        let color = color
            .map(|management| {
                let format = ColorAtlas::format(management);
                let image = volume_image("color", extent, format, sampled)?;
                Ok::<_, Error>(ColorAtlas { image, management })
            })
            .transpose()?;
        Ok(Self {
            packed_cells: None,
            shown_cells: None,
            no_texels: NoTexels::new(context, name)?,
            color,
            atlas: volume_image("atlas", extent, format, sampled)?,
            index: volume_image(
                "index",
                store.grid().counts(),
                vk::Format::R16G16B16A16_UINT,
                sampled | vk::ImageUsageFlags::STORAGE,
            )?,
            skip: volume_image(
                "skip",
                residency.cells.counts(),
                vk::Format::R32_UINT,
                sampled | vk::ImageUsageFlags::STORAGE,
            )?,
            transfer: Image::new(
                context,
                &ImageInfo {
                    name: &format!("{name}.transfer"),
                    extent: [TransferTable::MAX_TEXELS, TransferTable::ROWS, 1],
                    format: vk::Format::R32G32B32A32_SFLOAT,
                    three_dimensional: false,
                    usage: sampled | vk::ImageUsageFlags::STORAGE,
                },
            )?,
            light: volume_image(
                "light",
                if lit { extent } else { [1; 3] },
                LIGHT_FORMAT,
                sampled | vk::ImageUsageFlags::STORAGE | vk::ImageUsageFlags::TRANSFER_SRC,
            )?,
            manual_filter: !context.filters_linearly(format),
            linear: Sampler::new(context, &format!("{name}.linear"), Filter::Linear)?,
            nearest: Sampler::new(context, &format!("{name}.nearest"), Filter::Nearest)?,
        })
    }

    /// The index texture's texels, for the blocks that `uploaded` says are there.
    pub(crate) fn index_texels(
        residency: &Residency,
        uploaded: impl Fn(usize) -> bool,
    ) -> Vec<u16> {
        let levels = &residency.selection.levels.by_block;
        residency
            .layout
            .origins()
            .iter()
            .zip(levels)
            .enumerate()
            .flat_map(|(block, place)| match place {
                (Some(origin), Some(level)) if uploaded(block) => {
                    let [x, y, z] = origin.map(|o| o as u16);
                    [x, y, z, u16::from(*level) + 1]
                }
                _ => [0; 4],
            })
            .collect()
    }

    /// What beams look up, of bits as [`super::Visibility::cells`] has them; `None` where the device has no room, as beams can do without.
    pub(crate) fn shown_cells(
        context: &Arc<Context>,
        name: &str,
        cells: Option<&[ShownCells]>,
    ) -> Result<Option<TexelBuffer>> {
        let name = format!("{name}.shown_cells");
        let format = NoTexels::SHOWN_CELLS;
        let most = TexelBuffer::max_bytes(context, size_of::<ShownCells>() as u32);
        let bytes: Option<&[u8]> = cells.map(bytemuck::cast_slice);
        let Some(bytes) = bytes.filter(|bytes| bytes.len() as u64 <= most) else {
            return Ok(None);
        };
        match TexelBuffer::holding(context, &name, format, bytes) {
            Err(Error::OutOfMemory { .. }) => Ok(None),
            made => made.map(Some),
        }
    }

    /// Nothing is known of what the images hold; see [`Image::forget`].
    pub(crate) fn forget(&mut self) {
        self.packed_cells.iter_mut().for_each(PackedCells::forget);
        self.shown_cells.iter().for_each(|t| t.buffer().forget());
        let images = [
            &self.atlas,
            &self.index,
            &self.skip,
            &self.transfer,
            &self.light,
        ];
        let color = self.color.iter().map(|color| &color.image);
        images.into_iter().chain(color).for_each(Image::forget);
    }

    /// The sampler of the atlas; formats that cannot be filtered must not be bound with one that does.
    pub(crate) fn atlas_sampler(&self) -> &Sampler {
        if self.manual_filter {
            &self.nearest
        } else {
            &self.linear
        }
    }
}

/// A texel of each format that texel buffers have, which nothing reads.
pub(crate) struct NoTexels {
    /// As of packed corners.
    pub(crate) cells: TexelBuffer,
    /// As of [`Images::shown_cells`].
    pub(crate) shown_cells: TexelBuffer,
    /// As of gradients of ten bits.
    pub(crate) ten_bits: TexelBuffer,
    /// As of those in fours.
    pub(crate) in_fours: TexelBuffer,
    /// As of gradients in halves.
    pub(crate) halves: TexelBuffer,
}

impl NoTexels {
    const SHOWN_CELLS: vk::Format = vk::Format::R32G32B32A32_UINT;

    fn new(context: &Arc<Context>, name: &str) -> Result<Self> {
        let texel = |part: &str, format| {
            TexelBuffer::new(context, &format!("{name}.no_{part}"), format, 16)
        };
        Ok(Self {
            cells: texel("cells", PackedCells::FORMAT)?,
            shown_cells: texel("shown_cells", Self::SHOWN_CELLS)?,
            ten_bits: texel("ten_bits", GradientTexels::TenBits.format())?,
            in_fours: texel("in_fours", GradientTexels::InFours.format())?,
            halves: texel("halves", GradientTexels::Halves.format())?,
        })
    }
}

/// The device side of pre-integrated classification.
pub(crate) struct TableImages {
    /// Integrals along the transfer function: see [`super::Preintegration::texels`].
    pub(crate) integrals: Image,
    /// What a whole step shows, by the values at its front (x) and its back (y): associated colour, opacity.
    pub(crate) table: Image,
    /// Associated emission likewise; one texel without.
    pub(crate) emission: Image,
}

impl TableImages {
    pub(crate) fn new(
        context: &Arc<Context>,
        name: &str,
        entries: u32,
        emits: bool,
    ) -> Result<Self> {
        let image = |part: &str, extent: [u32; 2], usage| {
            Image::new(
                context,
                &ImageInfo {
                    name: &format!("{name}.{part}"),
                    extent: [extent[0], extent[1], 1],
                    format: vk::Format::R32G32B32A32_SFLOAT,
                    three_dimensional: false,
                    usage: vk::ImageUsageFlags::SAMPLED | usage,
                },
            )
        };
        let (copied, stored) = (
            vk::ImageUsageFlags::TRANSFER_DST,
            vk::ImageUsageFlags::STORAGE,
        );
        Ok(Self {
            integrals: image("integrals", [entries, INTEGRAL_ROWS], copied | stored)?,
            table: image("preintegrated", [entries; 2], stored)?,
            emission: image(
                "preintegrated_emission",
                if emits { [entries; 2] } else { [1; 2] },
                stored,
            )?,
        })
    }

    /// See [`Image::forget`].
    pub(crate) fn forget(&self) {
        for image in [&self.integrals, &self.table, &self.emission] {
            image.forget();
        }
    }
}

/// The light passes' lists on the device.
pub(crate) struct LightLists {
    pub(crate) bricks: Buffer,
    pub(crate) trace: Buffer,
    pub(crate) seam: Buffer,
}

impl LightLists {
    /// # Errors
    /// [`Error::OutOfMemory`], or [`Error::Unsupported`] when a list exceeds the device's largest storage buffer.
    pub(crate) fn new(context: &Arc<Context>, name: &str, work: &LightWork) -> Result<Self> {
        let buffer = |part: &str, bytes: &[u8]| {
            let name = format!("{name}.{part}");
            let most = context.capabilities().max_storage_bytes;
            if bytes.len() as u64 > most {
                return Err(Error::Unsupported {
                    device: context.capabilities().name.clone(),
                    need: format!("a storage buffer of {} bytes for {name}", bytes.len()),
                    have: format!("at most {most}"),
                });
            }
            let usage = vk::BufferUsageFlags::STORAGE_BUFFER;
            let mut buffer = Buffer::new(
                context,
                &name,
                bytes.len() as u64,
                usage,
                MemoryLocation::Upload,
            )?;
            buffer.mapped_mut()?[..bytes.len()].copy_from_slice(bytes);
            Ok(buffer)
        };
        Ok(Self {
            bricks: buffer("bricks", bytemuck::cast_slice(&work.bricks))?,
            trace: buffer("trace", bytemuck::cast_slice(&work.trace))?,
            seam: buffer("seam", bytemuck::cast_slice(&work.seam))?,
        })
    }
}
