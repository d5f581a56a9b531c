//! The host's instance, device and queue.

mod frames;
mod image;
mod messages;
mod stage;

pub(crate) use frames::{Frame, Frames};
pub(crate) use image::{HostBuffer, HostImage, decode};
pub(crate) use messages::Messages;
pub(crate) use stage::{ATTACHMENT, Look, SAMPLED, Stage, record};

use std::ffi::CStr;
use std::sync::{Arc, Once};

use ash::{ext, vk};
use umbravox::embed::{Context, HostDevice, Requirements};
use umbravox::gpu::HostMemory;

const VALIDATION: &CStr = c"VK_LAYER_KHRONOS_validation";

/// Owns the Vulkan device. Destroyed by [`Host::finish`] alone: a test that panics leaves it to the process's end.
pub(crate) struct Host {
    _entry: ash::Entry,
    pub(crate) instance: ash::Instance,
    messenger: (ext::debug_utils::Instance, vk::DebugUtilsMessengerEXT),
    messages: Arc<Messages>,
    pub(crate) physical_device: vk::PhysicalDevice,
    pub(crate) device: ash::Device,
    pub(crate) queue_family: u32,
    pub(crate) queue: vk::Queue,
    pub(crate) pool: vk::CommandPool,
}

/// Has the layers look for hazards between submissions too, as frames in flight may have. Without effect on releases of the
/// layers that always do. Comes before any instance of a test.
pub(crate) fn validate_across_submissions() {
    static ONCE: Once = Once::new();
    // SAFETY: the loader, drivers and layers read the environment by themselves, but only for an instance, and each test
    // comes here before it makes one; everything else reads it through the standard library, which locks it.
    ONCE.call_once(|| unsafe {
        std::env::set_var(
            "VK_LAYER_ENABLES",
            "VALIDATION_CHECK_ENABLE_SYNCHRONIZATION_VALIDATION_QUEUE_SUBMIT",
        );
    });
}

impl Host {
    /// A device with validation, made as [`Requirements`] asks.
    pub(crate) fn new() -> Self {
        validate_across_submissions();
        let requirements = Requirements::new();
        let messages = Arc::new(Messages::default());
        // SAFETY: the loader stays loaded as long as the entry, which the host keeps.
        let entry = unsafe { ash::Entry::load() }.expect("a Vulkan loader");
        let instance = instance(&entry, &messages, requirements.api_version);
        let functions = ext::debug_utils::Instance::new(&entry, &instance);
        // SAFETY: the extension is enabled; `finish` destroys the messenger before the messages go.
        let messenger =
            unsafe { functions.create_debug_utils_messenger(&messages.messenger_info(), None) }
                .unwrap();
        // SAFETY: the instance is alive.
        let physical_devices = unsafe { instance.enumerate_physical_devices() }.unwrap();
        let (physical_device, queue_family) = physical_devices
            .into_iter()
            .find_map(|physical| Some((physical, general_family(&instance, physical)?)))
            .expect("a device with a queue that draws, computes and copies");
        let queues = [vk::DeviceQueueCreateInfo::default()
            .queue_family_index(queue_family)
            .queue_priorities(&[1.0])];
        let extensions: Vec<_> = requirements
            .device_extensions
            .iter()
            .map(|name| name.as_ptr())
            .collect();
        let info = vk::DeviceCreateInfo::default()
            .queue_create_infos(&queues)
            .enabled_extension_names(&extensions)
            .enabled_features(&requirements.features);
        // SAFETY: the physical device is the instance's, and the queue family is one of its own.
        let device = unsafe { instance.create_device(physical_device, &info, None) }.unwrap();
        let pool_info = vk::CommandPoolCreateInfo::default()
            .queue_family_index(queue_family)
            .flags(vk::CommandPoolCreateFlags::RESET_COMMAND_BUFFER);
        // SAFETY: the device is alive and has one queue of this family.
        let (queue, pool) = unsafe {
            (
                device.get_device_queue(queue_family, 0),
                device.create_command_pool(&pool_info, None).unwrap(),
            )
        };
        Self {
            _entry: entry,
            instance,
            messenger: (functions, messenger),
            messages,
            physical_device,
            device,
            queue_family,
            queue,
            pool,
        }
    }

