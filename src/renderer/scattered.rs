//! Scattered light: how far its solver has come.

use std::f64::consts::PI;
use std::sync::Arc;

use super::RayBasis;
use super::settings::Settings;
use crate::atlas::{LightGrid, ScatterImages, Solver};
use crate::error::{Error, Result};
use crate::gpu::{Context, Recorder};
use crate::pass::scatter::{ScatterPass, ScatterResources, ScatterVariant, flag};
use crate::scene::{OpticalModel, PhaseFunction, ScatteringMethod};
use crate::shader::structs::ScatterPush;

/// Relaxations that one frame records.
const RELAXATIONS_A_FRAME: u32 = 16;

/// A volume of scattered light on its way.
pub(super) struct Scattered {
    pub(super) images: ScatterImages,
    flags: u32,
    isotropic: bool,
    mean_cosine: f32,
    over_relaxation: f32,
    tolerance: f64,
    most: u32,
    done: u32,
    finished: bool,
    prepared: bool,
    /// For which eye the light was last gathered, and after how many iterations.
    gathered: Option<([f32; 4], u32)>,
}

impl Scattered {
    /// `None` where nothing is scattered but what comes straight from the lights.
    pub(super) fn new(
        context: &Arc<Context>,
        name: &str,
        lengths_mm: [f64; 3],
        sheared: bool,
        settings: &Settings,
    ) -> Result<Option<Self>> {
        let lighting = &settings.lighting;
        let scattering = &lighting.scattering;
        let around = lighting.environment.is_some();
        let (solver, flags, most) = match (lighting.model, scattering.method) {
            (OpticalModel::SingleScattering, _) if around => (
                Solver::Ordinates(scattering.directions),
                flag::SURROUNDINGS | flag::UNATTENUATED,
                1,
            ),
            (OpticalModel::ShadowedScattering, _) if around => (
                Solver::Ordinates(scattering.directions),
                flag::SURROUNDINGS,
                1,
            ),
            (OpticalModel::MultipleScattering, method) => {
                let solver = match method {
                    ScatteringMethod::Ordinates => Solver::Ordinates(scattering.directions),
                    ScatteringMethod::Diffusion => Solver::Diffusion,
                    ScatteringMethod::Zonal => Solver::Zonal,
                    ScatteringMethod::MonteCarlo => return Ok(None),
                };
                (solver, 0, scattering.iterations())
            }
            _ => return Ok(None),
        };
        if sheared && matches!(solver, Solver::Diffusion | Solver::Zonal) {
            return Err(Error::invalid(
                "lighting.scattering.method",
                "diffusion and zones need a grid of orthogonal axes, and this volume's are sheared; give \"ordinates\" or \"monte_carlo\"",
            ));
        }
        let isotropic = lighting.phase == PhaseFunction::Isotropic;
        let grid = LightGrid::of_resolution(lengths_mm, scattering.resolution());
        let longest = grid.points.into_iter().max().unwrap_or(2);
        Ok(Some(Self {
            images: ScatterImages::new(context, name, grid, solver, isotropic, most)?,
            flags,
            isotropic,
            mean_cosine: match solver {
                Solver::Diffusion => lighting.phase.moment(1) as f32,
                Solver::Ordinates(_) | Solver::Zonal => 0.0,
            },
            over_relaxation: (2.0 / (1.0 + PI / f64::from(longest))) as f32,
            tolerance: scattering.tolerance,
            most,
            done: 0,
            finished: false,
            prepared: false,
            gathered: None,
        }))
    }

    pub(super) fn grid(&self) -> LightGrid {
        self.images.grid
    }

    /// Iterations done, and those that there will be as far as is known.
    pub(super) fn progress(&self) -> (u32, u32) {
        let total = if self.finished { self.done } else { self.most };
        (self.done, total)
    }

    /// Largest change of the last iteration that is known, as a share of the largest fluence.
    pub(super) fn residual(&self) -> Result<Option<f64>> {
        for iteration in (0..self.done).rev() {
            if let Some(residual) = self.images.residual(iteration)? {
                return Ok(Some(residual));
            }
        }
        Ok(None)
    }

