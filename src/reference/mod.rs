//! The scalar f64 renderer that the GPU is tested against.
