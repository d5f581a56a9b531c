//! An instance, device and queue of our own, for use without a host.

use std::ffi::{CStr, c_void};
use std::sync::{Arc, Mutex, PoisonError};

use ash::{ext, vk};

use super::buffer::Buffer;
use super::capabilities::{API_VERSION, Capabilities, DeviceInfo, Requirements};
use super::context::{Context, HostDevice};
use super::frame_slot::FrameSlot;
use super::image::Image;
use super::memory::HostMemory;
use super::pipeline_cache::PipelineCacheFile;
use super::recorder::{CopyBox, Recorder};
use crate::error::{Error, Result};

const VALIDATION: &CStr = c"VK_LAYER_KHRONOS_validation";

/// What to open.
#[derive(Clone, Debug, Default)]
pub(crate) struct OwnedDeviceInfo {
    /// Index, or part of the name; `None`: the best usable device.
    pub(crate) device: Option<String>,
    /// Validation and synchronization validation; messages are collected.
    pub(crate) validation: bool,
    /// Keep compiled pipelines on disk.
    pub(crate) pipeline_cache: bool,
    /// Memory back end; `None`: gpu-allocator.
    pub(crate) memory: Option<HostMemory>,
}

/// Messages of the validation layer.
#[derive(Default)]
struct Messages(Mutex<Vec<String>>);

struct Instance {
    entry: ash::Entry,
    handle: ash::Instance,
    messenger: Option<(ext::debug_utils::Instance, vk::DebugUtilsMessengerEXT)>,
    messages: Arc<Messages>,
}

/// Collects warnings and errors.
///
/// # Safety
/// Called by Vulkan with the pointer given at creation, to a [`Messages`] that outlives the messenger.
unsafe extern "system" fn collect_message(
    _severity: vk::DebugUtilsMessageSeverityFlagsEXT,
    _types: vk::DebugUtilsMessageTypeFlagsEXT,
    data: *const vk::DebugUtilsMessengerCallbackDataEXT<'_>,
    user: *mut c_void,
) -> vk::Bool32 {
    // SAFETY: by this function's contract; the message is a C string or null.
    let (messages, text) = unsafe {
        let message = (*data).p_message;
        let text = if message.is_null() {
            "validation message without text".into()
        } else {
            CStr::from_ptr(message).to_string_lossy().into_owned()
        };
        (&*user.cast::<Messages>(), text)
    };
    messages
        .0
        .lock()
        .unwrap_or_else(PoisonError::into_inner)
        .push(text);
    vk::FALSE
}

impl Instance {
    fn new(validation: bool) -> Result<Self> {
        // SAFETY: loads the system's Vulkan loader; it stays loaded as long as the entry, which we keep.
        let entry = unsafe { ash::Entry::load() }.map_err(|e| {
            Error::NoDevice(format!(
                "no Vulkan loader: {e}. On Debian and Ubuntu: apt-get install libvulkan1 mesa-vulkan-drivers"
            ))
        })?;
        let app = vk::ApplicationInfo::default()
            .application_name(c"umbravox")
            .engine_name(c"umbravox")
            .api_version(API_VERSION);
        let mut layers = Vec::new();
        let mut extensions = Vec::new();
        if validation {
            // SAFETY: the entry is loaded.
            let there = unsafe { entry.enumerate_instance_layer_properties() }
                .map_err(|e| vulkan("vkEnumerateInstanceLayerProperties", e))?;
            if !there
                .iter()
                .any(|l| l.layer_name_as_c_str() == Ok(VALIDATION))
            {
                return Err(Error::NoDevice(
                    "validation was asked for but VK_LAYER_KHRONOS_validation is not installed. On Debian and \
                     Ubuntu: apt-get install vulkan-validationlayers"
                        .into(),
                ));
            }
            layers.push(VALIDATION.as_ptr());
            extensions.push(ext::debug_utils::NAME.as_ptr());
            extensions.push(ext::validation_features::NAME.as_ptr());
        }
        let messages = Arc::new(Messages::default());
        let mut messenger_info = messenger_info(&messages);
        let enabled = [vk::ValidationFeatureEnableEXT::SYNCHRONIZATION_VALIDATION];
        let mut features =
            vk::ValidationFeaturesEXT::default().enabled_validation_features(&enabled);
        let mut info = vk::InstanceCreateInfo::default()
            .application_info(&app)
            .enabled_layer_names(&layers)
            .enabled_extension_names(&extensions);
        if validation {
            info = info.push_next(&mut features).push_next(&mut messenger_info);
        }
        // SAFETY: the infos live across the call; layers and extensions were found above.
        let handle = unsafe { entry.create_instance(&info, None) }.map_err(|e| {
            Error::NoDevice(format!(
                "Vulkan cannot start: {e}. A driver may be missing; on Debian and Ubuntu: apt-get install mesa-vulkan-drivers"
            ))
        })?;
        let mut instance = Self {
            entry,
            handle,
            messenger: None,
            messages,
        };
        if validation {
            let functions = ext::debug_utils::Instance::new(&instance.entry, &instance.handle);
            let info = self::messenger_info(&instance.messages);
            // SAFETY: the extension is enabled; the messages outlive the messenger (destroyed in Drop before them).
            let messenger = unsafe { functions.create_debug_utils_messenger(&info, None) }
                .map_err(|e| vulkan("vkCreateDebugUtilsMessengerEXT", e))?;
            instance.messenger = Some((functions, messenger));
        }
        Ok(instance)
    }

