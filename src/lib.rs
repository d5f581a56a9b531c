//! Volume renderer on raw Vulkan compute.

pub mod error;
#[expect(dead_code, reason = "being written")]
pub mod gpu;
pub mod io;
#[cfg(feature = "reference")]
pub mod reference;
pub mod scene;
#[doc(hidden)] // reached by tests/shaders.rs; not part of the API
pub mod shader;
pub mod volume;

pub use error::{Error, Result};
