//! The cloud of Max's figures: ellipsoidal densities, their edges made ragged by fractal noise.

use glam::DVec3;
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::noise::Noise;
use crate::error::{Error, Result};
use crate::scene::random::Random;
use crate::scene::validate::{
    Number, all_finite, finite, not_negative, numbers, positive, require,
};
use crate::volume::{MIN_SIZE, Volume, Voxels};

/// Most voxels of a procedural volume: 2 GiB.
const MAX_VOXELS: u64 = 512 << 20;
/// Most ellipsoids.
const MAX_ELLIPSOIDS: usize = 256;
/// Most octaves of noise.
const MAX_OCTAVES: u32 = 16;
/// Height of a cumulus cloud's base, and up to where it fades in, shares of the volume's height.
const BASE: [f64; 2] = [0.16, 0.24];

/// A cloud: at a place where `s` is the sum of the densities of the ellipsoids and `n` the noise in `[0,1]`, the value is
/// `s - turbulence max(0, 1 - s) n`, clamped to `[0,1]`. So noise eats into the edges and never fills what is empty.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Cloud {
    /// Voxels on x, y, z. Default 96, 96, 72: Max's 24, 24, 18, four times as fine.
    #[schemars(inner(range(min = 2)))]
    pub size: [u32; 3],
    /// Distance between voxels on x, y, z, mm. Default 1.
    pub spacing: [f64; 3],
    /// Of the noise, and of the ellipsoids that are not given. Default 1.
    pub seed: u32,
    /// Number of ellipsoids that are not given, 1 to 256: heaped up on a flat base. Default 24.
    #[schemars(range(min = 1, max = 256))]
    pub count: u32,
    /// The ellipsoids, in place of `count`; without a base.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ellipsoids: Option<Vec<Ellipsoid>>,
    /// Strength of the noise, >= 0. Default 2.
    pub turbulence: f64,
    /// Cells of the coarsest noise along the longest extent, > 0. Default 7.
    pub frequency: f64,
    /// Octaves of the noise, 0 to 16. Default 5.
    #[schemars(range(max = 16))]
    pub octaves: u32,
}

/// An ellipsoid of density `density max(0, 1 - q)`, `q` the squared distance from the centre in radii.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Ellipsoid {
    /// Shares of the volume's extents.
    pub center: [f64; 3],
    /// Shares of the volume's extents, > 0.
    pub radii: [f64; 3],
    /// In its centre, >= 0. Default 1.
    #[serde(default = "unit_density")]
    pub density: f64,
}

fn unit_density() -> f64 {
    1.0
}

impl Default for Cloud {
    fn default() -> Self {
        Self {
            size: [96, 96, 72],
            spacing: [1.0; 3],
            seed: 1,
            count: 24,
            ellipsoids: None,
            turbulence: 2.0,
            frequency: 7.0,
            octaves: 5,
        }
    }
}

impl Cloud {
    pub(super) fn validate(&self) -> Result<()> {
        let at = |key: &str| format!("volume.procedural.{key}");
        let count = self.size.iter().map(|&n| u64::from(n));
        let count = count.fold(1, |product: u64, n| product.saturating_mul(n));
        require(
            self.size.iter().all(|&n| n >= MIN_SIZE) && count <= MAX_VOXELS,
            &at("size"),
            self.size,
            &format!("three whole numbers >= {MIN_SIZE}, {MAX_VOXELS} voxels at most"),
        )?;
        require(
            self.spacing.into_iter().all(positive),
            &at("spacing"),
            numbers(self.spacing),
            "three numbers > 0 (mm)",
        )?;
        require(
            (1..=MAX_ELLIPSOIDS as u32).contains(&self.count),
            &at("count"),
            self.count,
            &format!("a whole number from 1 to {MAX_ELLIPSOIDS}"),
        )?;
        require(
            not_negative(self.turbulence),
            &at("turbulence"),
            Number(self.turbulence),
            "a number >= 0",
        )?;
        require(
            positive(self.frequency) && self.frequency <= 1e6,
            &at("frequency"),
            Number(self.frequency),
            "a number > 0 and <= 1000000",
        )?;
        require(
            self.octaves <= MAX_OCTAVES,
            &at("octaves"),
            self.octaves,
            &format!("a whole number from 0 to {MAX_OCTAVES}"),
        )?;
        let Some(ellipsoids) = &self.ellipsoids else {
            return Ok(());
        };
        require(
            (1..=MAX_ELLIPSOIDS).contains(&ellipsoids.len()),
            &at("ellipsoids"),
            format_args!("a list of {}", ellipsoids.len()),
            &format!("1 to {MAX_ELLIPSOIDS} ellipsoids"),
        )?;
        for (i, ellipsoid) in ellipsoids.iter().enumerate() {
            let at = |key: &str| at(&format!("ellipsoids.{i}.{key}"));
            let Ellipsoid {
                center,
                radii,
                density,
            } = *ellipsoid;
            let wanted = "three finite numbers (shares of the volume)";
            require(all_finite(center), &at("center"), numbers(center), wanted)?;
            let wanted = "three numbers > 0 (shares of the volume)";
            let valid = radii.into_iter().all(|r| finite(r) && r >= 1e-6);
            require(valid, &at("radii"), numbers(radii), wanted)?;
            let valid = not_negative(density);
            require(valid, &at("density"), Number(density), "a number >= 0")?;
        }
        Ok(())
    }

