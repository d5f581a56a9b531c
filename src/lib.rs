//! Volume renderer on raw Vulkan compute.

pub mod analytic;
mod atlas;
pub mod conformance;
pub mod embed;
pub mod error;
pub mod field;
pub mod gpu;
pub mod headless;
pub mod io;
pub mod occlusion;
#[cfg(feature = "image-io")]
pub mod output;
mod pass;
pub mod picture;
#[cfg(feature = "reference")]
pub mod reference;
pub mod renderer;
pub mod scene;
#[doc(hidden)] // reached by tests/shaders.rs; not part of the API
pub mod shader;
pub mod volume;

pub use error::{Error, Result};
