//! What a device can do, and whether that is enough.

use ash::vk;
use serde::Serialize;

use crate::error::{Error, Result};

/// Vulkan version that is needed.
pub(crate) const API_VERSION: u32 = vk::API_VERSION_1_2;

/// What a host has to enable when it creates its instance and device.
#[derive(Clone, Copy, Debug)]
pub struct Requirements {
    /// Lowest instance and device version.
    pub api_version: u32,
    /// Device extensions: none.
    pub device_extensions: &'static [&'static std::ffi::CStr],
    /// Core features; leave others as you like.
    pub features: vk::PhysicalDeviceFeatures,
}

impl Requirements {
    /// What the renderer needs.
    pub fn new() -> Self {
        Self {
            api_version: API_VERSION,
            device_extensions: &[],
            features: vk::PhysicalDeviceFeatures::default()
                .shader_storage_image_write_without_format(true),
        }
    }
}

impl Default for Requirements {
    fn default() -> Self {
        Self::new()
    }
}

/// One physical device, as listings show it.
#[derive(Clone, Debug, Serialize)]
pub struct DeviceInfo {
    /// Place in the listing; `--device` takes it.
    pub index: usize,
    /// Name, as the driver gives it.
    pub name: String,
    /// Driver name and version.
    pub driver: String,
    /// "discrete", "integrated", "virtual", "cpu" or "other".
    #[serde(rename = "type")]
    pub device_type: String,
    /// Vulkan version of the device.
    pub api_version: String,
    /// Memory of the largest device-local heap, MiB.
    pub memory_mib: u64,
    /// True when the renderer runs on it.
    pub usable: bool,
    /// What is missing where it does not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
}

/// Limits and abilities of a device that the renderer chooses by.
#[derive(Clone, Debug)]
pub struct Capabilities {
    /// Device name.
    pub name: String,
    /// Driver name and version.
    pub driver: String,
    /// Type of device, see [`DeviceInfo::device_type`].
    pub device_type: &'static str,
    /// Largest extent of a 3D image.
    pub max_extent_3d: u32,
    /// Largest extent of a 2D image.
    pub max_extent_2d: u32,
    /// Largest storage buffer, bytes.
    pub max_storage_bytes: u64,
    /// Nanoseconds of a timestamp tick; `None` where the queue has no timestamps.
    pub timestamp_ns: Option<f64>,
    /// Bits of a timestamp that count.
    pub timestamp_mask: u64,
    /// Identifies driver and device to the pipeline cache.
    pub cache_uuid: [u8; vk::UUID_SIZE],
    /// PCI-style vendor and device ids.
    pub ids: [u32; 2],
    /// Rounds that all loops of one invocation may take together: llvmpipe ends loops silently after these.
    pub(crate) max_loop_rounds: Option<u32>,
    /// Runs of consecutive workgroups that the driver cuts a dispatch into, one for each thread; 1 where threads take what comes next.
    pub(crate) dispatch_runs: u32,
    /// Storage images and storage texel buffers that a shader may have.
    pub(crate) max_storage_images: u32,
    /// Texels of a texel buffer.
    pub(crate) max_texel_buffer_texels: u32,
    /// The device is a processor: it reads storage images faster than it fetches or filters texels of sampled ones.
    pub(crate) loads_texels: bool,
    /// The device is a processor, which executes what a branch leaves out, and all rays of a subgroup as far as the longest: it gains
    /// from beams (`glsl/beams.comp`).
    pub(crate) casts_beams: bool,
    /// Subgroups vote in compute shaders.
    pub(crate) votes: bool,
    pub(crate) features: vk::PhysicalDeviceFeatures,
}

/// `LP_MAX_TGSI_LOOP_ITERATIONS` of Mesa's gallivm: one counter for all loops of an invocation.
const LLVMPIPE_LOOP_ROUNDS: u32 = 65_535;

/// Storage images and storage texel buffers that the pass with most of them has (the pre-integrated march).
const STORAGE_IMAGES: u32 = 11;

/// `LP_MAX_THREADS` of Mesa's llvmpipe.
const LLVMPIPE_MAX_THREADS: u32 = 32;

/// Threads that llvmpipe has: those of the processor, or what its environment variable says.
fn llvmpipe_threads() -> u32 {
    let asked = std::env::var("LP_NUM_THREADS").ok();
    let threads = asked.and_then(|n| n.trim().parse().ok()).or_else(|| {
        std::thread::available_parallelism()
            .ok()
            .map(|n| n.get() as u32)
    });
    threads.unwrap_or(1).clamp(1, LLVMPIPE_MAX_THREADS)
}

