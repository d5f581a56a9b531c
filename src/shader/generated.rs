//! SPIR-V modules and the ids of their interface.
//!
//! Written by `cargo xtask shaders` from `glsl/`. Do not edit.

use super::Module;

/// Every module, by name.
#[rustfmt::skip]
pub static MODULES: &[&Module] = &[
];
