//! How far the light volume has come, and what a frame adds.

use std::sync::Arc;

use glam::{DMat3, DVec3};

use super::loaded::Loaded;
use super::pass_name;
use crate::error::Result;
use crate::gpu::{Context, Recorder, Uniforms};
use crate::pass::Reconstruction;
use crate::pass::bare_light::BareLightPass;
use crate::pass::light::{LightPass, LightResources, TraceVariant};
use crate::scene::{AmbientOcclusion, Curve, Interpolation};
use crate::shader::structs::LightPush;

/// What a direction is traced for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum LightWorkload {
    /// Light.
    Trace,
    /// How many samples of the field it takes.
    Count,
    /// The bench's bare light.
    Bare,
}

/// Directions to trace, and how many were.
pub(super) struct LightProgress {
    directions: Vec<([f64; 3], f64)>,
    traced: u32,
    /// Bricks agree on the samples that they share.
    joined: bool,
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
            joined: true,
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
        self.joined = true;
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

impl Loaded {
    /// What the passes of the light work on, and those passes.
    fn light_parts(
        &mut self,
        volume: Uniforms,
    ) -> (LightResources<'_>, &mut LightPass, &mut BareLightPass) {
        let resources = LightResources {
            images: &self.images,
            labels: self.labels.as_ref(),
            lists: &self.lists,
            work: &self.visibility.light,
            volume,
        };
        (resources, &mut self.light_pass, &mut self.bare_light_pass)
    }

    /// Traces the next direction, if there is one and the bricks are complete.
    pub(super) fn record_light(
        &mut self,
        context: &Arc<Context>,
        recorder: &mut Recorder<'_>,
        volume: Uniforms,
        workload: LightWorkload,
    ) -> Result<()> {
        // Light follows the linear field, whatever the march does; emission only where it is asked for.
        let emission = self
            .settings
            .ambient_occlusion
            .as_ref()
            .is_some_and(|ao| ao.emission);
        let reconstruction = Reconstruction {
            interpolation: Interpolation::Linear,
            labels: self.settings.hiding().is_some(),
            ..self.reconstruction(emission)
        };
        if !self.uploads.bricks_complete() {
            return Ok(());
        }
        let Some(push) = self.light.as_mut().and_then(LightProgress::next) else {
            return Ok(());
        };
        let grows = self.light_growth().is_some();
        let (resources, light_pass, bare_light_pass) = self.light_parts(volume);
        if workload == LightWorkload::Bare {
            return recorder.pass(pass_name::BARE_LIGHT, |recorder| {
                bare_light_pass.record(context, recorder, reconstruction, &resources, push)
            });
        }
        let variant = TraceVariant {
            reconstruction,
            grows,
            count: workload == LightWorkload::Count,
        };
        recorder.pass(pass_name::LIGHT, |recorder| {
            light_pass.trace(context, recorder, variant, &resources, push)
        })
    }

    /// Makes the light continuous across bricks, where directions have been traced since that was done and the light is about to be
    /// read, or is complete.
    pub(super) fn record_light_seam(
        &mut self,
        context: &Arc<Context>,
        recorder: &mut Recorder<'_>,
        volume: Uniforms,
        is_read: bool,
    ) -> Result<()> {
        if !self.uploads.bricks_complete() {
            return Ok(());
        }
        let reconstruction = self.reconstruction(false);
        let light = self.light.as_mut();
        let due = light.is_some_and(|light| light.take_unjoined(is_read));
        if !due || self.visibility.light.seam.is_empty() {
            return Ok(());
        }
        let (resources, light_pass, _) = self.light_parts(volume);
        recorder.pass(pass_name::LIGHT_SEAM, |recorder| {
            light_pass.seam(context, recorder, reconstruction, &resources)
        })
    }
}
