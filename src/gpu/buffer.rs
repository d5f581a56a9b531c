//! Buffers.

use std::cell::Cell;
use std::sync::Arc;

use ash::vk;

use super::access::Access;
use super::context::Context;
use super::memory::{MemoryBlock, MemoryLocation};
use super::retire::Retired;
use crate::error::{Error, Result};

/// A buffer with its memory. Dropped buffers wait for the frames that may use them.
pub(crate) struct Buffer {
    context: Arc<Context>,
    handle: vk::Buffer,
    block: Option<MemoryBlock>,
    bytes: u64,
    name: String,
    pub(super) access: Cell<Access>,
}

impl Buffer {
    /// A buffer of at least one byte.
    pub(crate) fn new(
        context: &Arc<Context>,
        name: &str,
        bytes: u64,
        usage: vk::BufferUsageFlags,
        location: MemoryLocation,
    ) -> Result<Self> {
        let bytes = bytes.max(4);
        let info = vk::BufferCreateInfo::default()
            .size(bytes)
            .usage(usage)
            .sharing_mode(vk::SharingMode::EXCLUSIVE);
        let device = &context.device;
        // SAFETY: the device is alive (Arc), the info is complete; requirements are asked of the handle just made.
        let (handle, requirements) = unsafe {
            let handle = device
                .create_buffer(&info, None)
                .map_err(|e| context.vulkan_error("vkCreateBuffer", name, e))?;
            (handle, device.get_buffer_memory_requirements(handle))
        };
        let block = match context.allocate_memory(name, requirements, location, true) {
            Ok(block) => block,
            Err(e) => {
                // SAFETY: just made, used by nothing.
                unsafe { device.destroy_buffer(handle, None) };
                return Err(e);
            }
        };
        let buffer = Self {
            context: context.clone(),
            handle,
            bytes,
            name: name.into(),
            access: Cell::new(Access::None),
            block: Some(block),
        };
        if let Some(block) = &buffer.block {
            // SAFETY: fresh handle and fresh memory of its requirements. On failure the buffer's Drop frees both.
            unsafe { device.bind_buffer_memory(handle, block.memory, block.offset) }
                .map_err(|e| context.vulkan_error("vkBindBufferMemory", name, e))?;
        }
        context.debug.name(handle, name);
        Ok(buffer)
    }

    /// A host-visible buffer that holds `data`.
    pub(crate) fn upload(
        context: &Arc<Context>,
        name: &str,
        data: &[u8],
        usage: vk::BufferUsageFlags,
    ) -> Result<Self> {
        let mut buffer = Self::new(
            context,
            name,
            data.len() as u64,
            usage,
            MemoryLocation::Upload,
        )?;
        buffer.mapped_mut()?[..data.len()].copy_from_slice(data);
        Ok(buffer)
    }

    pub(crate) fn handle(&self) -> vk::Buffer {
        self.handle
    }

    /// Recording failed: whether its commands reach the device, and what the buffer holds, is not known.
    pub(crate) fn forget(&self) {
        self.access.set(Access::Unknown);
    }

    pub(crate) fn bytes(&self) -> u64 {
        self.bytes
    }

    fn mapped_pointer(&self) -> Result<*mut u8> {
        self.block
            .as_ref()
            .and_then(|b| b.mapped)
            .map(|p| p.0.as_ptr())
            .ok_or_else(|| Error::Vulkan {
                call: "mapping memory",
                object: self.name.clone(),
                result: vk::Result::ERROR_MEMORY_MAP_FAILED,
            })
    }

    /// The host's view for writing. Callers only write before the frame is recorded or after it has completed.
    pub(crate) fn mapped_mut(&mut self) -> Result<&mut [u8]> {
        let pointer = self.mapped_pointer()?;
        // SAFETY: mapped for the whole block, which is at least `bytes` long and lives as long as `self`; `&mut self`
        // makes this the only host view.
        Ok(unsafe { std::slice::from_raw_parts_mut(pointer, self.bytes as usize) })
    }

    /// One 32-bit word, which the device may be writing at this moment.
    pub(crate) fn read_word(&self, word: usize) -> Result<u32> {
        let pointer = self.mapped_pointer()?.cast::<u32>();
        assert!(
            4 * (word as u64 + 1) <= self.bytes,
            "{} holds word {word}",
            self.name
        );
        // SAFETY: inside the mapped block (asserted) and aligned, as device memory and every allocation in it are. Volatile,
        // without a reference, because the device writes whole words meanwhile.
        Ok(unsafe { pointer.add(word).read_volatile() })
    }

    /// The host's view for reading, after the frame that wrote it has completed.
    pub(crate) fn mapped(&self) -> Result<&[u8]> {
        let pointer = self.mapped_pointer()?;
        // SAFETY: as above; `&self` allows other readers only, and no frame that writes is in flight by contract.
        Ok(unsafe { std::slice::from_raw_parts(pointer, self.bytes as usize) })
    }
}

impl Drop for Buffer {
    fn drop(&mut self) {
        if let Some(block) = self.block.take() {
            self.context
                .retire
                .push(Retired::Buffer(self.handle, block));
        }
    }
}