    /// What the renderer is given.
    pub(crate) fn hand_over(&self, memory: HostMemory) -> HostDevice {
        HostDevice {
            instance: self.instance.clone(),
            physical_device: self.physical_device,
            device: self.device.clone(),
            queue_family: self.queue_family,
            memory,
            pipeline_cache: vk::PipelineCache::null(),
            debug_utils: true,
        }
    }

    /// A context on the device.
    pub(crate) fn context(&self, memory: HostMemory) -> Arc<Context> {
        // SAFETY: the handles belong together; tests drop contexts before `finish`, after the device has finished.
        unsafe { Context::from_host(self.hand_over(memory)) }.unwrap()
    }

    /// Records commands, submits them and waits.
    pub(crate) fn run(&self, record: impl FnOnce(vk::CommandBuffer)) {
        let mut frames = Frames::new(self, 1);
        let frame = frames.begin(self);
        record(frame.cmd);
        frames.submit(self, &frame);
        frames.destroy(self);
    }

    /// Destroys everything; what the layers said until the end, leaks included.
    pub(crate) fn destroy(self) -> Vec<String> {
        // SAFETY: the device is idle after the wait; the host's objects go in the order that Vulkan asks for.
        unsafe {
            self.device.device_wait_idle().unwrap();
            self.device.destroy_command_pool(self.pool, None);
            self.device.destroy_device(None);
            self.messenger
                .0
                .destroy_debug_utils_messenger(self.messenger.1, None);
            self.instance.destroy_instance(None);
        }
        self.messages.all()
    }

    /// Destroys everything; any message of the layers fails.
    pub(crate) fn finish(self) {
        let messages = self.destroy();
        assert!(messages.is_empty(), "\n{}", messages.join("\n\n"));
    }

    /// A memory type among `bits` with `flags`.
    pub(crate) fn memory_type(&self, bits: u32, flags: vk::MemoryPropertyFlags) -> u32 {
        // SAFETY: the physical device is the instance's.
        let properties = unsafe {
            self.instance
                .get_physical_device_memory_properties(self.physical_device)
        };
        let types = properties.memory_types_as_slice();
        let found = types.iter().enumerate().position(|(i, memory_type)| {
            bits >> i & 1 == 1 && memory_type.property_flags.contains(flags)
        });
        found.expect("Vulkan has such memory") as u32
    }
}

fn instance(entry: &ash::Entry, messages: &Arc<Messages>, api_version: u32) -> ash::Instance {
    let app = vk::ApplicationInfo::default()
        .application_name(c"host")
        .api_version(api_version);
    let layers = [VALIDATION.as_ptr()];
    let extensions = [
        ext::debug_utils::NAME.as_ptr(),
        ext::validation_features::NAME.as_ptr(),
    ];
    let enabled = [vk::ValidationFeatureEnableEXT::SYNCHRONIZATION_VALIDATION];
    let mut features = vk::ValidationFeaturesEXT::default().enabled_validation_features(&enabled);
    let mut messenger = messages.messenger_info();
    let info = vk::InstanceCreateInfo::default()
        .application_info(&app)
        .enabled_layer_names(&layers)
        .enabled_extension_names(&extensions)
        .push_next(&mut features)
        .push_next(&mut messenger);
    // SAFETY: the infos live across the call. Layers that are missing are an error, which the test reports.
    unsafe { entry.create_instance(&info, None) }.expect("a driver and the validation layer")
}

/// A queue family that copies to depth images (so it draws) and computes.
fn general_family(instance: &ash::Instance, physical: vk::PhysicalDevice) -> Option<u32> {
    let wanted = vk::QueueFlags::GRAPHICS | vk::QueueFlags::COMPUTE;
    // SAFETY: the physical device is the instance's.
    let families = unsafe { instance.get_physical_device_queue_family_properties(physical) };
    let family = families
        .iter()
        .position(|f| f.queue_flags.contains(wanted))?;
    Some(family as u32)
}
