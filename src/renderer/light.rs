//! How far the light volume has come.

use glam::{DMat3, DVec3};

use crate::scene::{AmbientOcclusion, Curve};
use crate::shader::structs::LightPush;

/// Directions to trace, and how many were.
pub(super) struct LightProgress {
    directions: Vec<([f64; 3], f64)>,
    traced: u32,
    /// Bricks agree on the samples that they share.
    joined: bool,
    template: LightPush,
    ix_from_world: DMat3,
}

impl LightProgress {
    pub(super) fn new(
        ao: &AmbientOcclusion,
        curve: &Curve,
        ix_from_world: DMat3,
        voxel_mm: f64,
    ) -> Self {
        Self {
            directions: ao.weighted_directions(),
            traced: 0,
            joined: true,
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
                pad0: 0,
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
        self.joined = false;
        Some(push)
    }

    /// True, once, when bricks are to be joined: directions have been traced since, and the light is read or all of it is there.
    pub(super) fn take_unjoined(&mut self, is_read: bool) -> bool {
        let due = !self.joined && (is_read || self.traced == self.rays());
        self.joined |= due;
        due
    }
}