    /// Every physical device with its compute queue family, capabilities and version.
    fn devices(&self) -> Result<Vec<Candidate>> {
        // SAFETY: the instance is alive.
        let devices = unsafe { self.handle.enumerate_physical_devices() }
            .map_err(|e| vulkan("vkEnumeratePhysicalDevices", e))?;
        Ok(devices
            .into_iter()
            .enumerate()
            .map(|(index, physical)| Candidate::query(&self.handle, index, physical))
            .collect())
    }
}

fn messenger_info(messages: &Arc<Messages>) -> vk::DebugUtilsMessengerCreateInfoEXT<'static> {
    vk::DebugUtilsMessengerCreateInfoEXT::default()
        .message_severity(
            vk::DebugUtilsMessageSeverityFlagsEXT::WARNING
                | vk::DebugUtilsMessageSeverityFlagsEXT::ERROR,
        )
        .message_type(
            vk::DebugUtilsMessageTypeFlagsEXT::VALIDATION
                | vk::DebugUtilsMessageTypeFlagsEXT::PERFORMANCE,
        )
        .pfn_user_callback(Some(collect_message))
        .user_data(Arc::as_ptr(messages).cast_mut().cast())
}

impl Drop for Instance {
    fn drop(&mut self) {
        // SAFETY: everything made from the instance is gone (`OwnedDevice` drops it last); the messenger goes first.
        unsafe {
            if let Some((functions, messenger)) = self.messenger.take() {
                functions.destroy_debug_utils_messenger(messenger, None);
            }
            self.handle.destroy_instance(None);
        }
    }
}

fn vulkan(call: &'static str, result: vk::Result) -> Error {
    Error::Vulkan {
        call,
        object: "umbravox.device".into(),
        result,
    }
}

/// A physical device, judged.
struct Candidate {
    physical: vk::PhysicalDevice,
    queue_family: Option<u32>,
    capabilities: Capabilities,
    info: DeviceInfo,
}

impl Candidate {
    fn query(instance: &ash::Instance, index: usize, physical: vk::PhysicalDevice) -> Self {
        // SAFETY: the physical device belongs to the instance, which is alive and of version 1.2.
        let (families, properties, memory) = unsafe {
            (
                instance.get_physical_device_queue_family_properties(physical),
                instance.get_physical_device_properties(physical),
                instance.get_physical_device_memory_properties(physical),
            )
        };
        let queue_family = families
            .iter()
            .position(|f| f.queue_flags.contains(vk::QueueFlags::COMPUTE))
            .map(|f| f as u32);
        // SAFETY: as above; a family of 0 exists on every device.
        let capabilities =
            unsafe { Capabilities::query(instance, physical, queue_family.unwrap_or(0)) };
        let version = properties.api_version;
        let shown = format!(
            "{}.{}.{}",
            vk::api_version_major(version),
            vk::api_version_minor(version),
            vk::api_version_patch(version)
        );
        let reason = if version < API_VERSION {
            Some(format!("Vulkan 1.2 is needed; it has {shown}"))
        } else if queue_family.is_none() {
            Some("a compute queue is needed; it has none".into())
        } else {
            capabilities
                .missing()
                .map(|(need, have)| format!("{need} is needed; it has {have}"))
        };
        let memory_mib = memory
            .memory_heaps_as_slice()
            .iter()
            .filter(|h| h.flags.contains(vk::MemoryHeapFlags::DEVICE_LOCAL))
            .map(|h| h.size >> 20)
            .max()
            .unwrap_or(0);
        let info = DeviceInfo {
            index,
            name: capabilities.name.clone(),
            driver: capabilities.driver.clone(),
            device_type: capabilities.device_type.into(),
            api_version: shown,
            memory_mib,
            usable: reason.is_none(),
            reason,
        };
        Self {
            physical,
            queue_family,
            capabilities,
            info,
        }
    }

    /// Better devices first.
    fn rank(&self) -> usize {
        ["discrete", "integrated", "virtual", "cpu", "other"]
            .iter()
            .position(|t| *t == self.capabilities.device_type)
            .unwrap_or(usize::MAX)
    }
}

