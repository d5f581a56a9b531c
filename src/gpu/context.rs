//! The device as the library sees it: the host's handles, memory, the retire queue and the last pass.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use ash::vk;

use super::capabilities::Capabilities;
use super::debug::Debug;
use super::memory::{self, HostMemory, MemoryBackend, MemoryBlock, MemoryLocation, MemoryRequest};
use super::retire::RetireQueue;
use crate::error::{Error, Result};

/// What an engine hands over. Handles and function tables are copied; nothing is ever destroyed, submitted to or waited for.
#[derive(Clone)]
pub struct HostDevice {
    /// Created for Vulkan 1.2 or later.
    pub instance: ash::Instance,
    /// The device's physical device.
    pub physical_device: vk::PhysicalDevice,
    /// Created with what [`super::Requirements`] asks for.
    pub device: ash::Device,
    /// Family of the queue that recorded command buffers are submitted to; it must compute.
    pub queue_family: u32,
    /// Where memory comes from.
    pub memory: HostMemory,
    /// Pipelines are created with it; null: none.
    pub pipeline_cache: vk::PipelineCache,
    /// True when the instance enabled `VK_EXT_debug_utils`: objects get names and passes labels.
    pub debug_utils: bool,
}

/// A device shared by any number of renderers. No global state: several contexts live side by side.
pub struct Context {
    pub(crate) instance: ash::Instance,
    pub(crate) physical_device: vk::PhysicalDevice,
    pub(crate) device: ash::Device,
    pub(crate) pipeline_cache: vk::PipelineCache,
    pub(crate) capabilities: Capabilities,
    pub(crate) debug: Debug,
    pub(crate) retire: RetireQueue,
    memory: Arc<dyn MemoryBackend>,
    allocated: AtomicU64,
}

impl std::fmt::Debug for Context {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Context")
            .field("device", &self.capabilities.name)
            .finish_non_exhaustive()
    }
}

impl Context {
    /// Takes note of a host's device.
    ///
    /// # Errors
    /// [`Error::Unsupported`] when the device lacks something, [`Error::OutOfMemory`] when the memory back end cannot start.
    ///
    /// # Safety
    /// - The handles are valid, belong together, and outlive the context and everything made from it.
    /// - The device was created with what [`super::Requirements`] asks for.
    /// - When the last of the context and of what was made from it is dropped, the device no longer uses any of it. (Single
    ///   renderers may be dropped at any time while the context lives: their objects wait for the host's frame numbers.)
    pub unsafe fn from_host(host: HostDevice) -> Result<Arc<Self>> {
        let HostDevice {
            instance,
            physical_device,
            device,
            queue_family,
            memory,
            pipeline_cache,
            debug_utils,
        } = host;
        // SAFETY: by this function's contract.
        let capabilities = unsafe { Capabilities::query(&instance, physical_device, queue_family) };
        capabilities.check()?;
        // SAFETY: as above.
        let memory = unsafe { memory::backend(memory, &instance, physical_device, &device) }
            .map_err(|detail| Error::OutOfMemory {
                heap: "device",
                what: "umbravox.memory".into(),
                bytes: 0,
                detail,
            })?;
        let debug = Debug::new(&instance, &device, debug_utils);
        Ok(Arc::new(Self {
            instance,
            physical_device,
            device,
            pipeline_cache,
            capabilities,
            debug,
            retire: RetireQueue::default(),
            memory,
            allocated: AtomicU64::new(0),
        }))
    }

    /// Limits and abilities of the device.
    pub fn capabilities(&self) -> &Capabilities {
        &self.capabilities
    }

    /// Device memory that objects of this context hold now, bytes, those waiting to be destroyed included.
    pub fn allocated_bytes(&self) -> u64 {
        self.allocated.load(Ordering::Relaxed)
    }

    /// Name of the memory back end.
    pub fn memory_backend(&self) -> &'static str {
        self.memory.name()
    }

    /// Destroys what was dropped and is no longer used. [`crate::embed`]'s recording calls it too; a host calls it
    /// when renderers were dropped and none records any more.
    ///
    /// # Safety
    /// The device has finished every frame with an index up to `completed`.
    pub unsafe fn collect(&self, completed: u64) {
        // SAFETY: by this function's contract; retired handles came from this context.
        unsafe { self.retire.collect(self, completed) };
    }

    /// True when images of `format` can be uploaded to and sampled.
    pub(crate) fn can_sample(&self, format: vk::Format) -> bool {
        self.format_has(
            format,
            vk::FormatFeatureFlags::SAMPLED_IMAGE | vk::FormatFeatureFlags::TRANSFER_DST,
        )
    }

    /// True when images of `format` can be sampled with a linear filter.
    pub(crate) fn filters_linearly(&self, format: vk::Format) -> bool {
        self.format_has(format, vk::FormatFeatureFlags::SAMPLED_IMAGE_FILTER_LINEAR)
    }

    fn format_has(&self, format: vk::Format, features: vk::FormatFeatureFlags) -> bool {
        // SAFETY: the physical device belongs to the instance, both alive by the contract of `from_host`.
        let properties = unsafe {
            self.instance
                .get_physical_device_format_properties(self.physical_device, format)
        };
        properties.optimal_tiling_features.contains(features)
    }

    pub(crate) fn vulkan_error(
        &self,
        call: &'static str,
        object: &str,
        result: vk::Result,
    ) -> Error {
        if result == vk::Result::ERROR_DEVICE_LOST {
            return Error::DeviceLost { last_pass: None };
        }
        if matches!(
            result,
            vk::Result::ERROR_OUT_OF_DEVICE_MEMORY | vk::Result::ERROR_OUT_OF_HOST_MEMORY
        ) {
            return Error::OutOfMemory {
                heap: if result == vk::Result::ERROR_OUT_OF_HOST_MEMORY {
                    "host"
                } else {
                    "device"
                },
                what: object.into(),
                bytes: 0,
                detail: call.into(),
            };
        }
        Error::Vulkan {
            call,
            object: object.into(),
            result,
        }
    }

    /// Memory for an object, counted.
    pub(crate) fn allocate_memory(
        &self,
        name: &str,
        requirements: vk::MemoryRequirements,
        location: MemoryLocation,
        linear: bool,
    ) -> Result<MemoryBlock> {
        let request = MemoryRequest {
            name,
            requirements,
            location,
            linear,
        };
        let block = self
            .memory
            .allocate(&request)
            .map_err(|detail| Error::OutOfMemory {
                heap: if location == MemoryLocation::Device {
                    "device"
                } else {
                    "host-visible"
                },
                what: name.into(),
                bytes: requirements.size,
                detail,
            })?;
        debug_assert!(
            block.size >= requirements.size,
            "{name}: the memory back end gave too little"
        );
        self.allocated.fetch_add(block.size, Ordering::Relaxed);
        Ok(block)
    }

    /// Gives memory back.
    ///
    /// # Safety
    /// `block` came from this context, is freed once, and no object bound to it is used any more.
    pub(crate) unsafe fn free_memory(&self, block: MemoryBlock) {
        self.allocated.fetch_sub(block.size, Ordering::Relaxed);
        // SAFETY: this function's contract is the back end's.
        unsafe { self.memory.free(block) };
    }
}

impl Drop for Context {
    fn drop(&mut self) {
        // SAFETY: by the contract of `from_host` the device no longer uses anything of this context.
        unsafe { self.retire.collect(self, u64::MAX) };
    }
}
