//! Scattered light on a grid: discrete ordinates, diffusion, zones.
//!
//! Reads   atlas, index, transfer, labels for the grid's medium; then the grid alone, the swept light and the
//!         environment (SampledRead; index, transfer and packed corners SampledGeneral)
//! Writes  light by direction, sources, fluence, what is scattered towards the eye (Storage), residuals (storage buffer, host-read)
//! Grid    one workgroup for 4x4x4 points; of a sweep 8x8 points of a layer and a bin; of the zonal method 64 zones
//! Method  Max 1995, section VII: short characteristics; P1 by finite volumes and over-relaxation; radiosity between zones
//! Limits  a dispatch is one layer of all bins, half a relaxation, or one exchange of at most 8000 zones
//! Twin    src/reference/transport/paths.rs (the same light, by paths)

use std::sync::Arc;

use super::{Reconstruction, Variants, sampled, use_field, use_labels};
use crate::atlas::{Images, LabelImages, MediumImages, ScatterImages, Solver};
use crate::error::Result;
use crate::gpu::{Access, Bound, Context, Image, Recorder, Uniforms};
use crate::shader::PassInterface;
use crate::shader::generated::*;
use crate::shader::interface;
use crate::shader::structs::ScatterPush;

/// What a step leaves out: `glsl/include/scatter_grid.glsl`.
pub(crate) mod flag {
    pub(crate) const FIRST: u32 = 1;
    pub(crate) const UNATTENUATED: u32 = 2;
    pub(crate) const SURROUNDINGS: u32 = 4;
}

/// What specializes the passes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ScatterVariant {
    pub(crate) reconstruction: Reconstruction,
    pub(crate) phase: u32,
    pub(crate) environment: u32,
    pub(crate) glows: bool,
}

/// What the passes work on.
pub(crate) struct ScatterResources<'a> {
    pub(crate) images: &'a Images,
    pub(crate) labels: Option<&'a LabelImages>,
    pub(crate) medium_images: &'a MediumImages,
    pub(crate) scatter: &'a ScatterImages,
    pub(crate) volume: Uniforms,
    pub(crate) medium: Uniforms,
}

/// The passes.
#[derive(Default)]
pub(crate) struct ScatterPass {
    variants: Variants,
}

impl ScatterPass {
    /// The medium on the grid, and of all but the ordinates what the lights do there.
    pub(crate) fn prepare(
        &mut self,
        context: &Arc<Context>,
        recorder: &mut Recorder<'_>,
        variant: ScatterVariant,
        resources: &ScatterResources<'_>,
        push: ScatterPush,
    ) -> Result<()> {
        let groups = groups_of(resources.scatter);
        let mut bound = use_field(recorder, resources.images);
        bound.extend(use_labels(recorder, resources.images, resources.labels));
        let medium = &resources.scatter.medium;
        let emission = &resources.scatter.emission;
        recorder.use_image(medium, Access::Storage);
        recorder.use_image(emission, Access::Storage);
        bound.extend([
            (BINDING_VOLUME, Bound::Uniform(resources.volume)),
            (BINDING_MEDIUM, Bound::Uniform(resources.medium)),
            (BINDING_GRID_MEDIUM_STORE, Bound::StorageImage(medium)),
            (BINDING_GRID_EMISSION_STORE, Bound::StorageImage(emission)),
        ]);
        let pipeline = self
            .variants
            .get(context, &interface::GRID_MEDIUM, variant.constants())?;
        recorder.bind(pipeline, &bound)?;
        recorder.dispatch_plain(pipeline, groups);
        match resources.scatter.solver {
            Solver::Ordinates(_) => Ok(()),
            Solver::Diffusion | Solver::Zonal => {
                let program = &interface::DIFFUSION_SOURCE;
                self.dispatch(context, recorder, variant, resources, program, push, groups)
            }
        }?;
        if resources.scatter.solver == Solver::Zonal {
            let push = ScatterPush {
                flags: push.flags | flag::FIRST,
                ..push
            };
            let program = &interface::ZONAL;
            let groups = zone_groups(resources.scatter);
            self.dispatch(context, recorder, variant, resources, program, push, groups)?;
        }
        Ok(())
    }

    /// One iteration; `push.step` is its number.
    pub(crate) fn iterate(
        &mut self,
        context: &Arc<Context>,
        recorder: &mut Recorder<'_>,
        variant: ScatterVariant,
        resources: &ScatterResources<'_>,
        push: ScatterPush,
    ) -> Result<()> {
        let groups = groups_of(resources.scatter);
        match resources.scatter.solver {
            Solver::Ordinates(_) => {
                let first = if push.step == 0 { flag::FIRST } else { 0 };
                let source = ScatterPush {
                    flags: push.flags | first,
                    ..push
                };
                let program = &interface::ORDINATES_SOURCE;
                self.dispatch(
                    context, recorder, variant, resources, program, source, groups,
                )?;
                self.sweep(context, recorder, variant, resources, push)
            }
            Solver::Diffusion => {
                for color in [0, 1] {
                    let push = ScatterPush {
                        columns: color,
                        ..push
                    };
                    let program = &interface::DIFFUSION_RELAX;
                    self.dispatch(context, recorder, variant, resources, program, push, groups)?;
                }
                Ok(())
            }
            Solver::Zonal => {
                let program = &interface::ZONAL;
                let groups = zone_groups(resources.scatter);
                self.dispatch(context, recorder, variant, resources, program, push, groups)
            }
        }
    }

