//! Emission and absorption along the rays of a picture.

use glam::DVec3;
use rayon::prelude::*;

use super::{Field, LightGrid, Ray, opacity_over};
use crate::scene::{Classification, Curve, Lighting, March, OpticalModel, Scene, Shading, View};
use crate::volume::Volume;

/// What a picture depends on.
///
/// Of [`March`] the fields that change no pixel of a full-resolution volume are not read, and neither is the
/// `jitter` switch: see [`Setup::jitter`].
#[derive(Clone, Copy)]
pub struct Setup<'a> {
    /// The data.
    pub volume: &'a Volume,
    /// From where.
    pub view: &'a View,
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Value to optical properties.
    pub curve: &'a Curve,
    /// How rays are sampled.
    pub march: &'a March,
    /// Surface shading.
    pub lighting: &'a Lighting,
    /// Ambient light at every voxel, same size as the volume; `None`: 1 everywhere.
    pub light: Option<&'a LightGrid>,
    /// Accumulated opacity at which a ray's depth is taken, in (0,1].
    pub depth_threshold: f64,
    /// From pixel (column, row) to the share of a step, in `[0,1)`, that its first segment is shortened by;
    /// `None`: 0 everywhere.
    pub jitter: Option<&'a (dyn Fn([u32; 2]) -> f64 + Sync)>,
}

impl<'a> Setup<'a> {
    /// What a scene asks for, without jitter.
    pub fn new(
        volume: &'a Volume,
        scene: &'a Scene,
        view: &'a View,
        curve: &'a Curve,
        light: Option<&'a LightGrid>,
    ) -> Self {
        Self {
            volume,
            view,
            size: scene.image.size,
            curve,
            march: &scene.march,
            lighting: &scene.lighting,
            light,
            depth_threshold: scene.image.depth_threshold,
            jitter: None,
        }
    }
}

/// What one ray saw.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pixel {
    /// Linear radiance and opacity, associated (premultiplied), over nothing.
    pub rgba: [f64; 4],
    /// Distance along the ray from its origin, mm, of the middle of the first segment after which the
    /// opacity reaches the depth threshold; infinite when none does.
    pub depth: f64,
    /// Number of segments sampled.
    pub samples: u32,
}

/// Pixels by rows, from the top left.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Width and height.
    pub size: [u32; 2],
    /// Linear radiance and opacity, associated, over nothing.
    pub rgba: Vec<[f64; 4]>,
    /// Depth, mm; see [`Pixel::depth`].
    pub depth: Vec<f64>,
    /// Segments sampled.
    pub samples: Vec<u32>,
}

/// Renders a picture: one ray through the middle of each pixel.
pub fn march(setup: &Setup) -> Picture {
    let [width, height] = setup.size;
    let pixels: Vec<Pixel> = (0..height)
        .into_par_iter()
        .flat_map_iter(|y| (0..width).map(move |x| [x, y]))
        .map(|pixel| {
            let center = pixel.map(|c| f64::from(c) + 0.5);
            let (origin, direction) = setup.view.ray(center, setup.size);
            let shift = setup.jitter.map_or(0.0, |jitter| jitter(pixel));
            march_ray(setup, Ray { origin, direction }, shift)
        })
        .collect();
    Picture {
        size: setup.size,
        rgba: pixels.iter().map(|p| p.rgba).collect(),
        depth: pixels.iter().map(|p| p.depth).collect(),
        samples: pixels.iter().map(|p| p.samples).collect(),
    }
}

/// Composites one ray front to back; its first segment is shortened by `shift` steps.
///
/// A segment of length `d` has the opacity `alpha = 1 - (1-a)^(d/u)` and adds
/// `(1-A) alpha (c I D + c_E)`: colour `c` and emission `c_E` of the transfer function, ambient light `I`,
/// surface shading `D`; `c_E` counts only with `lighting.emission`. The ray ends with the segment after which `A` reaches `march.early_termination`.
pub fn march_ray(setup: &Setup, ray: Ray, shift: f64) -> Pixel {
    // There is one of each yet; another one must not compile here unnoticed.

    let OpticalModel::EmissionAbsorption = setup.lighting.model;

    let field = Field::new(setup.volume);
    let mut radiance = DVec3::ZERO;
    let mut opacity = 0.0;
    let mut depth = f64::INFINITY;
    let mut samples = 0;
    let step = setup.march.step * setup.volume.min_spacing();
    let segments = ray
        .span(field.ix_from_world(), field.last_ix())
        .into_iter()
        .flat_map(|span| span.segments(step, shift));
    for segment in segments {
        let ix = position_ix(&field, ray, segment.middle());
        let Some(value) = field.sample(ix, setup.march.interpolation) else {
            continue;
        };
        samples += 1;
        let optical = setup.curve.evaluate(value);
        let alpha = opacity_over(
            optical.opacity,
            segment.length() / setup.curve.unit_distance,
        );
        let ambient_light = setup
            .light
            .and_then(|grid| grid.sample(ix))
            .unwrap_or(DVec3::ONE);
        let reflected = DVec3::from_array(optical.color)
            * ambient_light
            * surface_shading(&field, ix, ray.direction, setup.lighting);
        let emitted = if setup.lighting.emission {
            DVec3::from_array(optical.emission)
        } else {
            DVec3::ZERO
        };
        let source = reflected + emitted;
        radiance += (1.0 - opacity) * alpha * source;
        opacity += (1.0 - opacity) * alpha;
        if opacity >= setup.depth_threshold && depth.is_infinite() {
            depth = segment.middle();
        }
        if opacity >= setup.march.early_termination {
            break;
        }
    }
    Pixel {
        rgba: radiance.extend(opacity).to_array(),
        depth,
        samples,
    }
}

/// Index position at a distance along a ray. The span is inside the field; rounding must not say otherwise.
fn position_ix(field: &Field, ray: Ray, distance: f64) -> DVec3 {
    field
        .ix_from_world()
        .transform_point3(ray.origin + ray.direction * distance)
        .clamp(DVec3::ZERO, field.last_ix())
}

/// The factor `D` on reflected light: 1 without shading or where the gradient is zero, else
/// `ambient + diffuse |n . l|`. Without a direction the light is at the eye.
fn surface_shading(field: &Field, ix: DVec3, ray_direction: DVec3, lighting: &Lighting) -> f64 {
    match lighting.shading {
        Shading::None => 1.0,
        Shading::Diffuse => {
            let to_light = lighting
                .direction
                .map_or(-ray_direction, |l| DVec3::from_array(l).normalize());
            field
                .gradient_ws(ix)
                .and_then(DVec3::try_normalize)
                .map_or(1.0, |normal| {
                    lighting.ambient + lighting.diffuse * normal.dot(to_light).abs()
                })
        }
    }
}
