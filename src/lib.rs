//! Volume renderer on raw Vulkan compute.

pub mod error;
pub mod io;
#[cfg(feature = "reference")]
pub mod reference;
pub mod scene;
pub mod volume;

pub use error::{Error, Result};
