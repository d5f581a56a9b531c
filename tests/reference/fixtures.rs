//! Small volumes, curves and a ray tester.

use glam::{DAffine3, DVec3};
use umbravox::reference::{LightGrid, Pixel, Ray, Setup, march_ray};
use umbravox::scene::{
    Classification, Curve, CurvePoint, Lighting, March, Optical, Projection, Surface, View,
};
use umbravox::volume::{Rescale, Volume, Voxels};

/// Float volume from a function of the voxel index; its values are rounded to f32.
pub(crate) fn volume_of(
    size: [u32; 3],
    world_from_ix: DAffine3,
    value: impl Fn([u32; 3]) -> f64,
) -> Volume {
    let [nx, ny, nz] = size;
    let mut voxels = Vec::new();
    for k in 0..nz {
        for j in 0..ny {
            for i in 0..nx {
                voxels.push(value([i, j, k]) as f32);
            }
        }
    }
    Volume::new(Voxels::F32(voxels), size, world_from_ix, Rescale::default()).unwrap()
}

/// Cube of `n` voxels an axis, isotropic, all of one value.
pub(crate) fn homogeneous(n: u32, spacing: f64) -> Volume {
    volume_of([n; 3], DAffine3::from_scale(DVec3::splat(spacing)), |_| 0.0)
}

/// A curve from (value, colour, opacity, emission).
pub(crate) fn curve(unit_distance: f64, points: &[(f64, [f64; 3], f64, [f64; 3])]) -> Curve {
    Curve {
        unit_distance,
        points: points
            .iter()
            .map(|&(value, color, opacity, emission)| CurvePoint {
                value,
                optical: Optical {
                    color,
                    opacity,
                    emission,
                    source: [0.0; 3],
                },
            })
            .collect(),
    }
}

/// The same colour and opacity for every value.
pub(crate) fn medium(unit_distance: f64, opacity: f64, color: [f64; 3]) -> Curve {
    curve(unit_distance, &[(0.0, color, opacity, [0.0; 3])])
}

/// Traces single rays.
pub(crate) struct Tracer {
    pub(crate) volume: Volume,
    pub(crate) curve: Curve,
    pub(crate) march: March,
    pub(crate) surfaces: Vec<Surface>,
    pub(crate) lighting: Lighting,
    pub(crate) light: Option<LightGrid>,
    pub(crate) depth_threshold: f64,
}

impl Tracer {
    /// Never terminates early; classifies after interpolation; no shading, no ambient light.
    pub(crate) fn new(volume: Volume, curve: Curve, step: f64) -> Self {
        Self {
            volume,
            curve,
            march: March {
                step,
                early_termination: 1.0,
                classification: Some(Classification::Post),
                ..Default::default()
            },
            surfaces: Vec::new(),
            lighting: Lighting::default(),
            light: None,
            depth_threshold: 0.05,
        }
    }

    pub(crate) fn jittered(&self, origin: DVec3, direction: DVec3, shift: f64) -> Pixel {
        let setup = Setup {
            volume: &self.volume,
            view: &ORTHOGRAPHIC,
            size: [1, 1],
            curve: &self.curve,
            march: &self.march,
            surfaces: &self.surfaces,
            lighting: &self.lighting,
            light: self.light.as_ref(),
            data_color: None,
            labels: None,
            depth_threshold: self.depth_threshold,
            jitter: None,
            end: None,
        };
        let direction = direction.normalize();
        march_ray(&setup, Ray { origin, direction }, shift)
    }

    pub(crate) fn ray(&self, origin: DVec3, direction: DVec3) -> Pixel {
        self.jittered(origin, direction, 0.0)
    }
}

/// Along +y, z up; 2 mm high.
pub(crate) const ORTHOGRAPHIC: View = View {
    eye: DVec3::ZERO,
    right: DVec3::X,
    up: DVec3::Z,
    forward: DVec3::Y,
    projection: Projection::Orthographic { height: 2.0 },
};

#[track_caller]
pub(crate) fn assert_close(actual: f64, expected: f64, tolerance: f64) {
    assert!(
        (actual - expected).abs() <= tolerance,
        "{actual} is {:e} away from {expected}, more than {tolerance:e}",
        (actual - expected).abs()
    );
}
