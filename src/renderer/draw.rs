//! What a frame records, and the parameters it hands to the shaders.

use std::sync::Arc;

use glam::{DAffine3, DMat3, DMat4, DVec3, DVec4};

use super::loaded::{Loaded, sample_lengths};
use super::scattered::ScatterInputs;
use super::settings::Settings;
use super::transport::{Transport, environment_kind, phase_kind};
use super::{Frame, FrameReport, Paths, RayBasis, pass_name};
use crate::atlas::{GradientTexels, GradientVolume, PackedCells, Pages, UploadResources};
use crate::error::{Error, Result};
use crate::gpu::{Context, Recorder, Uniforms};
use crate::pass::bare::BareResources;
use crate::pass::beams::BeamLengths;
use crate::pass::picture::{PictureResources, PictureVariant};
use crate::pass::scatter::ScatterVariant;
use crate::pass::shadow::ShadowResources;
use crate::pass::{LARGEST_TILE, Reconstruction, Rectangle};
use crate::scene::{OpticalModel, RayProjection, Shading};
use crate::shader::structs::{FrameParams, SurfaceParams, VolumeParams};

/// Samples that one dispatch of the march takes at most: a quarter of a second at 0.5 billion a second.
const SAMPLES_A_DISPATCH: f64 = 1.3e8;

/// Share of voxels that show something, where anything does, from which on all samples are shaded.
const SHOWN_FOR_ALL: f64 = 0.5;

/// Edge of the tiles that paths are traced in: nobody knows how long they become.
const PATHS_TILE: u32 = 128;

impl Loaded {
    /// For a pass in which what emits does so with `emission`.
    pub(super) fn reconstruction(&self, emission: bool) -> Reconstruction {
        Reconstruction {
            interpolation: self.settings.march.interpolation,
            manual: self.images.manual_filter,
            packed_cells: self.packed_sample_bytes(),
            inter_block: self.settings.march.inter_block_interpolation,
            skipping: self.settings.march.empty_space_skipping,
            emission: emission && self.settings.curve.emits(),
            uniform_grid: self.is_uniform_grid(),
            exact_bins: self.exact_bins,
            labels: self.labels.is_some(),
        }
    }

    /// Every block is there at the finest level, and bricks lie as their blocks do.
    pub(super) fn is_uniform_grid(&self) -> bool {
        self.residency.layout.is_grid() && self.uploads.bricks_complete()
    }

    pub(crate) fn volume_params(&self) -> VolumeParams {
        let volume = &self.store.volume;
        let (bin_from_sample, first_sample) = self.table.bin_from_sample();
        let gradient = volume.world_from_ix().matrix3.inverse().transpose();
        let bins = self.table.bins() as f32;
        let preintegration = self.table.preintegration();
        let labels = self.settings.labels.as_ref();
        let label_ix = labels.map_or(DAffine3::IDENTITY, |l| l.map().ix_from(volume));
        let label_row = |axis: usize| {
            let row = label_ix.matrix3.row(axis);
            let row = row.extend(label_ix.translation[axis]);
            row.as_vec4().to_array()
        };
        let (table_end, table_tail) = preintegration.map_or((0.0, 0.0), |p| p.ends());
        let packed = self.images.packed_cells.as_ref().map(PackedCells::pages);
        let gradients = self.gradients.as_ref().and_then(GradientVolume::pages);
        let strides = |pages: Option<Pages>| pages.map_or([0; 2], Pages::strides);
        let [packed_row, packed_layer] = strides(packed);
        let [gradient_row, gradient_layer] = strides(gradients);
        let gradient_unit = self.gradients.as_ref().map_or(1.0, GradientVolume::unit);
        VolumeParams {
            field_ix: volume.size().map(|n| (n - 1) as f32),
            bin_from_sample: bin_from_sample as f32,
            atlas_texel: self.images.atlas.extent().map(|n| 1.0 / n as f32),
            first_sample: first_sample as f32,
            blocks: self.store.grid().counts().map(|n| n as i32),
            last_bin: bins - 1.0,
            skip_extent: self.residency.cells.counts().map(|n| n as i32),
            bins,
            gradient_x_ws: gradient.x_axis.as_vec3().to_array(),
            table_end: table_end as f32,
            gradient_y_ws: gradient.y_axis.as_vec3().to_array(),
            table_tail: table_tail as f32,
            gradient_z_ws: gradient.z_axis.as_vec3().to_array(),
            gradient_unit,
            label_ix_from_ix_x: label_row(0),
            label_ix_from_ix_y: label_row(1),
            label_ix_from_ix_z: label_row(2),
            pages: [packed_row, packed_layer, gradient_row, gradient_layer],
        }
    }

