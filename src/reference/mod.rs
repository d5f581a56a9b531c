//! The scalar f64 renderer that the GPU is tested against.
//!
//! Every formula is written out as it stands in the literature, one sample after another, with no table, no
//! skipping and no levels of detail: the volume at full resolution. It shares the scene's types with the
//! renderer and no code with any shader.
//!
//! - [`Field`]: the scalar field between the voxels, by [`CubicKernel`]s too, and estimates of its gradient.
//! - [`march`]: a picture by emission and absorption along rays (Max 1995), or by another projection.
//! - [`preintegrate`]: the transfer function along a segment (Engel, Kraus, Ertl 2001).
//! - [`light`]: local ambient occlusion at every voxel (Hernell, Ljung, Ynnerman 2007).
//! - [`transport`]: the optical models of Max (1995), by quadrature and by Monte Carlo.
//! - [`analytic`]: closed forms for fields that have one.

mod classify;
mod composite;
mod light;
mod march;
mod preintegration;
mod probe;
mod projection;
mod ray;
pub mod transport;

pub use crate::analytic;
pub use crate::field::{CubicKernel, Field};
pub use classify::Contribution;
pub use light::{Light, LightGrid, light, light_at};
pub use march::{Picture, Pixel, Setup, march, march_ray};
pub use preintegration::preintegrate;
pub use ray::{MERGED_REMAINDER, Ray, Segment, Span};

/// Opacity over `exponent` reference lengths of a medium with `opacity` over one: `1 - (1 - a)^e`.
fn opacity_over(opacity: f64, exponent: f64) -> f64 {
    1.0 - (1.0 - opacity).powf(exponent)
}
