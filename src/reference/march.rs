//! The rays of a picture.

use rayon::prelude::*;

use super::probe::Probe;
use super::{LightGrid, Ray, composite, projection};
use crate::scene::{
    ColorManagement, Curve, Labels, Lighting, March, OpticalModel, RayProjection, Scene, Surface,
    View,
};
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
    /// What the projection "isosurface" draws, in any order; see [`March::surfaces`].
    pub surfaces: &'a [Surface],
    /// Surface shading.
    pub lighting: &'a Lighting,
    /// Ambient light at every voxel, same size as the volume; `None`: 1 everywhere.
    pub light: Option<&'a LightGrid>,
    /// The colours of the volume's voxels, decoded so, in place of the curve's; `None`: the latter.
    pub data_color: Option<ColorManagement>,
    /// What labels hide and colour.
    pub labels: Option<&'a Labels>,
    /// Accumulated opacity at which a ray's depth is taken, in (0,1].
    pub depth_threshold: f64,
    /// From pixel (column, row) to the share of a step, in `[0,1)`, that its first segment is shortened by;
    /// `None`: 0 everywhere.
    pub jitter: Option<&'a (dyn Fn([u32; 2]) -> f64 + Sync)>,
    /// From pixel to the distance along its ray, mm, at which opaque geometry ends it; `None`: nowhere.
    pub end: Option<&'a (dyn Fn([u32; 2]) -> f64 + Sync)>,
}

impl<'a> Setup<'a> {
    /// What a scene asks for, without jitter and labels.
    pub fn new(
        volume: &'a Volume,
        scene: &'a Scene,
        view: &'a View,
        curve: &'a Curve,
        surfaces: &'a [Surface],
        light: Option<&'a LightGrid>,
    ) -> Self {
        Self {
            volume,
            view,
            size: scene.image.size,
            curve,
            march: &scene.march,
            surfaces,
            lighting: &scene.lighting,
            light,
            data_color: scene.data_color(volume, curve).unwrap_or_default(),
            labels: None,
            depth_threshold: scene.image.depth_threshold,
            jitter: None,
            end: None,
        }
    }
}

/// What one ray saw. Distances are along the ray from its origin, mm.
///
/// Events are the middles of segments, or where isosurfaces are hit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pixel {
    /// Linear radiance and opacity, associated (premultiplied), over nothing.
    pub rgba: [f64; 4],
    /// Distance of the first event after which the opacity reaches the depth threshold; infinite when none
    /// does. Of the largest and the smallest sample: where it lies first. Of the mean: infinite.
    pub depth: f64,
    /// As [`Pixel::depth`], for the opacity 0.5.
    pub median: f64,
    /// Mean distance `sum w t / sum w`, with `w` the share of an event in the picture, `(1-A) alpha`; infinite
    /// when nothing is visible. Of the largest, smallest and mean sample as [`Pixel::depth`].
    pub expected: f64,
    /// What was projected: the largest, smallest or mean sample, in the file's units, or the optical depth.
    /// NaN for the other projections, and where a ray has no sample.
    pub value: f64,
    /// Number of segments sampled.
    pub samples: u32,
}

impl Pixel {
    /// Of a ray without segments.
    pub(super) fn nothing() -> Self {
        Self {
            rgba: [0.0; 4],
            depth: f64::INFINITY,
            median: f64::INFINITY,
            expected: f64::INFINITY,
            value: f64::NAN,
            samples: 0,
        }
    }
}

/// Pixels by rows, from the top left; layers as in [`Pixel`].
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Width and height.
    pub size: [u32; 2],
    /// Linear radiance and opacity, associated, over nothing.
    pub rgba: Vec<[f64; 4]>,
    /// Depth, mm.
    pub depth: Vec<f64>,
    /// Median distance, mm.
    pub median: Vec<f64>,
    /// Expected distance, mm.
    pub expected: Vec<f64>,
    /// Projected value.
    pub value: Vec<f64>,
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
            let end = setup.end.map_or(f64::INFINITY, |end| end(pixel));
            march_until(setup, Ray { origin, direction }, shift, end)
        })
        .collect();
    Picture {
        size: setup.size,
        rgba: pixels.iter().map(|p| p.rgba).collect(),
        depth: pixels.iter().map(|p| p.depth).collect(),
        median: pixels.iter().map(|p| p.median).collect(),
        expected: pixels.iter().map(|p| p.expected).collect(),
        value: pixels.iter().map(|p| p.value).collect(),
        samples: pixels.iter().map(|p| p.samples).collect(),
    }
}

/// Projects one ray; its first segment is shortened by `shift` steps.
pub fn march_ray(setup: &Setup, ray: Ray, shift: f64) -> Pixel {
    march_until(setup, ray, shift, f64::INFINITY)
}

fn march_until(setup: &Setup, ray: Ray, shift: f64, end: f64) -> Pixel {
    assert_eq!(
        setup.lighting.model,
        OpticalModel::EmissionAbsorption,
        "the march's only model"
    );

    let probe = Probe::new(setup, ray, end);
    let segments = probe.segments(shift);
    match setup.march.projection {
        RayProjection::Composite => composite::emission_absorption(&probe, segments),
        RayProjection::Xray => composite::xray(&probe, segments),
        RayProjection::Isosurface => composite::isosurfaces(&probe, segments),
        RayProjection::Maximum => projection::extremum(&probe, segments, f64::gt),
        RayProjection::Minimum => projection::extremum(&probe, segments, f64::lt),
        RayProjection::Mean => projection::mean(&probe, segments),
    }
}
