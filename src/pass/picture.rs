//! Pictures: front-to-back march, projections of values and isosurfaces, into a target image.
//!
//! Reads   atlas, cell ranges, labels, filtered gradients (SampledRead), index, skip, transfer and pre-integrated tables, packed corners,
//!         loaded gradients, light (SampledGeneral), the host's depth, what beams left
//!         (Indirect)
//! Writes  the target (Storage; read too when it is blended over), depths and sample counts (Storage)
//! Grid    one workgroup for 8x8 pixels, or for 8 beams that are listed; one dispatch a tile
//! Method  emission-absorption with exact opacity correction; skipping by leaps, one map for each octant of directions
//! Limits  a dispatch is one tile; its size is chosen so that no dispatch runs long, and changes no pixel
//! Twin    src/reference/march.rs

use std::sync::Arc;

use ash::vk;

use super::beams::{Beams, BeamsPass, march_tiles, tile_bytes};
use super::{
    Reconstruction, Rectangle, Variants, gradient_constant, sampled, use_field, use_gradients,
    use_labels, use_texel_buffer, use_texels,
};
use crate::atlas::{
    GradientTexels, GradientVolume, Images, LabelImages, MediumImages, TableImages,
};
use crate::error::Result;
use crate::gpu::{
    Access, Bound, Buffer, Context, Image, ImageInfo, MemoryLocation, Recorder, Sampler, Uniforms,
};
use crate::scene::{Classification, Gradient, Majorant, OpticalModel, RayProjection, Reflectance};
use crate::shader::PassInterface;
use crate::shader::generated::*;
use crate::shader::interface::{self, PicturePasses};

/// How the light that reaches a sample is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Shadowing {
    /// Nothing is in its way.
    None,
    /// From the swept volume.
    Swept,
    /// By rays from every sample.
    Rays,
}

/// What specializes a picture of an optical model beyond emission and absorption.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct TransportVariant {
    pub(crate) model: OpticalModel,
    /// `PHASE` in glsl/include/phase.glsl.
    pub(crate) phase: u32,
    /// The transfer function adds light whatever its opacity.
    pub(crate) glows: bool,
    pub(crate) shadows: Shadowing,
    pub(crate) reflectance: Reflectance,
    /// `ENVIRONMENT` in glsl/include/lights.glsl.
    pub(crate) environment: u32,
    /// Channels see different extinctions.
    pub(crate) chromatic: bool,
    /// There is a volume of scattered light.
    pub(crate) scattered: bool,
    /// Paths are traced instead, by these majorants.
    pub(crate) paths: Option<Majorant>,
}

impl TransportVariant {
    fn constants(self) -> [(u32, u32); 9] {
        let model = match self.model {
            OpticalModel::Absorption => 0,
            OpticalModel::Emission => 1,
            OpticalModel::EmissionAbsorption => 2,
            OpticalModel::SingleScattering
            | OpticalModel::ShadowedScattering
            | OpticalModel::MultipleScattering => 3,
        };
        let shadows = match self.shadows {
            Shadowing::None => 0,
            Shadowing::Swept => 1,
            Shadowing::Rays => 2,
        };
        let reflectance = match self.reflectance {
            Reflectance::Particles => 0,
            Reflectance::Lambert => 1,
            Reflectance::Phong => 2,
            Reflectance::BlinnPhong => 3,
            Reflectance::CookTorrance => 4,
        };
        [
            (SPEC_MODEL, model),
            (SPEC_PHASE, self.phase),
            (SPEC_GLOWS, self.glows.into()),
            (SPEC_SHADOWS, shadows),
            (SPEC_REFLECTANCE, reflectance),
            (SPEC_ENVIRONMENT, self.environment),
            (SPEC_CHROMATIC, self.chromatic.into()),
            (SPEC_SCATTERED, self.scattered.into()),
            (
                SPEC_GLOBAL_MAJORANT,
                (self.paths == Some(Majorant::Global)).into(),
            ),
        ]
    }
}