impl Capabilities {
    /// Reads them.
    ///
    /// # Safety
    /// `physical` belongs to `instance`, which is alive and of version 1.1 at least; `queue_family` exists.
    pub(crate) unsafe fn query(
        instance: &ash::Instance,
        physical: vk::PhysicalDevice,
        queue_family: u32,
    ) -> Self {
        let mut driver = vk::PhysicalDeviceDriverProperties::default();
        let mut subgroups = vk::PhysicalDeviceSubgroupProperties::default();
        let mut properties = vk::PhysicalDeviceProperties2::default()
            .push_next(&mut driver)
            .push_next(&mut subgroups);
        // SAFETY: by this function's contract.
        let (families, features) = unsafe {
            instance.get_physical_device_properties2(physical, &mut properties);
            (
                instance.get_physical_device_queue_family_properties(physical),
                instance.get_physical_device_features(physical),
            )
        };
        let properties = properties.properties;
        let text = |chars: &[std::ffi::c_char]| {
            let bytes: Vec<u8> = chars
                .iter()
                .take_while(|&&c| c != 0)
                .map(|&c| c.to_ne_bytes()[0])
                .collect();
            String::from_utf8_lossy(&bytes).into_owned()
        };
        let llvmpipe = driver.driver_id == vk::DriverId::MESA_LLVMPIPE;
        let bits = families
            .get(queue_family as usize)
            .map_or(0, |f| f.timestamp_valid_bits);
        Self {
            name: text(&properties.device_name),
            driver: format!(
                "{} {}",
                text(&driver.driver_name),
                text(&driver.driver_info)
            ),
            device_type: match properties.device_type {
                vk::PhysicalDeviceType::DISCRETE_GPU => "discrete",
                vk::PhysicalDeviceType::INTEGRATED_GPU => "integrated",
                vk::PhysicalDeviceType::VIRTUAL_GPU => "virtual",
                vk::PhysicalDeviceType::CPU => "cpu",
                _ => "other",
            },
            max_extent_3d: properties.limits.max_image_dimension3_d,
            max_extent_2d: properties.limits.max_image_dimension2_d,
            max_storage_bytes: properties.limits.max_storage_buffer_range.into(),
            timestamp_ns: (bits > 0).then_some(f64::from(properties.limits.timestamp_period)),
            timestamp_mask: if bits >= 64 {
                u64::MAX
            } else {
                (1 << bits) - 1
            },
            max_loop_rounds: llvmpipe.then_some(LLVMPIPE_LOOP_ROUNDS),
            max_storage_images: properties.limits.max_per_stage_descriptor_storage_images,
            max_texel_buffer_texels: properties.limits.max_texel_buffer_elements,
            loads_texels: properties.device_type == vk::PhysicalDeviceType::CPU,
            votes: subgroups
                .supported_stages
                .contains(vk::ShaderStageFlags::COMPUTE)
                && subgroups
                    .supported_operations
                    .contains(vk::SubgroupFeatureFlags::VOTE),
            casts_beams: properties.device_type == vk::PhysicalDeviceType::CPU,
            dispatch_runs: if llvmpipe { llvmpipe_threads() } else { 1 },
            cache_uuid: properties.pipeline_cache_uuid,
            ids: [properties.vendor_id, properties.device_id],
            features,
        }
    }

    /// What is missing for the renderer and what is there instead, `None` when nothing is.
    pub(crate) fn missing(&self) -> Option<(String, String)> {
        let writes = self.features.shader_storage_image_write_without_format != vk::FALSE;
        if !writes {
            return Some((
                "the feature shaderStorageImageWriteWithoutFormat".into(),
                "no such feature".into(),
            ));
        }
        let images = self.max_storage_images;
        (images < STORAGE_IMAGES).then(|| {
            (
                format!("{STORAGE_IMAGES} storage images and texel buffers a shader"),
                format!("at most {images}"),
            )
        })
    }

    pub(crate) fn check(&self) -> Result<()> {
        match self.missing() {
            None => Ok(()),
            Some((need, have)) => Err(Error::Unsupported {
                device: self.name.clone(),
                need,
                have,
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::shader::interface::{DescriptorKind, PASSES};

    #[test]
    fn no_pass_has_more_storage_images_than_devices_are_asked_for() {
        let kinds = [
            DescriptorKind::StorageImage,
            DescriptorKind::StorageTexelBuffer,
        ];
        let of_pass = |pass: &crate::shader::PassInterface| {
            let images = pass.bindings.iter().map(|b| b.kind);
            images.filter(|kind| kinds.contains(kind)).count()
        };
        let most = PASSES.iter().map(of_pass).max();
        assert_eq!(most, Some(super::STORAGE_IMAGES as usize));
    }
}