    pub(super) fn record_uploads(
        &mut self,
        context: &Arc<Context>,
        recorder: &mut Recorder<'_>,
        budget: usize,
    ) -> Result<FrameReport> {
        let Self {
            uploads,
            images,
            store,
            residency,
            table,
            visibility,
            settings,
            prepared,
            labels,
            ..
        } = self;
        let mut uploaded_bytes = 0;
        let resources = UploadResources {
            images,
            store,
            residency,
            table,
            lengths: sample_lengths(settings, store.volume.min_spacing()),
            leaps: &visibility.leaps,
        };
        prepared.record(context, recorder, &resources, settings)?;
        if let (Some(images), Some(labels)) = (labels, &settings.labels) {
            images.record(context, recorder, labels)?;
        }
        if uploads.pending() {
            uploaded_bytes = recorder.pass(pass_name::UPLOAD, |recorder| {
                uploads.record(context, recorder, &resources, budget)
            })?;
        }
        let missing = uploads.missing_bricks();
        Ok(FrameReport {
            bricks_resident: residency.selection.levels.resident() - missing,
            bricks_missing: missing,
            uploaded_bytes,
            ..Default::default()
        })
    }

    /// Brings the light volumes of the optical model up to date, if it has any.
    pub(super) fn record_transport(
        &mut self,
        context: &Arc<Context>,
        recorder: &mut Recorder<'_>,
        volume: Uniforms,
        rays: &RayBasis,
        iterating: bool,
    ) -> Result<()> {
        let Some(medium) = self.medium_uniforms(recorder)? else {
            return Ok(());
        };
        let complete = self.uploads.bricks_complete();
        let reconstruction = self.reconstruction(false);
        let Self {
            transport,
            images,
            labels,
            shadow_pass,
            scatter_pass,
            settings,
            ..
        } = self;
        let Some(transport) = transport else {
            return Ok(());
        };
        transport.record_images(context, recorder)?;
        if !complete {
            return Ok(());
        }
        let sweeps = std::mem::take(&mut transport.sweeps);
        if let (Some(grid), false) = (transport.shadow_grid(), sweeps.is_empty()) {
            let resources = ShadowResources {
                images,
                labels: labels.as_ref(),
                medium_images: &transport.images,
                grid,
                volume,
                medium,
            };
            recorder.pass(pass_name::SHADOW, |recorder| {
                shadow_pass.record(context, recorder, reconstruction, &resources, &sweeps)
            })?;
        }
        let Transport {
            images: medium_images,
            scattered: Some(scattered),
            ..
        } = transport
        else {
            return Ok(());
        };
        let variant = ScatterVariant {
            reconstruction: Reconstruction {
                emission: settings.curve.emits(),
                ..reconstruction
            },
            phase: phase_kind(&settings.lighting.phase),
            environment: environment_kind(settings),
            glows: settings.curve.glows(),
        };
        let inputs = ScatterInputs {
            images,
            labels: labels.as_ref(),
            medium_images,
            volume,
            medium,
            phase: &settings.lighting.phase,
            variant,
        };
        recorder.pass(pass_name::SCATTER, |recorder| {
            scattered.record(context, recorder, scatter_pass, &inputs, rays, iterating)
        })?;
        Ok(())
    }

    /// The medium's parameters, where the optical model has one.
    fn medium_uniforms(&self, recorder: &mut Recorder<'_>) -> Result<Option<Uniforms>> {
        let samples_per_value = 1.0 / self.table.samples().scale;
        let params = self
            .transport
            .as_ref()
            .map(|t| t.params(self.step_mm(), samples_per_value));
        params
            .map(|p| recorder.slot().uniforms(bytemuck::bytes_of(&p)))
            .transpose()
    }