/// What specializes a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct PictureVariant {
    pub(crate) reconstruction: Reconstruction,
    pub(crate) projection: RayProjection,
    pub(crate) classification: Classification,
    pub(crate) light: bool,
    /// Lambert's law.
    pub(crate) diffuse: bool,
    pub(crate) gradient: Gradient,
    /// Gradients are read, not estimated.
    pub(crate) stored_gradients: Option<GradientTexels>,
    /// An optical model that the march of emission and absorption does not know.
    pub(crate) transport: Option<TransportVariant>,
    /// Samples have the colours of the data.
    pub(crate) data_color: bool,
    /// Beams find out first where rays have something to do.
    pub(crate) beams: bool,
    /// The target holds the background already.
    pub(crate) cleared: bool,
    /// Beams look cells between voxels up, and have a bit for each segment.
    pub(crate) shown_cells: bool,
    /// Rays search for samples that show something before they do what those alone need.
    pub(crate) searched: bool,
    /// Subgroups do so together, where there is a module for the target.
    pub(crate) votes: bool,
    /// Rays take samples two by two.
    pub(crate) paired: bool,
    pub(crate) jitter: bool,
    pub(crate) aux: bool,
    pub(crate) scene_depth: bool,
    pub(crate) encode_srgb: bool,
    /// Format of a target that is blended over.
    pub(crate) blend: Option<vk::Format>,
}

impl PictureVariant {
    /// The march's, or that of the beams before it.
    fn interface_of(self, passes: &'static PicturePasses) -> &'static PassInterface {
        match self.blend {
            None => &passes.any,
            Some(vk::Format::R8G8B8A8_UNORM) => &passes.blend_rgba8,
            Some(vk::Format::R16G16B16A16_SFLOAT) => &passes.blend_rgba16f,
            Some(_) => &passes.blend_rgba32f,
        }
    }

    fn interface(self) -> &'static PassInterface {
        let votes = self.searched && self.votes && self.blend.is_none();
        let passes: &PicturePasses = match self.projection {
            _ if self.transport.is_some_and(|t| t.paths.is_some()) => &interface::PATHTRACE,
            _ if self.transport.is_some() => &interface::TRANSPORT,
            RayProjection::Composite | RayProjection::Xray => match self.classification {
                Classification::Preintegrated if votes => return &interface::MARCH_ENDS_VOTES,
                Classification::Post | Classification::Pre if votes => {
                    return &interface::MARCH_VOTES;
                }
                Classification::Preintegrated => &interface::MARCH_ENDS,
                Classification::Post | Classification::Pre => &interface::MARCH,
            },
            RayProjection::Maximum | RayProjection::Minimum | RayProjection::Mean => {
                &interface::EXTREMUM
            }
            RayProjection::Isosurface => &interface::ISOSURFACE,
        };
        self.interface_of(passes)
    }

    /// Formats of targets that can be blended over.
    pub(crate) const BLENDABLE: [vk::Format; 3] = [
        vk::Format::R8G8B8A8_UNORM,
        vk::Format::R16G16B16A16_SFLOAT,
        vk::Format::R32G32B32A32_SFLOAT,
    ];

    fn constants(self) -> Vec<(u32, u32)> {
        let classification = match self.classification {
            Classification::Post => 0,
            Classification::Pre => 1,
            Classification::Preintegrated => 2,
        };
        let of_values = match self.projection {
            RayProjection::Minimum => 1,
            RayProjection::Mean => 2,
            _ => 0,
        };
        let mut constants = self.reconstruction.constants();
        constants.extend([
            (SPEC_CLASSIFICATION, classification),
            (SPEC_GRADIENT, gradient_constant(self.gradient)),
            (
                SPEC_STORED_GRADIENTS,
                self.stored_gradients.map_or(0, |t| t as u32),
            ),
            (SPEC_PROJECTION, of_values),
            (SPEC_XRAY, (self.projection == RayProjection::Xray).into()),
            (SPEC_LIGHT, self.light.into()),
            (SPEC_DIFFUSE, self.diffuse.into()),
            (SPEC_DATA_COLOR, self.data_color.into()),
            (SPEC_BEAMS, self.beams.into()),
            (SPEC_CLEARED, self.cleared.into()),
            (SPEC_SEARCHED, self.searched.into()),
            (SPEC_SHOWN_CELLS, self.shown_cells.into()),
            (SPEC_PAIRED, self.paired.into()),
            (SPEC_JITTER, self.jitter.into()),
            (SPEC_AUX, self.aux.into()),
            (SPEC_SCENE_DEPTH, self.scene_depth.into()),
            (SPEC_ENCODE_SRGB, self.encode_srgb.into()),
        ]);
        constants.extend(
            self.transport
                .into_iter()
                .flat_map(TransportVariant::constants),
        );
        constants
    }
}