    /// Voxels from 0 to 1, the first in the origin.
    pub(super) fn volume(&self) -> Result<Volume> {
        self.validate()?;
        let [width, height, depth] = self.size.map(|n| n as usize);
        // `validate` has bounded the product.
        let count = width * height * depth;
        let mut voxels: Vec<f32> = Vec::new();
        voxels
            .try_reserve_exact(count)
            .map_err(|e| Error::OutOfMemory {
                heap: "host",
                what: "procedural cloud".to_owned(),
                bytes: 4 * count as u64,
                detail: e.to_string(),
            })?;
        voxels.resize(count, 0.0);
        let field = self.field();
        let last = DVec3::from_array(self.size.map(|n| f64::from(n - 1)));
        voxels
            .par_chunks_mut(width)
            .enumerate()
            .for_each(|(row, voxels)| {
                let [j, k] = [row % height, row / height].map(|n| n as f64);
                for (i, voxel) in voxels.iter_mut().enumerate() {
                    *voxel = field.at(DVec3::new(i as f64, j, k) / last) as f32;
                }
            });
        Volume::axis_aligned(Voxels::F32(voxels), self.size, self.spacing)
    }

    fn field(&self) -> Field<'_> {
        let extent = DVec3::from_array(self.size.map(|n| f64::from(n - 1)))
            * DVec3::from_array(self.spacing);
        Field {
            cloud: self,
            ellipsoids: match &self.ellipsoids {
                Some(ellipsoids) => ellipsoids.clone(),
                None => cumulus(self.count, self.seed),
            },
            noise: Noise::new(self.seed),
            noise_from_share: extent / extent.max_element() * self.frequency,
        }
    }
}

/// What the value of a place is computed from.
struct Field<'a> {
    cloud: &'a Cloud,
    ellipsoids: Vec<Ellipsoid>,
    noise: Noise,
    /// Noise cells along the volume's extents: as large in mm on every axis.
    noise_from_share: DVec3,
}

impl Field<'_> {
    /// Value at a place, in shares of the volume's extents.
    fn at(&self, place: DVec3) -> f64 {
        let mut sum: f64 = self.ellipsoids.iter().map(|e| e.density_at(place)).sum();
        if self.cloud.ellipsoids.is_none() {
            sum *= smoothstep(BASE, place.z);
        }
        if sum <= 0.0 {
            return 0.0;
        }
        let noise = self
            .noise
            .fractal(place * self.noise_from_share, self.cloud.octaves);
        let eaten = self.cloud.turbulence * (1.0 - sum).max(0.0) * 0.5 * (1.0 + noise);
        (sum - eaten).clamp(0.0, 1.0)
    }
}

impl Ellipsoid {
    fn density_at(&self, place: DVec3) -> f64 {
        let in_radii = (place - DVec3::from_array(self.center)) / DVec3::from_array(self.radii);
        self.density * (1.0 - in_radii.length_squared()).max(0.0)
    }
}

/// Heaps of a cumulus cloud: one wide base, and smaller ones on it, the higher the nearer to the middle.
fn cumulus(count: u32, seed: u32) -> Vec<Ellipsoid> {
    let mut random = Random::new(seed.into());
    let base = Ellipsoid {
        center: [0.5, 0.5, 0.24],
        radii: [0.42, 0.36, 0.2],
        density: 1.2,
    };
    let heaps = (1..count).map(|_| {
        let angle = std::f64::consts::TAU * random.share();
        let outward = random.share().sqrt();
        let height = (1.0 - outward * outward) * random.share();
        let radius = 0.1 + 0.1 * (1.0 - outward) + 0.04 * random.share();
        Ellipsoid {
            center: [
                0.5 + 0.3 * outward * angle.cos(),
                0.5 + 0.26 * outward * angle.sin(),
                0.28 + 0.42 * height,
            ],
            radii: [radius, radius, 1.2 * radius],
            density: 1.0,
        }
    });
    std::iter::once(base).chain(heaps).collect()
}

/// 0 below the first place, 1 above the second, smooth between them.
fn smoothstep([start, end]: [f64; 2], at: f64) -> f64 {
    let t = ((at - start) / (end - start)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}
