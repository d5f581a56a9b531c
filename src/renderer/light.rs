//! How far the light volume has come.

use glam::{DMat3, DVec3};

use crate::scene::{AmbientOcclusion, Curve};
use crate::shader::structs::LightPush;

/// Directions to trace, and how many were.
pub(super) struct LightProgress {
    directions: Vec<([f64; 3], f64)>,
    traced: u32,
    growth: Option<f64>,
    template: LightPush,
    ix_from_world: DMat3,
}

impl LightProgress {
    /// `growth`: of the distance between samples, where it grows.
    pub(super) fn new(
        ao: &AmbientOcclusion,
        curve: &Curve,
        ix_from_world: DMat3,
        voxel_mm: f64,
        growth: Option<f64>,
    ) -> Self {
        Self {
            directions: ao.weighted_directions(),
            traced: 0,
            growth,
            template: LightPush {
                direction_ix: [0.0; 3],
                offset_mm: (ao.offset * voxel_mm) as f32,
                radius_mm: (ao.radius * voxel_mm) as f32,
                parts: ao.samples_per_ray() as f32,
                exponent_mm: (ao.gamma / curve.unit_distance) as f32,
                weight: 1.0,
                ray: 0,
                first: 0,
                count: 0,
                growth: growth.unwrap_or(0.0) as f32,
            },
            ix_from_world,
        }
    }

    pub(super) fn rays(&self) -> u32 {
        self.directions.len() as u32
    }

    pub(super) fn traced(&self) -> u32 {
        self.traced
    }

    pub(super) fn growth(&self) -> Option<f64> {
        self.growth
    }

    /// Back to no direction.
    pub(super) fn restart(&mut self) {
        self.traced = 0;
    }

    /// The next direction, `None` when all were traced.
    pub(super) fn next(&mut self) -> Option<LightPush> {
        let (direction, weight) = self.directions.get(self.traced as usize)?;
        let push = LightPush {
            direction_ix: (self.ix_from_world * DVec3::from(*direction))
                .as_vec3()
                .to_array(),
            weight: *weight as f32,
            ray: self.traced,
            ..self.template
        };
        self.traced += 1;
        Some(push)
    }
}