/// What the picture of one frame is made from.
pub(crate) struct PictureResources<'a> {
    pub(crate) images: &'a Images,
    pub(crate) labels: Option<&'a LabelImages>,
    /// The volume of gradients.
    pub(crate) gradients: Option<&'a GradientVolume>,
    /// Of pre-integrated classification.
    pub(crate) tables: Option<&'a TableImages>,
    /// Value ranges of skip cells, of projections of values.
    pub(crate) range: Option<&'a Image>,
    pub(crate) volume: Uniforms,
    pub(crate) frame: Uniforms,
    /// Of isosurfaces.
    pub(crate) surfaces: Option<Uniforms>,
    /// Of optical models beyond emission and absorption.
    pub(crate) medium: Option<(&'a MediumImages, Uniforms)>,
    /// Sums over paths: radiance, its square, what came through.
    pub(crate) paths: Option<[&'a Image; 3]>,
    /// What comes through each channel.
    pub(crate) through: Option<&'a Image>,
    /// The target, in `GENERAL`.
    pub(crate) target: vk::ImageView,
    /// The host's depth, in the layout given.
    pub(crate) scene_depth: Option<(vk::ImageView, vk::ImageLayout)>,
    /// Depths and sample counts.
    pub(crate) aux: Option<&'a Image>,
    /// What beams leave for the march.
    pub(crate) beams: Option<&'a Beams>,
}

/// What the march of a medium reads of it.
fn use_medium<'a>(recorder: &mut Recorder<'_>, images: &'a MediumImages) -> [(u32, Bound<'a>); 5] {
    [
        (BINDING_MAJORANT, &images.majorant, &images.nearest),
        (BINDING_SHADOW, &images.shadow, &images.linear),
        (BINDING_SCATTERED, &images.scattered, &images.linear),
        (BINDING_ENVIRONMENT, &images.environment, &images.nearest),
        (BINDING_PHASE, &images.phase, &images.nearest),
    ]
    .map(|(binding, image, sampler)| {
        recorder.use_image(image, Access::SampledRead);
        (binding, sampled(image, sampler))
    })
}

/// The pass.
pub(crate) struct PicturePass {
    variants: Variants,
    beams_pass: BeamsPass,
    /// Stands in for images that a variant does not read, and for outputs it does not write.
    unused_sampled: Image,
    unused_volume: Image,
    unused_storage: Image,
    unused_table: Image,
    unused_buffer: Buffer,
    nearest: Sampler,
}

impl PicturePass {
    pub(crate) fn new(context: &Arc<Context>) -> Result<Self> {
        let unused = |name, format, three_dimensional, usage| {
            let extent = [1; 3];
            Image::new(
                context,
                &ImageInfo {
                    name,
                    extent,
                    format,
                    three_dimensional,
                    usage,
                },
            )
        };
        let sampled = vk::ImageUsageFlags::SAMPLED;
        Ok(Self {
            variants: Variants::default(),
            beams_pass: BeamsPass::default(),
            unused_sampled: unused(
                "umbravox.picture.no_image",
                vk::Format::R32_SFLOAT,
                false,
                sampled,
            )?,
            unused_volume: unused(
                "umbravox.picture.no_volume",
                vk::Format::R32_SFLOAT,
                true,
                sampled,
            )?,
            unused_storage: unused(
                "umbravox.picture.no_aux",
                vk::Format::R32G32B32A32_SFLOAT,
                false,
                vk::ImageUsageFlags::STORAGE,
            )?,
            unused_table: unused(
                "umbravox.picture.no_table",
                vk::Format::R32G32B32A32_SFLOAT,
                false,
                sampled | vk::ImageUsageFlags::STORAGE,
            )?,
            unused_buffer: Buffer::new(
                context,
                "umbravox.picture.no_beams",
                16,
                vk::BufferUsageFlags::STORAGE_BUFFER,
                MemoryLocation::Device,
            )?,
            nearest: Sampler::new(
                context,
                "umbravox.picture.nearest",
                crate::gpu::Filter::Nearest,
            )?,
        })
    }

    /// Nothing is known of the state of the stand-ins; see [`Image::forget`].
    pub(crate) fn forget(&self) {
        self.unused_sampled.forget();
        self.unused_volume.forget();
        self.unused_storage.forget();
        self.unused_table.forget();
    }

