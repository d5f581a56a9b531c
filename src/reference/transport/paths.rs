//! Multiple scattering by Monte Carlo (Max 1995, section VII.B): null-collision tracking with one majorant for the whole
//! volume, lights by a shadow ray from every scattering, surroundings by paths that leave the volume.

use glam::DVec3;
use rayon::prelude::*;

use super::{Illumination, Incident, Medium};
use crate::reference::Ray;
use crate::scene::View;
use crate::scene::random::Random;

/// Throughput below which paths end at random, without bias.
const ROULETTE: f64 = 0.05;

/// A path tracer. The glow of a volume that nowhere absorbs or scatters is not seen: see [`super::glowing`].
pub struct PathTracer<'a> {
    /// What light goes through.
    pub medium: &'a Medium<'a>,
    /// Where it comes from.
    pub illumination: Illumination<'a>,
    /// Most scatterings of a path; 1 is single scattering with shadows.
    pub max_scatterings: u32,
    /// Where in its pixel a path starts.
    pub start: PathStart,
}

/// Where in its pixel a path starts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PathStart {
    /// In the middle, where rays of the other models start.
    Middle,
    /// Anywhere, with equal chance: the mean over the pixel's area.
    Anywhere,
}

/// A picture of means, and how sure they are.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// Width and height.
    pub size: [u32; 2],
    /// Of every pixel, by rows from the top left.
    pub mean: Vec<DVec3>,
    /// Of that mean.
    pub variance: Vec<DVec3>,
}

impl PathTracer<'_> {
    /// Scattered radiance of every pixel from `samples` paths each, at least 2. A seed gives the same picture whatever the
    /// number of threads.
    pub fn picture(&self, view: &View, size: [u32; 2], samples: u32, seed: u32) -> Estimate {
        let [width, height] = size;
        let (mean, variance) = (0..width * height)
            .into_par_iter()
            .map(|at| {
                let corner = [at % width, at / width].map(f64::from);
                let seed = (u64::from(seed) << 32) | u64::from(at);
                self.mean(samples, seed, |random| {
                    let within = match self.start {
                        PathStart::Middle => [0.5; 2],
                        PathStart::Anywhere => [random.share(), random.share()],
                    };
                    let pixel = [corner[0] + within[0], corner[1] + within[1]];
                    let (origin, direction) = view.ray(pixel, size);
                    Ray { origin, direction }
                })
            })
            .unzip();
        Estimate {
            size,
            mean,
            variance,
        }
    }

    /// Mean of the paths that start with a ray, and the variance of that mean.
    pub fn ray(&self, ray: Ray, samples: u32, seed: u64) -> (DVec3, DVec3) {
        self.mean(samples, seed, |_| ray)
    }

    /// By the sums of Welford (1962).
    fn mean(&self, samples: u32, seed: u64, ray: impl Fn(&mut Random) -> Ray) -> (DVec3, DVec3) {
        let mut random = Random::new(seed);
        let [mut mean, mut squares] = [DVec3::ZERO; 2];
        for n in 1..=samples {
            let start = ray(&mut random);
            let radiance = self.path(start, &mut random);
            let difference = radiance - mean;
            mean += difference / f64::from(n);
            squares += difference * (radiance - mean);
        }
        let n = f64::from(samples);
        (mean, squares / (n * (n - 1.0)))
    }

    /// Radiance that one path brings; light that was never scattered is left out.
    fn path(&self, mut ray: Ray, random: &mut Random) -> DVec3 {
        let mut radiance = DVec3::ZERO;
        let mut throughput = DVec3::ONE;
        let mut scatterings = 0;
        while let Some((place, albedo)) =
            self.next_collision(ray, &mut throughput, &mut radiance, random)
        {
            throughput *= albedo;
            scatterings += 1;
            for incident in self.illumination.incident(place) {
                let phase = self.illumination.phase;
                let phase = phase.evaluate(incident.to_light.dot(ray.direction));
                let reaching = self.unblocked(place, incident, random);
                radiance += throughput * phase * incident.irradiance * reaching;
            }
            let survival = (throughput.max_element() / ROULETTE).min(1.0);
            let ends = scatterings == self.max_scatterings;
            if (ends && self.illumination.surroundings.is_none()) || random.share() >= survival {
                return radiance;
            }
            throughput /= survival;
            ray = Ray {
                origin: place,
                direction: self.scattered(ray.direction, random),
            };
            if ends {
                // The last direction only asks what comes from there.
                let towards = Incident {
                    to_light: ray.direction,
                    distance: f64::INFINITY,
                    irradiance: DVec3::ONE,
                };
                throughput *= self.unblocked(place, towards, random);
                break;
            }
        }
        match self.illumination.surroundings {
            Some(surroundings) if scatterings > 0 => {
                radiance + throughput * surroundings(ray.direction)
            }
            _ => radiance,
        }
    }

    /// Where a ray meets a particle, and its albedo; `None` when it leaves the volume. A tentative collision is real with
    /// the throughput's mean of `tau / majorant`; the throughput takes up what the channels' extinctions differ by.
    ///
    /// Tentative collisions have the density `majorant`: `glow / majorant` at each is the integral of the glow.
    fn next_collision(
        &self,
        ray: Ray,
        throughput: &mut DVec3,
        radiance: &mut DVec3,
        random: &mut Random,
    ) -> Option<(DVec3, DVec3)> {
        let span = self.medium.span(ray)?;
        let majorant = self.medium.majorant();
        let mut distance = span.enter;
        loop {
            distance += free_path(majorant, random);
            let weight = throughput.element_sum();
            if distance >= span.exit || weight <= 0.0 {
                return None;
            }
            let place = ray.origin + ray.direction * distance;
            let optics = self.medium.at(place);
            *radiance += *throughput * optics.glow / majorant;
            let real = optics.extinction / majorant;
            let chance = throughput.dot(real) / weight;
            if random.share() < chance {
                *throughput *= real / chance;
                return Some((place, optics.albedo));
            }
            *throughput *= (1.0 - real) / (1.0 - chance);
        }
    }

    /// Transmittance of the way to a light by ratio tracking (Novák, Selle, Jarosz 2014).
    fn unblocked(&self, place: DVec3, incident: Incident, random: &mut Random) -> DVec3 {
        let ray = Ray {
            origin: place,
            direction: incident.to_light,
        };
        let Some(span) = self.medium.span(ray) else {
            return DVec3::ONE;
        };
        let majorant = self.medium.majorant();
        let end = span.exit.min(incident.distance);
        let mut transmittance = DVec3::ONE;
        let mut distance = span.enter;
        loop {
            distance += free_path(majorant, random);
            if distance >= end || transmittance == DVec3::ZERO {
                return transmittance;
            }
            let place = ray.origin + ray.direction * distance;
            transmittance *= 1.0 - self.medium.at(place).extinction / majorant;
        }
    }

    /// A direction by the phase function.
    fn scattered(&self, direction: DVec3, random: &mut Random) -> DVec3 {
        let cos = self.illumination.phase.quantile(random.share());
        let sin = (1.0 - cos * cos).max(0.0).sqrt();
        let (y, x) = (std::f64::consts::TAU * random.share()).sin_cos();
        let (across, up) = direction.any_orthonormal_pair();
        (direction * cos + (across * x + up * y) * sin).normalize()
    }
}

/// Distance to the next tentative collision, mm; infinite in an empty volume.
fn free_path(majorant: f64, random: &mut Random) -> f64 {
    if majorant > 0.0 {
        -(-random.share()).ln_1p() / majorant
    } else {
        f64::INFINITY
    }
}
