//! The volume rendering integrals of the models that follow light along straight lines.
//!
//! A ray is cut into short segments; properties are those of their middles, and each segment is integrated as the
//! homogeneous medium that it nearly is: the error falls with the square of the step.

use glam::DVec3;

use super::{Illumination, Medium, Optics};
use crate::analytic::mean_transmittance;
use crate::reference::{Ray, Segment};
use crate::scene::PhaseFunction;

/// Directions that light from all around is looked up in: polar angles, and azimuths of each.
const POLAR: u32 = 32;
const AZIMUTHS: u32 = 32;

/// What a ray through the volume brings to the eye.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayLight {
    /// Added by the volume.
    pub radiance: DVec3,
    /// Share of what is behind the volume that gets through.
    pub transmittance: DVec3,
}

/// Absorption only: `I = I_0 T` (eq. 2 and 3).
pub fn absorbed(medium: &Medium, ray: Ray, step: f64) -> RayLight {
    integrate(medium, ray, step, |_, _| DVec3::ZERO)
}

/// Emission only: `I = I_0 + integral g ds` with `g = C tau + E` (eq. 4 and 5); nothing is in its way.
pub fn emitted(medium: &Medium, ray: Ray, step: f64) -> RayLight {
    let mut radiance = DVec3::ZERO;
    for segment in segments(medium, ray, step) {
        let optics = medium.at(ray.origin + ray.direction * segment.middle());
        radiance += (optics.color * optics.extinction + optics.glow) * segment.length();
    }
    RayLight {
        radiance,
        transmittance: DVec3::ONE,
    }
}

/// Absorption and emission: `I = I_0 T + integral g T' ds` with `g = C tau + E` (eq. 7 and 8).
pub fn glowing(medium: &Medium, ray: Ray, step: f64) -> RayLight {
    integrate(medium, ray, step, |_, optics| {
        optics.color * optics.extinction + optics.glow
    })
}

/// Single scattering (eq. 9 and 12 to 14): `g = E + albedo tau integral p(w, w') L(w') dw'`. With `shadows` the volume
/// itself is in the way of the light (eq. 13), without them it is not.
pub fn scattered_once(
    medium: &Medium,
    illumination: &Illumination,
    ray: Ray,
    step: f64,
    shadows: bool,
) -> RayLight {
    let reaching = |from: Ray, distance: f64| {
        if shadows {
            transmittance(medium, from, distance, step)
        } else {
            DVec3::ONE
        }
    };
    // Light flows along -direction, and scattered light along -ray.direction: the cosine of forward is 1.
    let phase = |towards: DVec3| illumination.phase.evaluate(towards.dot(ray.direction));
    integrate(medium, ray, step, |place, optics| {
        let from = |direction| Ray {
            origin: place,
            direction,
        };
        let mut scattered = DVec3::ZERO;
        for incident in illumination.incident(place) {
            let through = reaching(from(incident.to_light), incident.distance);
            scattered += phase(incident.to_light) * incident.irradiance * through;
        }
        if let Some(radiance) = illumination.surroundings {
            scattered += mean_scattered(illumination.phase, ray.direction, |towards| {
                radiance(towards) * reaching(from(towards), f64::INFINITY)
            });
        }
        optics.glow + optics.albedo * optics.extinction * scattered
    })
}

/// Transmittance of the way along a ray up to a distance, mm.
fn transmittance(medium: &Medium, ray: Ray, distance: f64, step: f64) -> DVec3 {
    let mut depth = DVec3::ZERO;
    for segment in segments(medium, ray, step).take_while(|s| s.start < distance) {
        let [start, end] = [segment.start, segment.end.min(distance)];
        let place = ray.origin + ray.direction * (0.5 * (start + end));
        depth += medium.at(place).extinction * (end - start);
    }
    (-depth).exp()
}

fn segments(medium: &Medium, ray: Ray, step: f64) -> impl Iterator<Item = Segment> {
    let span = medium.span(ray);
    span.into_iter()
        .flat_map(move |span| span.segments(step, 0.0))
}

/// Radiance that `source` (per mm, at a place) brings to the eye through the medium.
fn integrate(
    medium: &Medium,
    ray: Ray,
    step: f64,
    source: impl Fn(DVec3, &Optics) -> DVec3,
) -> RayLight {
    let mut light = RayLight {
        radiance: DVec3::ZERO,
        transmittance: DVec3::ONE,
    };
    for segment in segments(medium, ray, step) {
        let place = ray.origin + ray.direction * segment.middle();
        let optics = medium.at(place);
        let depth = optics.extinction * segment.length();
        // integral_0^d exp(-tau s) ds = d (1 - exp(-x)) / x with x = tau d.
        let length = segment.length() * DVec3::from_array(depth.to_array().map(mean_transmittance));
        light.radiance += light.transmittance * source(place, &optics) * length;
        light.transmittance *= (-depth).exp();
    }
    light
}

/// Integral over the sphere of a phase function times radiance: the mean of the radiance from directions among which the
/// scattered light is shared out equally. Exact where the radiance is the same from everywhere.
fn mean_scattered(phase: &PhaseFunction, axis: DVec3, radiance: impl Fn(DVec3) -> DVec3) -> DVec3 {
    let (across, up) = axis.any_orthonormal_pair();
    let mut sum = DVec3::ZERO;
    for i in 0..POLAR {
        let cos = phase.quantile((f64::from(i) + 0.5) / f64::from(POLAR));
        let sin = (1.0 - cos * cos).max(0.0).sqrt();
        for j in 0..AZIMUTHS {
            let azimuth = std::f64::consts::TAU * (f64::from(j) + 0.5) / f64::from(AZIMUTHS);
            let (y, x) = azimuth.sin_cos();
            sum += radiance(axis * cos + (across * x + up * y) * sin);
        }
    }
    sum / f64::from(POLAR * AZIMUTHS)
}
