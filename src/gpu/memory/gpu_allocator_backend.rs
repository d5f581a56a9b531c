//! Memory from the gpu-allocator crate, our own allocator or the host's.

use std::sync::{Arc, Mutex, PoisonError};

use ash::vk;
use gpu_allocator::vulkan::{
    Allocation, AllocationCreateDesc, AllocationScheme, Allocator, AllocatorCreateDesc,
};

use super::{MappedPointer, MemoryBackend, MemoryBlock, MemoryLocation, MemoryRequest};

pub(crate) struct GpuAllocatorBackend {
    allocator: Arc<Mutex<Allocator>>,
}

impl GpuAllocatorBackend {
    pub(crate) fn new(
        instance: ash::Instance,
        physical_device: vk::PhysicalDevice,
        device: ash::Device,
    ) -> Result<Self, String> {
        let allocator = Allocator::new(&AllocatorCreateDesc {
            instance,
            device,
            physical_device,
            debug_settings: Default::default(),
            buffer_device_address: false,
            allocation_sizes: Default::default(),
        })
        .map_err(|e| e.to_string())?;
        Ok(Self::shared(Arc::new(Mutex::new(allocator))))
    }

    pub(crate) fn shared(allocator: Arc<Mutex<Allocator>>) -> Self {
        Self { allocator }
    }
}

// SAFETY: the allocator gives each block memory of the requirements asked for, mapped as a whole where it is host visible, until
// it is freed.
unsafe impl MemoryBackend for GpuAllocatorBackend {
    fn allocate(&self, request: &MemoryRequest<'_>) -> Result<MemoryBlock, String> {
        let location = match request.location {
            MemoryLocation::Device => gpu_allocator::MemoryLocation::GpuOnly,
            MemoryLocation::Upload => gpu_allocator::MemoryLocation::CpuToGpu,
            MemoryLocation::Readback => gpu_allocator::MemoryLocation::GpuToCpu,
        };
        let mut allocator = self
            .allocator
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        let allocation = allocator
            .allocate(&AllocationCreateDesc {
                name: request.name,
                requirements: request.requirements,
                location,
                linear: request.linear,
                allocation_scheme: AllocationScheme::GpuAllocatorManaged,
            })
            .map_err(|e| e.to_string())?;
        Ok(MemoryBlock {
            // SAFETY: the memory is only bound and freed through the back end, never freed or mapped by the handle.
            memory: unsafe { allocation.memory() },
            offset: allocation.offset(),
            size: allocation.size(),
            mapped: allocation.mapped_ptr().map(|p| MappedPointer(p.cast())),
            token: Box::new(allocation),
        })
    }

    unsafe fn free(&self, block: MemoryBlock) {
        match block.token.downcast::<Allocation>() {
            Ok(allocation) => {
                let mut allocator = self
                    .allocator
                    .lock()
                    .unwrap_or_else(PoisonError::into_inner);
                if let Err(e) = allocator.free(*allocation) {
                    tracing::error!("gpu-allocator could not free memory: {e}");
                }
            }
            Err(_) => tracing::error!("a memory block was given back to another back end"),
        }
    }

    fn name(&self) -> &'static str {
        "gpu-allocator"
    }
}
