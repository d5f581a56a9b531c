//! Images and samplers.

use std::cell::Cell;
use std::sync::Arc;

use ash::vk;

use super::access::Access;
use super::context::Context;
use super::memory::{MemoryBlock, MemoryLocation};
use super::retire::Retired;
use crate::error::Result;

/// What an image is made of.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ImageInfo<'a> {
    pub(crate) name: &'a str,
    pub(crate) extent: [u32; 3],
    pub(crate) format: vk::Format,
    pub(crate) three_dimensional: bool,
    pub(crate) usage: vk::ImageUsageFlags,
}

/// An image of one level and one layer, with a view of all of it. Dropped images wait for the frames that may use them.
pub(crate) struct Image {
    context: Arc<Context>,
    handle: vk::Image,
    view: vk::ImageView,
    block: Option<MemoryBlock>,
    extent: [u32; 3],
    pub(super) access: Cell<Access>,
}

impl Image {
    pub(crate) fn new(context: &Arc<Context>, info: &ImageInfo<'_>) -> Result<Self> {
        let device = &context.device;
        let (image_type, view_type) = if info.three_dimensional {
            (vk::ImageType::TYPE_3D, vk::ImageViewType::TYPE_3D)
        } else {
            (vk::ImageType::TYPE_2D, vk::ImageViewType::TYPE_2D)
        };
        let [width, height, depth] = info.extent;
        let create = vk::ImageCreateInfo::default()
            .image_type(image_type)
            .format(info.format)
            .extent(vk::Extent3D {
                width,
                height,
                depth,
            })
            .mip_levels(1)
            .array_layers(1)
            .samples(vk::SampleCountFlags::TYPE_1)
            .tiling(vk::ImageTiling::OPTIMAL)
            .usage(info.usage)
            .sharing_mode(vk::SharingMode::EXCLUSIVE)
            .initial_layout(vk::ImageLayout::UNDEFINED);
        // SAFETY: the device is alive; extents were checked against the device's limits by the caller.
        let (handle, requirements) = unsafe {
            let handle = device
                .create_image(&create, None)
                .map_err(|e| context.vulkan_error("vkCreateImage", info.name, e))?;
            (handle, device.get_image_memory_requirements(handle))
        };
        let block =
            match context.allocate_memory(info.name, requirements, MemoryLocation::Device, false) {
                Ok(block) => block,
                Err(e) => {
                    // SAFETY: just made, used by nothing.
                    unsafe { device.destroy_image(handle, None) };
                    return Err(e);
                }
            };
        let (memory, offset) = (block.memory, block.offset);
        let mut image = Self {
            context: context.clone(),
            handle,
            view: vk::ImageView::null(),
            block: Some(block),
            extent: info.extent,
            access: Cell::new(Access::None),
        };
        // SAFETY: fresh handle and fresh memory of its requirements. On failure the image's Drop frees both.
        unsafe { device.bind_image_memory(handle, memory, offset) }
            .map_err(|e| context.vulkan_error("vkBindImageMemory", info.name, e))?;
        let view = vk::ImageViewCreateInfo::default()
            .image(handle)
            .view_type(view_type)
            .format(info.format)
            .subresource_range(COLOR_RANGE);
        // SAFETY: the image is alive and bound.
        image.view = unsafe { device.create_image_view(&view, None) }
            .map_err(|e| context.vulkan_error("vkCreateImageView", info.name, e))?;
        context.debug.name(handle, info.name);
        context.debug.name(image.view, info.name);
        Ok(image)
    }

    pub(crate) fn handle(&self) -> vk::Image {
        self.handle
    }

    pub(crate) fn view(&self) -> vk::ImageView {
        self.view
    }

    /// Recording failed: whether its commands reach the device, and what the image holds, is not known.
    pub(crate) fn forget(&self) {
        self.access.set(Access::Unknown);
    }

    /// Bytes of device memory.
    pub(crate) fn bytes(&self) -> u64 {
        self.block.as_ref().map_or(0, |block| block.size)
    }

    /// Texels on x, y, z.
    pub(crate) fn extent(&self) -> [u32; 3] {
        self.extent
    }
}

impl Drop for Image {
    fn drop(&mut self) {
        if let Some(block) = self.block.take() {
            self.context
                .retire
                .push(Retired::Image(self.handle, self.view, block));
        }
    }
}

/// All of a colour image.
pub(crate) const COLOR_RANGE: vk::ImageSubresourceRange = vk::ImageSubresourceRange {
    aspect_mask: vk::ImageAspectFlags::COLOR,
    base_mip_level: 0,
    level_count: 1,
    base_array_layer: 0,
    layer_count: 1,
};

/// All layers of a colour image, for copies.
pub(crate) const COLOR_LAYERS: vk::ImageSubresourceLayers = vk::ImageSubresourceLayers {
    aspect_mask: vk::ImageAspectFlags::COLOR,
    mip_level: 0,
    base_array_layer: 0,
    layer_count: 1,
};

/// Filter of a sampler.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Filter {
    Nearest,
    Linear,
}

/// A sampler.
pub(crate) struct Sampler {
    context: Arc<Context>,
    handle: vk::Sampler,
}

impl Sampler {
    pub(crate) fn new(context: &Arc<Context>, name: &str, filter: Filter) -> Result<Self> {
        let filter = match filter {
            Filter::Nearest => vk::Filter::NEAREST,
            Filter::Linear => vk::Filter::LINEAR,
        };
        // Coordinates never leave the image, so this mode shows nowhere; but llvmpipe filters 8-bit formats with 8-bit
        // weights where all axes clamp or repeat, and in floats where one does not.
        let last_axis = match filter {
            vk::Filter::LINEAR => vk::SamplerAddressMode::MIRRORED_REPEAT,
            _ => vk::SamplerAddressMode::CLAMP_TO_EDGE,
        };
        let info = vk::SamplerCreateInfo::default()
            .mag_filter(filter)
            .min_filter(filter)
            .mipmap_mode(vk::SamplerMipmapMode::NEAREST)
            .address_mode_u(vk::SamplerAddressMode::CLAMP_TO_EDGE)
            .address_mode_v(vk::SamplerAddressMode::CLAMP_TO_EDGE)
            .address_mode_w(last_axis);
        // SAFETY: the device is alive, the info is complete and asks for no feature.
        let handle = unsafe { context.device.create_sampler(&info, None) }
            .map_err(|e| context.vulkan_error("vkCreateSampler", name, e))?;
        context.debug.name(handle, name);
        Ok(Self {
            context: context.clone(),
            handle,
        })
    }

    pub(crate) fn handle(&self) -> vk::Sampler {
        self.handle
    }
}

impl Drop for Sampler {
    fn drop(&mut self) {
        self.context.retire.push(Retired::Sampler(self.handle));
    }
}