    /// What is scattered towards the eye, after `push.step` iterations.
    pub(crate) fn gather(
        &mut self,
        context: &Arc<Context>,
        recorder: &mut Recorder<'_>,
        variant: ScatterVariant,
        resources: &ScatterResources<'_>,
        push: ScatterPush,
    ) -> Result<()> {
        let (program, push) = match resources.scatter.solver {
            Solver::Ordinates(_) => (&interface::ORDINATES_GATHER, push),
            Solver::Diffusion => (
                &interface::DIFFUSE_GATHER,
                ScatterPush { columns: 0, ..push },
            ),
            Solver::Zonal => {
                let columns = push.step & 1;
                (&interface::DIFFUSE_GATHER, ScatterPush { columns, ..push })
            }
        };
        let groups = groups_of(resources.scatter);
        self.dispatch(context, recorder, variant, resources, program, push, groups)
    }

    /// Every bin through all layers.
    fn sweep(
        &mut self,
        context: &Arc<Context>,
        recorder: &mut Recorder<'_>,
        variant: ScatterVariant,
        resources: &ScatterResources<'_>,
        push: ScatterPush,
    ) -> Result<()> {
        let points = resources.scatter.grid.points;
        let layers = points.into_iter().max().unwrap_or(0);
        let edge = layers.div_ceil(8);
        let program = &interface::ORDINATES_SWEEP;
        for step in 0..layers {
            let push = ScatterPush { step, ..push };
            let groups = [edge, edge, push.bins];
            self.dispatch(context, recorder, variant, resources, program, push, groups)?;
        }
        Ok(())
    }

    #[allow(
        clippy::too_many_arguments,
        reason = "what every dispatch of the family differs in, and nothing else"
    )]
    fn dispatch(
        &mut self,
        context: &Arc<Context>,
        recorder: &mut Recorder<'_>,
        variant: ScatterVariant,
        resources: &ScatterResources<'_>,
        program: &'static PassInterface,
        push: ScatterPush,
        groups: [u32; 3],
    ) -> Result<()> {
        let pipeline = self.variants.get(context, program, variant.constants())?;
        let bound = use_grid(recorder, resources);
        recorder.bind(pipeline, &bound)?;
        recorder.dispatch(pipeline, &push, groups);
        recorder.use_buffer(&resources.scatter.residual, Access::HostRead);
        recorder.flush();
        Ok(())
    }
}

impl ScatterVariant {
    fn constants(self) -> Vec<(u32, u32)> {
        let mut constants = self.reconstruction.constants();
        constants.extend([
            (SPEC_PHASE, self.phase),
            (SPEC_ENVIRONMENT, self.environment),
            (SPEC_GLOWS, self.glows.into()),
        ]);
        constants
    }
}

/// Everything that a pass on the grid may bind; each takes its own selection.
fn use_grid<'a>(
    recorder: &mut Recorder<'_>,
    resources: &ScatterResources<'a>,
) -> Vec<(u32, Bound<'a>)> {
    let ScatterResources {
        medium_images,
        scatter,
        volume,
        medium,
        ..
    } = *resources;
    let mut bound = vec![
        (BINDING_VOLUME, Bound::Uniform(volume)),
        (BINDING_MEDIUM, Bound::Uniform(medium)),
    ];
    let read: [(u32, &Image, _); 7] = [
        (BINDING_SHADOW, &medium_images.shadow, &medium_images.linear),
        (
            BINDING_ENVIRONMENT,
            &medium_images.environment,
            &scatter.nearest,
        ),
        (BINDING_PHASE, &medium_images.phase, &scatter.nearest),
        (BINDING_GRID_MEDIUM, &scatter.medium, &scatter.nearest),
        (BINDING_GRID_EMISSION, &scatter.emission, &scatter.nearest),
        (BINDING_BINS, &scatter.bins, &scatter.nearest),
        (
            BINDING_PHASE_MATRIX,
            &scatter.phase_matrix,
            &scatter.nearest,
        ),
    ];
    for (binding, image, sampler) in read {
        recorder.use_image(image, Access::SampledRead);
        bound.push((binding, sampled(image, sampler)));
    }
    for (binding, image) in [
        (BINDING_INTENSITY_STORE, &scatter.intensity),
        (BINDING_SOURCE_STORE, &scatter.source),
        (BINDING_FLUENCE_STORE, &scatter.fluence),
        (BINDING_SCATTERED_STORE, &medium_images.scattered),
    ] {
        recorder.use_image(image, Access::Storage);
        bound.push((binding, Bound::StorageImage(image)));
    }
    recorder.use_buffer(&scatter.residual, Access::Storage);
    bound.push((BINDING_RESIDUAL, Bound::Storage(&scatter.residual)));
    bound
}

fn groups_of(scatter: &ScatterImages) -> [u32; 3] {
    scatter.grid.points.map(|n| n.div_ceil(4))
}

fn zone_groups(scatter: &ScatterImages) -> [u32; 3] {
    let zones: u32 = scatter.grid.points.iter().product();
    [zones.div_ceil(64), 1, 1]
}
