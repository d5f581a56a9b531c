//! What must hold for every scene on the GPU: what changes no pixel, closed forms, levels that agree, light that follows
//! settings and never the camera. Every device validates, and any message is an error.

mod analytic;
mod beams;
mod bits;
mod colors;
mod edits;
#[path = "../common/fields.rs"]
mod fields;
mod gradients;
mod labels;
mod levels;
mod light;
mod limits;
mod packed;
mod random;
mod sessions;