    pub(super) fn record_picture(
        &mut self,
        context: &Arc<Context>,
        recorder: &mut Recorder<'_>,
        volume: Uniforms,
        frame: &Frame<'_>,
    ) -> Result<()> {
        let target = frame.target;
        self.check_rounds(context)?;
        let (beams, lengths) = self
            .take_beams(context, &frame.rays, target.size_px)?
            .unzip();
        let mut params = self.frame_params(frame, lengths);
        if self.settings.traces_paths() {
            params.frame = self.next_path(context, frame)?;
        }
        let frame_uniforms = recorder.slot().uniforms(bytemuck::bytes_of(&params))?;
        let surfaces = match self.settings.march.projection {
            RayProjection::Isosurface => {
                let params = self.surface_params();
                Some(recorder.slot().uniforms(bytemuck::bytes_of(&params))?)
            }
            _ => None,
        };
        let medium = self.medium_uniforms(recorder)?;
        let cleared = target.own.filter(|_| beams.is_some());
        let area = match cleared {
            Some(_) => self.shown_pixels(&frame.rays, target.size_px),
            None => Rectangle::of_size(target.size_px),
        };
        let Settings {
            march, lighting, ..
        } = &self.settings;
        let diffuse = lighting.shading == Shading::Diffuse;
        let capabilities = context.capabilities();
        let singly = lengths.is_some_and(|lengths| lengths.singly);
        let searched = self.light.is_some()
            || self.labels.is_some()
            || diffuse && self.settings.composites() && self.searches_for_shading(context, singly);
        let reconstruction = self.reconstruction(lighting.emission);
        let classification = march.classification();
        let stored_gradients = self.read_gradients().map(GradientVolume::texels);
        let shades_pairs = !diffuse || stored_gradients.is_some_and(GradientTexels::are_loaded);
        let variant = PictureVariant {
            reconstruction,
            projection: march.projection,
            classification,
            light: self.light.is_some(),
            diffuse,
            gradient: lighting.gradient,
            stored_gradients,
            transport: self.transport.as_ref().map(Transport::variant),
            data_color: self.images.color.is_some(),
            beams: beams.is_some(),
            cleared: cleared.is_some(),
            shown_cells: singly,
            searched,
            votes: capabilities.votes && capabilities.loads_texels,
            // Searches take samples one by one.
            paired: reconstruction.pairs(classification) && !searched && shades_pairs,
            jitter: march.jitter,
            aux: frame.aux.is_some(),
            scene_depth: frame.depth.is_some(),
            encode_srgb: target.encode_srgb,
            blend: target.blend.then_some(target.format),
        };
        let mut tile = self.march_tile();
        if self.settings.traces_paths() {
            tile = tile.min(PATHS_TILE);
        }
        let Self {
            images,
            labels,
            picture_pass,
            prepared,
            transport,
            paths,
            gradients: gradient_volume,
            uploads,
            ..
        } = self;
        // Depths where nothing shows, no samples; the last is the optical depth of X-rays, and of others a depth.
        let far = f32::INFINITY;
        let last = if march.projection == RayProjection::Xray {
            0.0
        } else {
            far
        };
        let no_layers = [far, 0.0, far, last];
        let recorded = recorder.pass(pass_name::MARCH, |recorder| {
            if let Some(image) = cleared {
                recorder.clear_to(image, target.background);
                if let Some(aux) = frame.aux {
                    recorder.clear_to(aux, no_layers);
                }
            }
            target.use_own(recorder);
            let resources = PictureResources {
                images,
                labels: labels.as_ref(),
                gradients: super::gradients::read(gradient_volume.as_ref(), uploads),
                tables: prepared.tables(),
                range: prepared.range(),
                volume,
                frame: frame_uniforms,
                surfaces,
                medium: transport.as_ref().map(|t| &t.images).zip(medium),
                paths: paths.as_ref().map(|p| [&p.sum, &p.square, &p.through]),
                through: frame.through,
                target: target.view,
                scene_depth: frame.depth.map(|d| (d.view, d.layout)),
                aux: frame.aux,
                beams: beams.as_ref(),
            };
            picture_pass.record(context, recorder, variant, &resources, area, tile)
        });
        self.beams = beams;
        recorded
    }

    /// Whether what is only shaded is searched for: processors shade all samples by stored gradients faster where most of them show
    /// something. `singly`: beams have left out most of those that show nothing.
    fn searches_for_shading(&self, context: &Context, singly: bool) -> bool {
        if !context.capabilities().loads_texels || self.read_gradients().is_none() {
            return true;
        }
        !singly && *self.share_shown.get_or_init(|| self.share_shown()) < SHOWN_FOR_ALL
    }

