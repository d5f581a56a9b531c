//! Local ambient occlusion at every voxel of the full grid.
//!
//! Frida Hernell, Patric Ljung, Anders Ynnerman: "Efficient Ambient and Emissive Tissue Illumination using
//! Local Occlusion in Multiresolution Volume Rendering" (2007), equations 1 to 5 at the finest level.

use glam::{DAffine3, DVec3};
use rayon::prelude::*;

use super::{Field, opacity_over};
use crate::field::{contains, trilinear};
use crate::occlusion;
use crate::scene::{AmbientOcclusion, Curve, Interpolation, Labels, RaySampling};
use crate::volume::Volume;

/// Light that reaches a point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Light {
    /// With what the tissue around emits (eq. 4), bias included; equal to `grey` without emission.
    pub rgb: [f64; 3],
    /// Ambient light alone (eq. 1), bias included.
    pub grey: f64,
}

/// Light at every voxel.
#[derive(Clone, Debug, PartialEq)]
pub struct LightGrid {
    size: [u32; 3],
    voxels: Vec<Light>,
}

impl LightGrid {
    /// Fills a grid of at least two voxels an axis from voxel indices, in parallel.
    pub fn from_fn(size: [u32; 3], light: impl Fn([u32; 3]) -> Light + Sync) -> Self {
        let [nx, ny, nz] = size;
        let light = &light;
        let voxels = (0..nz)
            .into_par_iter()
            .flat_map_iter(|k| (0..ny).flat_map(move |j| (0..nx).map(move |i| light([i, j, k]))))
            .collect();
        Self { size, voxels }
    }

    /// Voxels on x, y, z.
    pub fn size(&self) -> [u32; 3] {
        self.size
    }

    /// Every voxel, x fastest.
    pub fn voxels(&self) -> &[Light] {
        &self.voxels
    }

    /// RGB light at an index position, trilinear; `None` outside `[0, n-1]`.
    pub fn sample(&self, ix: DVec3) -> Option<DVec3> {
        let [nx, ny, _] = self.size.map(|n| n as usize);
        let voxel = |i, j, k| {
            let at = i as usize + nx * (j as usize + ny * k as usize);
            DVec3::from_array(self.voxels[at].rgb)
        };
        contains(self.size, ix).then(|| trilinear(self.size, ix, voxel))
    }
}

/// Light at every voxel, from the directions and weights of the settings.
///
/// The field is sampled trilinearly whatever the march does. What `labels` hide neither absorbs nor emits. Where the distance between
/// samples grows by itself, the growth is found for all voxels at once.
pub fn light(
    volume: &Volume,
    curve: &Curve,
    settings: &AmbientOcclusion,
    labels: Option<&Labels>,
) -> LightGrid {
    let directions = settings.weighted_directions();
    let settings = &with_growth(volume, curve, settings);
    LightGrid::from_fn(volume.size(), |voxel| {
        light_at(volume, curve, settings, labels, voxel, &directions)
    })
}

/// Settings that leave no growth open.
fn with_growth(volume: &Volume, curve: &Curve, settings: &AmbientOcclusion) -> AmbientOcclusion {
    let growth = occlusion::growth(volume, curve, settings);
    AmbientOcclusion {
        sampling: growth.map_or(RaySampling::Uniform, |_| RaySampling::Distance),
        growth,
        ..settings.clone()
    }
}

/// Light at one voxel from any unit directions (towards the light, world space) and their weights:
/// `I = bias + (1/K) sum_k w_k I_k` (eq. 3).
pub fn light_at(
    volume: &Volume,
    curve: &Curve,
    settings: &AmbientOcclusion,
    labels: Option<&Labels>,
    voxel: [u32; 3],
    directions: &[([f64; 3], f64)],
) -> Light {
    let sphere = Sphere {
        growth: occlusion::growth(volume, curve, settings),
        field: Field::new(volume),
        curve,
        settings,
        labels: labels.map(|labels| (labels, labels.map().ix_from(volume))),
        center_ix: DVec3::from_array(voxel.map(f64::from)),
        mm_per_voxel: volume.min_spacing(),
    };
    let (mut rgb, mut grey) = (DVec3::ZERO, 0.0);
    for &(direction, weight) in directions {
        let incident = sphere.incident_light(DVec3::from_array(direction));
        rgb += weight * DVec3::from_array(incident.rgb);
        grey += weight * incident.grey;
    }
    let count = directions.len() as f64;
    Light {
        rgb: (settings.bias + rgb / count).to_array(),
        grey: settings.bias + grey / count,
    }
}

/// What surrounds one voxel.
struct Sphere<'a> {
    field: Field<'a>,
    curve: &'a Curve,
    settings: &'a AmbientOcclusion,
    /// Of the distance between samples, where it grows.
    growth: Option<f64>,
    /// With their index position from the volume's.
    labels: Option<(&'a Labels, DAffine3)>,
    center_ix: DVec3,
    /// Lengths in the settings are in voxels of the smallest spacing.
    mm_per_voxel: f64,
}

impl Sphere<'_> {
    fn is_shown(&self, ix: DVec3) -> bool {
        self.labels.is_none_or(|(labels, map_from_ix)| {
            labels.style_at(map_from_ix.transform_point3(ix)).shown
        })
    }

    /// Light from one direction, `I_k = sum_m (1 + c_E,m)/M prod_{i<m} (1 - alpha'_i)` (eq. 2 and 4), over `M` equal parts of
    /// `[offset, radius]`, each of length `d` and opacity `alpha' = 1 - (1 - alpha)^(gamma d/u)` (eq. 5). They are sampled at
    /// their middles: all of them, or those that [`occlusion::parts_of_ray`] asks for. Outside the field nothing absorbs or emits.
    fn incident_light(&self, direction_ws: DVec3) -> Light {
        let settings = self.settings;
        let parts = settings.samples_per_ray();
        let offset = settings.offset * self.mm_per_voxel;
        let part = (settings.radius * self.mm_per_voxel - offset) / f64::from(parts);
        let exponent = settings.gamma * part / self.curve.unit_distance;
        let direction_ix = self.field.ix_from_world().transform_vector3(direction_ws);
        let middle_ix = |m: u32| {
            let distance = offset + (f64::from(m) + 0.5) * part;
            self.center_ix + direction_ix * distance
        };
        let sample = |m: u32| {
            let ix = middle_ix(m);
            let optical = self
                .field
                .sample(ix, Interpolation::Linear)
                .filter(|_| self.is_shown(ix))
                .map(|value| self.curve.evaluate(value))
                .unwrap_or_default();
            let [r, g, b] = optical.emission;
            [opacity_over(optical.opacity, exponent), r, g, b]
        };
        let ray: Vec<[f64; 4]> = match self.growth {
            None => (0..parts).map(sample).collect(),
            Some(growth) => {
                let inside = |m: &u32| self.field.contains(middle_ix(*m));
                let inside = (0..parts).take_while(inside).count() as u32;
                occlusion::parts_of_ray(growth, parts, inside, sample)
            }
        };
        let (mut rgb, mut grey) = (DVec3::ZERO, 0.0);
        let mut transparency = 1.0;
        for [opacity, r, g, b] in ray {
            let emission = if settings.emission {
                DVec3::new(r, g, b)
            } else {
                DVec3::ZERO
            };
            rgb += transparency * (1.0 + emission);
            grey += transparency;
            transparency *= 1.0 - opacity;
        }
        let count = f64::from(parts);
        Light {
            rgb: (rgb / count).to_array(),
            grey: grey / count,
        }
    }
}