/// Every device that the loader finds.
pub(crate) fn list_devices() -> Result<Vec<DeviceInfo>> {
    Ok(Instance::new(false)?
        .devices()?
        .into_iter()
        .map(|c| c.info)
        .collect())
}

/// The device that a `--device` names; the best usable one without a name.
fn choose(candidates: Vec<Candidate>, wanted: Option<&str>) -> Result<Candidate> {
    let listing = candidates
        .iter()
        .map(|c| match &c.info.reason {
            None => format!("{} ({})", c.info.index, c.info.name),
            Some(reason) => format!("{} ({}: not usable: {reason})", c.info.index, c.info.name),
        })
        .collect::<Vec<_>>()
        .join(", ");
    let listing = if listing.is_empty() {
        "none".into()
    } else {
        listing
    };
    let Some(wanted) = wanted else {
        return candidates
            .into_iter()
            .filter(|c| c.info.usable)
            .min_by_key(Candidate::rank)
            .ok_or_else(|| {
                Error::NoDevice(format!("no usable Vulkan device; devices: {listing}"))
            });
    };
    let by_index = wanted.parse::<usize>().ok();
    let matches = |c: &Candidate| match by_index {
        Some(index) => c.info.index == index,
        None => c.info.name.to_lowercase().contains(&wanted.to_lowercase()),
    };
    let found: Vec<_> = candidates.into_iter().filter(matches).collect();
    let found_any = !found.is_empty();
    found.into_iter().find(|c| c.info.usable).ok_or_else(|| {
        let why = if found_any {
            "is not usable"
        } else {
            "is not there"
        };
        Error::NoDevice(format!("device {wanted:?} {why}; devices: {listing}"))
    })
}

/// A command buffer of ours while [`OwnedDevice::submit`] records it.
pub(crate) struct OwnedRecording {
    command: vk::CommandBuffer,
    index: u64,
}

impl OwnedRecording {
    pub(crate) fn command_buffer(&self) -> vk::CommandBuffer {
        self.command
    }

    /// Number of the frame; all before it have completed.
    pub(crate) fn index(&self) -> u64 {
        self.index
    }
}

/// Owns everything down to the instance. Dropped in order: context (objects), device, instance.
pub(crate) struct OwnedDevice {
    context: Option<Arc<Context>>,
    pub(crate) info: DeviceInfo,
    device: ash::Device,
    queue: vk::Queue,
    pool: vk::CommandPool,
    command: vk::CommandBuffer,
    fence: vk::Fence,
    cache: vk::PipelineCache,
    cache_file: Option<PipelineCacheFile>,
    instance: Instance,
    frame: u64,
}

impl OwnedDevice {
    pub(crate) fn open(open: &OwnedDeviceInfo) -> Result<Self> {
        let instance = Instance::new(open.validation)?;
        let candidate = choose(instance.devices()?, open.device.as_deref())?;
        let queue_family = candidate.queue_family.unwrap_or(0);
        let requirements = Requirements::new();
        let priorities = [1.0];
        let queues = [vk::DeviceQueueCreateInfo::default()
            .queue_family_index(queue_family)
            .queue_priorities(&priorities)];
        let info = vk::DeviceCreateInfo::default()
            .queue_create_infos(&queues)
            .enabled_features(&requirements.features);
        // SAFETY: the physical device is the instance's; features were checked to be there.
        let device = unsafe {
            instance
                .handle
                .create_device(candidate.physical, &info, None)
        }
        .map_err(|e| vulkan("vkCreateDevice", e))?;
        let mut owned = Self {
            context: None,
            info: candidate.info,
            // SAFETY: one queue of this family was created.
            queue: unsafe { device.get_device_queue(queue_family, 0) },
            device,
            pool: vk::CommandPool::null(),
            command: vk::CommandBuffer::null(),
            fence: vk::Fence::null(),
            cache: vk::PipelineCache::null(),
            cache_file: open
                .pipeline_cache
                .then(|| PipelineCacheFile::of_device(&candidate.capabilities))
                .flatten(),
            instance,
            frame: 0,
        };
        owned.create_objects(queue_family)?;
        let host = HostDevice {
            instance: owned.instance.handle.clone(),
            physical_device: candidate.physical,
            device: owned.device.clone(),
            queue_family,
            memory: open.memory.clone().unwrap_or(HostMemory::GpuAllocator),
            pipeline_cache: owned.cache,
            debug_utils: open.validation,
        };
        // SAFETY: the handles are ours, belong together, and are destroyed after the context (Drop), which waits for the
        // device first.
        owned.context = Some(unsafe { Context::from_host(host) }?);
        Ok(owned)
    }

