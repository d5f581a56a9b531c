//! Host mirrors of the structs in `glsl/include/structs.glsl` and of the push constants.

use super::StructLayout;

/// Every mirror. A GLSL struct that the host fills or reads and that is missing here fails `tests/shaders.rs`.
pub const ALL: &[StructLayout] = &[];
