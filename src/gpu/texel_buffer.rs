//! Buffers of texels: images that lie in memory as their owner says.

use std::sync::Arc;

use ash::vk;

use super::access::Access;
use super::buffer::Buffer;
use super::context::Context;
use super::memory::MemoryLocation;
use super::retire::Retired;
use crate::error::Result;

/// A device buffer with a view of all of it as texels, for shaders to load and store. Dropped ones wait for the frames that may use them.
pub(crate) struct TexelBuffer {
    context: Arc<Context>,
    view: vk::BufferView,
    buffer: Buffer,
}

impl TexelBuffer {
    /// Room for `bytes`, at most [`TexelBuffer::max_bytes`], of texels of a format that
    /// [storage texel buffers](vk::FormatFeatureFlags::STORAGE_TEXEL_BUFFER) are required to have.
    pub(crate) fn new(
        context: &Arc<Context>,
        name: &str,
        format: vk::Format,
        bytes: u64,
    ) -> Result<Self> {
        Self::located(context, name, format, bytes, MemoryLocation::Device)
    }

    /// Holds `bytes` from the start, where the host writes.
    pub(crate) fn holding(
        context: &Arc<Context>,
        name: &str,
        format: vk::Format,
        bytes: &[u8],
    ) -> Result<Self> {
        let length = bytes.len() as u64;
        let mut texels = Self::located(context, name, format, length, MemoryLocation::Upload)?;
        texels.buffer.mapped_mut()?[..bytes.len()].copy_from_slice(bytes);
        Ok(texels)
    }

    fn located(
        context: &Arc<Context>,
        name: &str,
        format: vk::Format,
        bytes: u64,
        location: MemoryLocation,
    ) -> Result<Self> {
        let usage = vk::BufferUsageFlags::STORAGE_TEXEL_BUFFER | vk::BufferUsageFlags::TRANSFER_DST;
        let mut texels = Self {
            context: context.clone(),
            view: vk::BufferView::null(),
            buffer: Buffer::new(context, name, bytes, usage, location)?,
        };
        let info = vk::BufferViewCreateInfo::default()
            .buffer(texels.buffer.handle())
            .format(format)
            .range(vk::WHOLE_SIZE);
        // SAFETY: the buffer is alive, bound and of that usage; its size was checked against the device's limit by the caller. On
        // failure the null view is dropped with the buffer, which Vulkan ignores.
        texels.view = unsafe { context.device.create_buffer_view(&info, None) }
            .map_err(|e| context.vulkan_error("vkCreateBufferView", name, e))?;
        context.debug.name(texels.view, name);
        Ok(texels)
    }

    /// Most bytes of one whose texels have so many.
    pub(crate) fn max_bytes(context: &Context, texel_bytes: u32) -> u64 {
        let texels = context.capabilities().max_texel_buffer_texels;
        // Drivers that are processors compute places in bytes with 32 bits.
        (u64::from(texels) * u64::from(texel_bytes)).min(1 << 31)
    }

    pub(super) fn view(&self) -> vk::BufferView {
        self.view
    }

    /// For barriers and fills.
    pub(crate) fn buffer(&self) -> &Buffer {
        &self.buffer
    }

    /// How shaders load from it after they, or a transfer, wrote to it.
    pub(crate) const LOADED: Access = Access::SampledGeneral;
}

impl Drop for TexelBuffer {
    fn drop(&mut self) {
        // Before the buffer, which is dropped next.
        self.context.retire.push(Retired::BufferView(self.view));
    }
}
