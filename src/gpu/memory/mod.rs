//! Where device memory comes from: ours, the host's allocator, or anything that implements [`MemoryBackend`].

mod gpu_allocator_backend;
#[cfg(feature = "vk-mem")]
mod vma_backend;

use std::any::Any;
use std::ptr::NonNull;
use std::sync::{Arc, Mutex};

use ash::vk;

pub(crate) use gpu_allocator_backend::GpuAllocatorBackend;
#[cfg(feature = "vk-mem")]
pub(crate) use vma_backend::VmaBackend;

/// Where an object should live.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MemoryLocation {
    /// Fast for the device.
    Device,
    /// Host visible and coherent, written by the host once and in order.
    Upload,
    /// Host visible and coherent, read by the host.
    Readback,
}

/// What an object asks for.
#[derive(Clone, Copy, Debug)]
pub struct MemoryRequest<'a> {
    /// Debug name of the object.
    pub name: &'a str,
    /// Size, alignment and types allowed.
    pub requirements: vk::MemoryRequirements,
    /// Where it should live.
    pub location: MemoryLocation,
    /// True for buffers, false for images of optimal tiling.
    pub linear: bool,
}

/// Memory given to one object.
#[derive(Debug)]
pub struct MemoryBlock {
    /// The memory object to bind.
    pub memory: vk::DeviceMemory,
    /// Offset to bind at, bytes.
    pub offset: u64,
    /// Bytes.
    pub size: u64,
    /// Where the host sees it; always there for [`MemoryLocation::Upload`] and [`MemoryLocation::Readback`], which must
    /// be coherent and stay mapped.
    pub mapped: Option<MappedPointer>,
    /// What the back end needs to free it.
    pub token: Box<dyn Any + Send + Sync>,
}

/// Address of mapped device memory.
#[derive(Clone, Copy, Debug)]
pub struct MappedPointer(pub NonNull<u8>);

// SAFETY: only an address; who may read and write it, and when, is decided by the exclusive borrow of the `Buffer` that
// owns the memory block.
unsafe impl Send for MappedPointer {}
// SAFETY: as above; sharing the address alone allows nothing.
unsafe impl Sync for MappedPointer {}

/// A source of device memory. Implement it to bring your own allocator.
///
/// # Safety
/// A block that `allocate` returns satisfies the requirements asked for (size, alignment, memory types), is nobody else's until
/// it is freed, and where `mapped` is there it points to all `size` bytes of it, host coherent, as long as the block lives.
pub unsafe trait MemoryBackend: Send + Sync {
    /// Finds memory for an object.
    ///
    /// # Errors
    /// What the allocator says, as a text for the user; the library adds what asked for how much.
    fn allocate(&self, request: &MemoryRequest<'_>) -> Result<MemoryBlock, String>;

    /// Gives memory back.
    ///
    /// # Safety
    /// `block` came from this back end, is freed once, and no object bound to it is used any more.
    unsafe fn free(&self, block: MemoryBlock);

    /// Name for listings.
    fn name(&self) -> &'static str;
}

/// Which allocator the library uses, chosen by value.
#[derive(Clone)]
#[non_exhaustive]
pub enum HostMemory {
    /// A gpu-allocator of our own on the given device.
    GpuAllocator,
    /// A VMA allocator of our own on the given device.
    #[cfg(feature = "vk-mem")]
    Vma,
    /// The host's gpu-allocator; locked only while memory is taken or given back.
    SharedGpuAllocator(Arc<Mutex<gpu_allocator::vulkan::Allocator>>),
    /// The host's VMA allocator.
    #[cfg(feature = "vk-mem")]
    SharedVma(Arc<vk_mem::Allocator>),
    /// Anything else.
    Custom(Arc<dyn MemoryBackend>),
}

impl std::fmt::Debug for HostMemory {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::GpuAllocator => "GpuAllocator",
            #[cfg(feature = "vk-mem")]
            Self::Vma => "Vma",
            Self::SharedGpuAllocator(_) => "SharedGpuAllocator",
            #[cfg(feature = "vk-mem")]
            Self::SharedVma(_) => "SharedVma",
            Self::Custom(_) => "Custom",
        })
    }
}

/// Makes the back end that `choice` names.
///
/// # Safety
/// As [`crate::gpu::Context::from_host`]: the handles are alive and belong together.
pub(crate) unsafe fn backend(
    choice: HostMemory,
    instance: &ash::Instance,
    physical: vk::PhysicalDevice,
    device: &ash::Device,
) -> Result<Arc<dyn MemoryBackend>, String> {
    Ok(match choice {
        HostMemory::GpuAllocator => Arc::new(GpuAllocatorBackend::new(
            instance.clone(),
            physical,
            device.clone(),
        )?),
        #[cfg(feature = "vk-mem")]
        // SAFETY: passed on.
        HostMemory::Vma => Arc::new(unsafe { VmaBackend::new(instance, physical, device) }?),
        HostMemory::SharedGpuAllocator(shared) => Arc::new(GpuAllocatorBackend::shared(shared)),
        #[cfg(feature = "vk-mem")]
        HostMemory::SharedVma(shared) => Arc::new(VmaBackend::shared(shared)),
        HostMemory::Custom(custom) => custom,
    })
}