    fn create_objects(&mut self, queue_family: u32) -> Result<()> {
        let device = &self.device;
        let initial = self
            .cache_file
            .as_ref()
            .map(PipelineCacheFile::load)
            .unwrap_or_default();
        let cache = vk::PipelineCacheCreateInfo::default().initial_data(&initial);
        let pool = vk::CommandPoolCreateInfo::default()
            .queue_family_index(queue_family)
            .flags(vk::CommandPoolCreateFlags::RESET_COMMAND_BUFFER);
        // SAFETY: the device is alive; the cache data was written by this driver for this device (checked by `load`).
        // Whatever fails, Drop destroys what was made.
        unsafe {
            self.cache = device
                .create_pipeline_cache(&cache, None)
                .map_err(|e| vulkan("vkCreatePipelineCache", e))?;
            self.pool = device
                .create_command_pool(&pool, None)
                .map_err(|e| vulkan("vkCreateCommandPool", e))?;
            let allocate = vk::CommandBufferAllocateInfo::default()
                .command_pool(self.pool)
                .level(vk::CommandBufferLevel::PRIMARY)
                .command_buffer_count(1);
            self.command = device
                .allocate_command_buffers(&allocate)
                .map_err(|e| vulkan("vkAllocateCommandBuffers", e))?[0];
            self.fence = device
                .create_fence(&vk::FenceCreateInfo::default(), None)
                .map_err(|e| vulkan("vkCreateFence", e))?;
        }
        Ok(())
    }

    /// The context; there as long as the device is.
    pub(crate) fn context(&self) -> &Arc<Context> {
        match &self.context {
            Some(context) => context,
            None => unreachable!("the context lives until Drop"),
        }
    }

    /// Records one frame, submits it and waits for it; all frames before it have completed.
    pub(crate) fn submit<T>(
        &mut self,
        record: impl FnOnce(&OwnedRecording) -> Result<T>,
    ) -> Result<T> {
        self.frame += 1;
        let begin = vk::CommandBufferBeginInfo::default()
            .flags(vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT);
        let device = &self.device;
        // SAFETY: the command buffer's last submission has completed (we wait below), and nobody else uses it.
        unsafe { device.begin_command_buffer(self.command, &begin) }
            .map_err(|e| vulkan("vkBeginCommandBuffer", e))?;
        let recorded = record(&OwnedRecording {
            command: self.command,
            index: self.frame,
        });
        // SAFETY: it is recording.
        unsafe { device.end_command_buffer(self.command) }
            .map_err(|e| vulkan("vkEndCommandBuffer", e))?;
        let value = recorded?;
        let commands = [self.command];
        let submits = [vk::SubmitInfo::default().command_buffers(&commands)];
        let lost = |call, e| match e {
            vk::Result::ERROR_DEVICE_LOST => Error::DeviceLost { last_pass: None },
            e => vulkan(call, e),
        };
        // SAFETY: queue, fence and command buffer are ours and idle.
        unsafe {
            device
                .queue_submit(self.queue, &submits, self.fence)
                .map_err(|e| lost("vkQueueSubmit", e))?;
            device
                .wait_for_fences(&[self.fence], true, u64::MAX)
                .map_err(|e| lost("vkWaitForFences", e))?;
            device
                .reset_fences(&[self.fence])
                .map_err(|e| lost("vkResetFences", e))?;
        }
        Ok(value)
    }

    /// Copies a box of one of our images to the host.
    pub(crate) fn copy_to_host(&mut self, from: &Image, to: &Buffer, part: CopyBox) -> Result<()> {
        let context = self.context().clone();
        let mut slot = FrameSlot::new(&context)?;
        self.submit(|recording| {
            // SAFETY: `submit` hands out a command buffer that is recording and submits in order.
            let mut recorder = unsafe { Recorder::new(&context, recording.command, &mut slot) };
            recorder.read_back(from, to, part);
            Ok(())
        })
    }

    /// Validation messages so far.
    pub(crate) fn validation_messages(&self) -> Vec<String> {
        self.instance
            .messages
            .0
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .clone()
    }
}

impl Drop for OwnedDevice {
    fn drop(&mut self) {
        let device = &self.device;
        // SAFETY: nothing is used any more after the wait; objects go before the device. The context is dropped first: it
        // destroys what renderers retired.
        unsafe {
            if let Err(e) = device.device_wait_idle() {
                tracing::warn!("waiting for the device at the end: {e}");
            }
            drop(self.context.take());
            if let Some(file) = &self.cache_file
                && let Ok(data) = device.get_pipeline_cache_data(self.cache)
            {
                file.store(&data);
            }
            device.destroy_pipeline_cache(self.cache, None);
            device.destroy_fence(self.fence, None);
            device.destroy_command_pool(self.pool, None);
            device.destroy_device(None);
        }
        let _ = &self.instance.entry;
    }
}
