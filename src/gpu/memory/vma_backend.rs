//! Memory from AMD's Vulkan Memory Allocator, our own allocator or the host's.

use std::ptr::NonNull;
use std::sync::Arc;

use ash::vk;
use vk_mem::{
    Alloc as _, Allocation, AllocationCreateFlags, AllocationCreateInfo, Allocator, MemoryUsage,
};

use super::{MappedPointer, MemoryBackend, MemoryBlock, MemoryLocation, MemoryRequest};

pub(crate) struct VmaBackend {
    allocator: Arc<Allocator>,
}

/// Given back by value; VMA's allocations are plain handles.
struct Token(Allocation);

// SAFETY: a handle that is only used to free the allocation, through the allocator, which locks by itself.
unsafe impl Send for Token {}
// SAFETY: as above.
unsafe impl Sync for Token {}

impl VmaBackend {
    /// # Safety
    /// The handles are alive, belong together and outlive the back end.
    pub(crate) unsafe fn new(
        instance: &ash::Instance,
        physical: vk::PhysicalDevice,
        device: &ash::Device,
    ) -> Result<Self, String> {
        let mut info = vk_mem::AllocatorCreateInfo::new(instance, device, physical);
        info.vulkan_api_version = vk::API_VERSION_1_2;
        // SAFETY: passed on from this function's contract.
        let allocator = unsafe { Allocator::new(info) }.map_err(|e| e.to_string())?;
        Ok(Self::shared(Arc::new(allocator)))
    }

    pub(crate) fn shared(allocator: Arc<Allocator>) -> Self {
        Self { allocator }
    }
}

// SAFETY: the allocator gives each block memory of the requirements asked for, mapped as a whole where it is host visible, until
// it is freed.
unsafe impl MemoryBackend for VmaBackend {
    fn allocate(&self, request: &MemoryRequest<'_>) -> Result<MemoryBlock, String> {
        let coherent =
            vk::MemoryPropertyFlags::HOST_VISIBLE | vk::MemoryPropertyFlags::HOST_COHERENT;
        let (required, preferred, flags) = match request.location {
            MemoryLocation::Device => (
                vk::MemoryPropertyFlags::empty(),
                vk::MemoryPropertyFlags::DEVICE_LOCAL,
                AllocationCreateFlags::empty(),
            ),
            MemoryLocation::Upload => (
                coherent,
                vk::MemoryPropertyFlags::empty(),
                AllocationCreateFlags::MAPPED,
            ),
            MemoryLocation::Readback => (
                coherent,
                vk::MemoryPropertyFlags::HOST_CACHED,
                AllocationCreateFlags::MAPPED,
            ),
        };
        // Memory of buffers and of optimal images is not mixed: VMA cannot know the resource type of raw requirements,
        // so each object of the latter kind gets a dedicated block.
        let flags = if request.linear {
            flags
        } else {
            flags | AllocationCreateFlags::DEDICATED_MEMORY
        };
        let info = AllocationCreateInfo {
            flags,
            usage: MemoryUsage::Unknown,
            required_flags: required,
            preferred_flags: preferred,
            ..Default::default()
        };
        // SAFETY: requirements come from Vulkan, the allocator is alive.
        let allocation = unsafe { self.allocator.allocate_memory(&request.requirements, &info) }
            .map_err(|e| e.to_string())?;
        let placed = self.allocator.get_allocation_info(&allocation);
        Ok(MemoryBlock {
            memory: placed.device_memory,
            offset: placed.offset,
            size: placed.size,
            mapped: NonNull::new(placed.mapped_data.cast()).map(MappedPointer),
            token: Box::new(Token(allocation)),
        })
    }

    unsafe fn free(&self, block: MemoryBlock) {
        match block.token.downcast::<Token>() {
            Ok(mut token) => {
                // SAFETY: by contract the block came from this allocator and is freed once.
                unsafe { self.allocator.free_memory(&mut token.0) };
            }
            Err(_) => tracing::error!("a memory block was given back to another back end"),
        }
    }

    fn name(&self) -> &'static str {
        "vma"
    }
}
