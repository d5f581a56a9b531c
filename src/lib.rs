//! Volume renderer on raw Vulkan compute.

pub mod error;
pub mod headless;
pub mod io;
#[cfg(feature = "image-io")]
pub mod output;
pub mod picture;
#[cfg(feature = "reference")]
pub mod reference;
pub mod scene;
pub mod volume;

pub use error::{Error, Result};