    /// See [`crate::gpu::Image::forget`].
    pub(super) fn forget(&mut self) {
        self.images.forget();
        self.done = 0;
        self.finished = false;
        self.prepared = false;
        self.gathered = None;
    }

    /// Iterates, unless it has ended, and gathers for the eye where that is out of date. `iterating`: false leaves the light as it is.
    pub(super) fn record(
        &mut self,
        context: &Arc<Context>,
        recorder: &mut Recorder<'_>,
        pass: &mut ScatterPass,
        resources: &ScatterInputs<'_>,
        rays: &RayBasis,
        iterating: bool,
    ) -> Result<()> {
        let eye = eye_of(rays);
        let variant = resources.variant;
        if iterating && !self.prepared {
            self.images.restart(context, "umbravox")?;
        }
        self.images.record(context, recorder, resources.phase)?;
        let template = ScatterPush {
            eye,
            step: 0,
            bins: self.images.bins(),
            columns: self.images.columns(),
            flags: self.flags,
            over_relaxation: self.over_relaxation,
            mean_cosine: self.mean_cosine,
            pad0: 0.0,
            pad1: 0.0,
        };
        self.look_at_residual()?;
        let count = match self.images.solver {
            Solver::Diffusion => RELAXATIONS_A_FRAME,
            Solver::Ordinates(_) | Solver::Zonal => 1,
        };
        let bound = resources.with(&self.images);
        if iterating && !self.prepared {
            pass.prepare(context, recorder, variant, &bound, template)?;
            self.prepared = true;
        }
        let mut done = self.done;
        if iterating && !self.finished {
            for _ in 0..count.min(self.most - done) {
                let push = ScatterPush {
                    step: done,
                    ..template
                };
                pass.iterate(context, recorder, variant, &bound, push)?;
                done += 1;
            }
        }
        let stale = match self.gathered {
            None => true,
            Some((before, after)) => after != done || (before != eye && !self.isotropic),
        };
        if self.prepared && stale {
            let push = ScatterPush {
                step: done,
                ..template
            };
            pass.gather(context, recorder, variant, &bound, push)?;
            self.gathered = Some((eye, done));
        }
        self.done = done;
        self.finished |= done >= self.most;
        Ok(())
    }

    /// Ends where the last iteration that is known changed little enough.
    fn look_at_residual(&mut self) -> Result<()> {
        // The first iterations of ordinates and of relaxation change nothing yet, or everything.
        if !self.finished && self.done > 2 {
            let small = self.residual()?.is_some_and(|r| r <= self.tolerance);
            self.finished = small;
        }
        Ok(())
    }
}

/// [`ScatterResources`] without the solver's own, and what specializes the passes.
pub(super) struct ScatterInputs<'a> {
    pub(super) images: &'a crate::atlas::Images,
    pub(super) labels: Option<&'a crate::atlas::LabelImages>,
    pub(super) medium_images: &'a crate::atlas::MediumImages,
    pub(super) volume: crate::gpu::Uniforms,
    pub(super) medium: crate::gpu::Uniforms,
    pub(super) phase: &'a PhaseFunction,
    pub(super) variant: ScatterVariant,
}

impl<'a> ScatterInputs<'a> {
    fn with(&self, scatter: &'a ScatterImages) -> ScatterResources<'a> {
        ScatterResources {
            images: self.images,
            labels: self.labels,
            medium_images: self.medium_images,
            scatter,
            volume: self.volume,
            medium: self.medium,
        }
    }
}

/// The position of the eye and 1, or the direction towards it and 0.
fn eye_of(rays: &RayBasis) -> [f32; 4] {
    let parallel = rays.origin_dx != glam::DVec3::ZERO || rays.origin_dy != glam::DVec3::ZERO;
    let eye = if parallel {
        (-rays.direction).normalize_or_zero().extend(0.0)
    } else {
        rays.origin.extend(1.0)
    };
    eye.as_vec4().to_array()
}
