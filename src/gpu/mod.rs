//! Raw Vulkan: the only folder, with `embed`, that calls ash.
//!
//! Philosophy: this layer owns handles, lifetimes and synchronization, and knows no volumes and no scenes. Functions are
//! safe where our own types guarantee what Vulkan asks for (objects alive while borrowed, ranges checked against sizes);
//! they are `unsafe fn` where only the caller of the library can. Each valid-usage rule has one owner: what is checked
//! here is not checked again above.
#![expect(
    unsafe_code,
    reason = "every Vulkan command is unsafe; this folder is the boundary"
)]

mod access;
mod buffer;
mod capabilities;
mod context;
mod debug;
mod frame_slot;
mod image;
pub mod memory;
mod owned_device;
mod pipeline;
mod pipeline_cache;
mod recorder;
mod retire;
mod texel_buffer;

pub use capabilities::{Capabilities, DeviceInfo, Requirements};
pub use context::{Context, HostDevice};
pub use memory::HostMemory;

pub(crate) use access::Access;
pub(crate) use buffer::Buffer;
pub(crate) use frame_slot::{FrameSlots, PassTime, Uniforms};
pub(crate) use image::{Filter, Image, ImageInfo, Sampler};
pub(crate) use memory::MemoryLocation;
pub(crate) use owned_device::{OwnedDevice, OwnedDeviceInfo, OwnedRecording, list_devices};
pub(crate) use pipeline::{Bound, Pipeline};
pub(crate) use recorder::{CopyBox, HostTransition, HostUse, Recorder, transition_host_images};
pub(crate) use texel_buffer::TexelBuffer;
