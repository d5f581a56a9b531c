//! Light transport in a volume (Max 1995), channel by channel: what the optical models are tested against.
//!
//! - [`Medium`]: extinction, albedo and glow at any place.
//! - [`Illumination`]: lights, what comes from all around, and the phase function.
//! - [`absorbed`], [`emitted`], [`glowing`], [`scattered_once`]: the integrals of models 1 to 5 along a ray, by quadrature.
//! - [`PathTracer`]: multiple scattering by Monte Carlo, without bias, with the variance of every pixel.
//!
//! Radiance is what the volume adds along a ray. What is behind the volume is left out; it is seen through the
//! transmittance.

mod illumination;
mod medium;
mod paths;
mod quadrature;

pub use illumination::{Illumination, Incident, Surroundings};
pub use medium::{Medium, Optics};
pub use paths::{Estimate, PathStart, PathTracer};
pub use quadrature::{RayLight, absorbed, emitted, glowing, scattered_once};
