//! A host that owns its instance, device and queue through raw ash, and has volumes drawn into its frames.
//!
//! Validation and synchronization validation are on in every test, with a messenger of the host's own; [`host::Host::finish`]
//! destroys the device and fails on any message, so that leaked objects fail too. [`canary`] proves that messages arrive.
#![expect(
    unsafe_code,
    reason = "the host calls Vulkan itself, as engines that embed the renderer do"
)]

mod backends;
mod beams;
mod camera;
mod canary;
mod depth;
mod errors;
#[path = "../common/fields.rs"]
#[expect(dead_code, reason = "shared with tests that use the rest")]
mod fields;
mod host;
mod life;
#[cfg(feature = "reference")]
mod pairs;
mod pictures;
mod recovery;
mod scenes;