    /// Refuses pictures of which some device would leave a part out without a word.
    ///
    /// # Errors
    /// [`Error::Unsupported`] where rays may take more samples than all loops of an invocation have rounds.
    fn check_rounds(&self, context: &Context) -> Result<()> {
        let Some(most) = context.capabilities().max_loop_rounds else {
            return Ok(());
        };
        let segments = self.longest_mm() / self.step_mm();
        let lighting = &self.settings.lighting;
        let by_rays = self
            .transport
            .as_ref()
            .is_some_and(Transport::casts_shadow_rays);
        // A shadow ray looks at 16 samples a round, and leaps.
        let of_shadows = if by_rays {
            lighting.lights.len() as f64 * (segments / 16.0 + 8.0)
        } else {
            0.0
        };
        // Pixels of a group that differ go through each other's rounds: runs of 8 to 32 samples take up to twice as many as a ray alone, and
        // searches for samples that show something, where those are shaded or looked up among labels, as much again for each share
        // of samples that shows, 1, 1/2, 1/4 and so on.
        let searched =
            self.light.is_some() || self.labels.is_some() || lighting.shading == Shading::Diffuse;
        let of_samples = if searched { 5.5 } else { 2.5 };
        let rounds = segments * (of_samples + of_shadows);
        if rounds <= f64::from(most) {
            return Ok(());
        }
        Err(Error::Unsupported {
            device: context.capabilities().name.clone(),
            need: format!(
                "rays of up to {segments:.0} samples{}, {rounds:.0} rounds of loops",
                if by_rays {
                    ", each with rays to the lights"
                } else {
                    ""
                }
            ),
            have: format!(
                "{most}, and it ends loops silently after that; give a larger march.step{}",
                if by_rays {
                    ", or the shadow method \"sweep\""
                } else {
                    ""
                }
            ),
        })
    }

    /// Number of the path that this frame adds to every pixel; 0 for rays that the sums are not of.
    fn next_path(&mut self, context: &Arc<Context>, frame: &Frame<'_>) -> Result<u32> {
        let size_px = frame.target.size_px;
        if !self.uploads.bricks_complete() || frame.depth.is_some() {
            // Of a volume with holes nothing is kept; nor where the host's geometry may have moved, which nobody tells us.
            self.paths = None;
        }
        let paths = match self.paths.take() {
            Some(paths) if paths.are_of(&frame.rays, size_px) => paths,
            _ => Paths::new(context, "umbravox", frame.rays, size_px)?,
        };
        Ok(self.paths.insert(paths).next())
    }

    pub(super) fn record_bare(
        &mut self,
        context: &Arc<Context>,
        recorder: &mut Recorder<'_>,
        volume: Uniforms,
        frame: &Frame<'_>,
    ) -> Result<()> {
        let params = self.frame_params(frame, None);
        let frame_uniforms = recorder.slot().uniforms(bytemuck::bytes_of(&params))?;
        let tile = self.march_tile();
        // Its positions are those of an atlas that is the volume itself.
        let packed_cells = if self.residency.layout.is_grid() {
            self.packed_sample_bytes()
        } else {
            0
        };
        let Self {
            images,
            bare_pass,
            store,
            ..
        } = self;
        recorder.pass(pass_name::BARE, |recorder| {
            frame.target.use_own(recorder);
            let resources = BareResources {
                images,
                packed_cells,
                size: store.volume.size(),
                volume,
                frame: frame_uniforms,
                target: frame.target.view,
            };
            bare_pass.record(context, recorder, &resources, frame.target.size_px, tile)
        })
    }

    /// Light added everywhere.
    pub(crate) fn light_bias(&self) -> f32 {
        self.settings
            .ambient_occlusion
            .as_ref()
            .map_or(0.0, |ao| ao.bias) as f32
    }

    /// Edge of the tiles that pictures are drawn in.
    pub(super) fn march_tile(&self) -> u32 {
        self.tile.unwrap_or_else(|| self.default_tile())
    }

    /// The largest tile whose dispatch takes a bounded number of samples, a multiple of 8.
    pub(crate) fn default_tile(&self) -> u32 {
        let longest = self.longest_mm() / self.step_mm();
        ((SAMPLES_A_DISPATCH / longest).sqrt() as u32).clamp(8, LARGEST_TILE) / 8 * 8
    }

    /// Longest way through the volume, at least. Axes need not be at right angles: one of the four diagonals is the longest.
    pub(super) fn longest_mm(&self) -> f64 {
        let volume = &self.store.volume;
        let size = DVec3::from_array(volume.size().map(f64::from));
        let edges = volume.world_from_ix().matrix3 * DMat3::from_diagonal(size);
        let [x, y, z] = [edges.x_axis, edges.y_axis, edges.z_axis];
        let diagonals = [x + y + z, x + y - z, x - y + z, y + z - x];
        diagonals.map(DVec3::length).into_iter().fold(0.0, f64::max)
    }