    pub(crate) fn record(
        &mut self,
        context: &Arc<Context>,
        recorder: &mut Recorder<'_>,
        variant: PictureVariant,
        resources: &PictureResources<'_>,
        area: Rectangle,
        tile: u32,
    ) -> Result<()> {
        let interface = variant.interface();
        let pipeline = self.variants.get(context, interface, variant.constants())?;
        let PictureResources {
            images,
            labels,
            gradients,
            tables,
            range,
            volume,
            frame,
            surfaces,
            medium,
            paths,
            through,
            target,
            scene_depth,
            aux,
            beams,
        } = *resources;
        let mut bound = use_field(recorder, images);
        recorder.use_image(&images.light, Access::SampledGeneral);
        recorder.use_image(&self.unused_sampled, Access::SampledRead);
        recorder.use_image(&self.unused_volume, Access::SampledRead);
        let tables = [
            (
                [BINDING_PREINTEGRATED, BINDING_PREINTEGRATED_LOADS],
                tables.map(|t| &t.table),
            ),
            (
                [
                    BINDING_PREINTEGRATED_EMISSION,
                    BINDING_PREINTEGRATED_EMISSION_LOADS,
                ],
                tables.map(|t| &t.emission),
            ),
        ];
        let range = range.unwrap_or(&self.unused_volume);
        recorder.use_image(range, Access::SampledRead);
        let aux = aux.unwrap_or(&self.unused_storage);
        recorder.use_image(aux, Access::Storage);
        let light = Bound::Sampled {
            image: &images.light,
            sampler: &images.linear,
            general: true,
        };
        let depth = match scene_depth {
            Some((view, layout)) => Bound::SampledView {
                view,
                layout,
                sampler: &self.nearest,
            },
            None => sampled(&self.unused_sampled, &self.nearest),
        };
        let color = match &images.color {
            Some(color) => {
                recorder.use_image(&color.image, Access::SampledRead);
                sampled(&color.image, &images.linear)
            }
            // Another image of its kind, which is not read.
            None => sampled(&images.atlas, images.atlas_sampler()),
        };
        bound.extend(use_labels(recorder, images, labels));
        bound.extend([
            (BINDING_VOLUME, Bound::Uniform(volume)),
            (BINDING_FRAME, Bound::Uniform(frame)),
            (BINDING_LIGHT, light),
            (BINDING_COLOR, color),
            (BINDING_SCENE_DEPTH, depth),
            (BINDING_TARGET, Bound::StorageView(target)),
            (BINDING_AUX, Bound::StorageImage(aux)),
            (BINDING_RANGE, sampled(range, &self.nearest)),
        ]);
        let no_cells = &images.no_texels.shown_cells;
        let shown_cells = images.shown_cells.as_ref().unwrap_or(no_cells);
        let shown_cells = use_texel_buffer(recorder, shown_cells);
        bound.push((BINDING_SHOWN_CELLS, shown_cells));
        let unused = (&self.unused_volume, &images.linear);
        bound.extend(use_gradients(recorder, images, gradients, unused));
        for (bindings, table) in tables {
            let table = table.unwrap_or(&self.unused_table);
            bound.extend(use_texels(recorder, bindings, table, &self.nearest));
        }
        bound.extend(surfaces.map(|s| (BINDING_SURFACES, Bound::Uniform(s))));
        if let Some((medium_images, params)) = medium {
            let through = through.unwrap_or(&self.unused_storage);
            recorder.use_image(through, Access::Storage);
            bound.push((BINDING_THROUGH, Bound::StorageImage(through)));
            bound.push((BINDING_MEDIUM, Bound::Uniform(params)));
            bound.extend(use_medium(recorder, medium_images));
        }
        let bindings = [
            BINDING_PATHS_SUM,
            BINDING_PATHS_SQUARE,
            BINDING_PATHS_THROUGH,
        ];
        for (binding, image) in bindings.into_iter().zip(paths.into_iter().flatten()) {
            recorder.use_image(image, Access::Storage);
            bound.push((binding, Bound::StorageImage(image)));
        }
        // Each kind of picture takes its own selection.
        if let Some(beams) = beams {
            bound.extend(beams.bound());
            let interface = variant.interface_of(&interface::BEAMS);
            let constants = variant.constants();
            self.beams_pass.record(
                context, recorder, interface, constants, &bound, beams, area, tile,
            )?;
            recorder.bind(pipeline, &bound)?;
            let runs = context.capabilities().dispatch_runs;
            for (_, push) in march_tiles(area, tile, runs) {
                let at = tile_bytes(runs) * u64::from(push.beam_tile);
                recorder.dispatch_indirect(pipeline, &push, &beams.tiles, at);
            }
            return Ok(());
        }
        for binding in [BINDING_BEAM_TILES, BINDING_BEAM_LIST, BINDING_BEAM_RUNS] {
            bound.push((binding, Bound::Storage(&self.unused_buffer)));
        }
        recorder.bind(pipeline, &bound)?;
        for (tile, push) in march_tiles(area, tile, 1) {
            recorder.dispatch(pipeline, &push, tile.groups());
        }
        Ok(())
    }
}