    pub(super) fn step_mm(&self) -> f64 {
        self.settings.march.step * self.store.volume.min_spacing()
    }

    /// `beams`: how rays are cut into runs, where the picture's are.
    pub(crate) fn frame_params(
        &self,
        frame: &Frame<'_>,
        beams: Option<BeamLengths>,
    ) -> FrameParams {
        let Settings {
            march,
            lighting,
            curve,
            depth_threshold,
            ..
        } = &self.settings;
        let ix_from_world = self.store.volume.world_from_ix().inverse();
        let step_mm = self.step_mm();
        let rays = frame.rays;
        let point = |p: DVec3| ix_from_world.transform_point3(p).as_vec3().to_array();
        let vector = |v: DVec3| ix_from_world.transform_vector3(v).as_vec3().to_array();
        let step = |v: DVec3| vector(v * step_mm);
        let world = |v: DVec3| v.as_vec3().to_array();
        let clip = frame.depth.map_or(DMat4::IDENTITY, |d| d.ix_from_clip);
        let row = |r: DVec4| r.as_vec4().to_array();
        let light_direction = lighting
            .direction
            .map(|d| DVec3::from_array(d).normalize_or_zero().extend(1.0))
            .unwrap_or(DVec4::ZERO);
        let samples = self.table.samples();
        FrameParams {
            origin_ix: point(rays.origin),
            unit_exponent: (step_mm / curve.unit_distance) as f32,
            origin_dx_ix: vector(rays.origin_dx),
            early_termination: self.early_termination(),
            origin_dy_ix: vector(rays.origin_dy),
            depth_threshold: *depth_threshold as f32,
            direction_ix: step(rays.direction),
            step_mm: step_mm as f32,
            direction_dx_ix: step(rays.direction_dx),
            light_bias: self.light_bias(),
            direction_dy_ix: step(rays.direction_dy),
            ambient: lighting.ambient as f32,
            direction_ws: world(rays.direction),
            diffuse: lighting.diffuse as f32,
            direction_dx_ws: world(rays.direction_dx),
            scene_depth_far: frame.depth.map_or(1.0, |d| d.range.far()),
            direction_dy_ws: world(rays.direction_dy),
            jitter_seed: march.seed,
            background: frame.target.background,
            light_direction_ws: row(light_direction),
            ix_from_clip_x: row(clip.row(0)),
            ix_from_clip_y: row(clip.row(1)),
            ix_from_clip_z: row(clip.row(2)),
            ix_from_clip_w: row(clip.row(3)),
            size_px: frame.target.size_px,
            frame: frame.number,
            value_from_sample: samples.scale as f32,
            value_offset: samples.offset as f32,
            exposure: frame.exposure,
            beam_shift: beams.map_or(0, |b| b.shift),
            beam_words: beams.map_or(0, |b| b.words),
        }
    }

    /// Opacity at which rays stop; above 1: never.
    fn early_termination(&self) -> f32 {
        let Settings {
            march, lighting, ..
        } = &self.settings;
        match march.projection {
            // Optical depth goes on growing when all is dark.
            RayProjection::Xray => 2.0,
            _ if lighting.model == OpticalModel::Absorption => 2.0,
            _ => march.early_termination as f32,
        }
    }

    fn surface_params(&self) -> SurfaceParams {
        let samples = self.table.samples();
        let mut params = SurfaceParams {
            values: [[f32::MAX; 4]; 2],
            colors: [[0.0; 4]; 8],
            count: self.settings.surfaces.len() as u32,
            bisections: bisections(self.settings.march.step),
            pad0: 0.0,
            pad1: 0.0,
        };
        let mut surfaces: Vec<_> = self
            .settings
            .surfaces
            .iter()
            .map(|s| (samples.sample(s.value) as f32, s))
            .collect();
        // A falling rescale turns the order around.
        surfaces.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (i, (sample, surface)) in surfaces.into_iter().enumerate() {
            let [r, g, b] = surface.color.map(|c| c as f32);
            params.values[i / 4][i % 4] = sample;
            params.colors[i] = [r, g, b, surface.opacity as f32];
        }
        params
    }
}

/// Bisections that find a surface in a step to 1/200 voxel; what is left is interpolated.
fn bisections(step: f64) -> u32 {
    (200.0 * step).log2().ceil().max(0.0) as u32
}
