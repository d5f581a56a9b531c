//! The state behind a renderer: data, images, passes, and what changes them.

use std::sync::Arc;

use glam::{DMat4, DVec3, DVec4};

use super::light::LightProgress;
use super::settings::Settings;
use super::{Frame, FrameReport, pass_name};
use crate::atlas::{
    Images, LIGHT_TEXEL_BYTES, LightLists, Residency, SampleLengths, SampleScale, Store,
    TransferTable, UploadResources, Uploads, Visibility,
};
use crate::error::Result;
use crate::gpu::{Context, Recorder, Uniforms};
use crate::pass::Reconstruction;
use crate::pass::bare::{BarePass, BareResources};
use crate::pass::light::{LightPass, LightResources};
use crate::pass::march::{MarchPass, MarchResources, MarchVariant};
use crate::scene::{Interpolation, Shading};
use crate::shader::structs::{FrameParams, VolumeParams};
use crate::volume::Volume;

/// Samples that one dispatch of the march takes at most: a quarter of a second at 0.5 billion a second.
const SAMPLES_A_DISPATCH: f64 = 1.3e8;

/// A volume with its settings, on the device.
pub(crate) struct Loaded {
    store: Store,
    settings: Settings,
    table: TransferTable,
    /// See [`TransferTable::has_exact_bins`]; found once for each change, not for each frame.
    exact_bins: bool,
    residency: Residency,
    visibility: Visibility,
    images: Images,
    lists: LightLists,
    light: Option<LightProgress>,
    uploads: Uploads,
    march_pass: MarchPass,
    light_pass: LightPass,
    bare_pass: BarePass,
    pub(super) tile: Option<u32>,
}

impl Loaded {
    pub(super) fn new(
        context: &Arc<Context>,
        volume: Arc<Volume>,
        settings: Settings,
    ) -> Result<Self> {
        let store = Store::new(volume)?;
        let table = TransferTable::new(&settings.curve, SampleScale::of(&store.volume));
        let residency = choose(context, &store, &table, &settings)?;
        let lit = settings.ambient_occlusion.is_some();
        let visibility = Visibility::new(&store, &residency, &table, lit);
        let images = Images::new(context, NAME, &store, &residency, lit)?;
        let lists = LightLists::new(context, NAME, &visibility.light)?;
        let light = light_progress(&store, &settings);
        let uploads = Uploads::all(&residency);
        let exact_bins =
            table.has_exact_bins(sample_lengths(&settings, store.volume.min_spacing()));
        Ok(Self {
            store,
            settings,
            table,
            exact_bins,
            residency,
            visibility,
            images,
            lists,
            light,
            uploads,
            march_pass: MarchPass::new(context)?,
            light_pass: LightPass::new(),
            bare_pass: BarePass::new(),
            tile: None,
        })
    }

    pub(super) fn settings(&self) -> &Settings {
        &self.settings
    }

    pub(crate) fn store(&self) -> &Store {
        &self.store
    }

    pub(crate) fn residency(&self) -> &Residency {
        &self.residency
    }

    pub(crate) fn visibility(&self) -> &Visibility {
        &self.visibility
    }

    pub(crate) fn images(&self) -> &Images {
        &self.images
    }

    pub(super) fn set_settings(
        &mut self,
        context: &Arc<Context>,
        settings: Settings,
    ) -> Result<()> {
        let reclassify = settings.curve != self.settings.curve;
        let lit = settings.ambient_occlusion.is_some();
        let was_lit = self.settings.ambient_occlusion.is_some();
        let relevel = reclassify || settings.storage != self.settings.storage || lit != was_lit;
        let table = if reclassify {
            TransferTable::new(&settings.curve, SampleScale::of(&self.store.volume))
        } else {
            self.table.clone()
        };
        let mut residency = None;
        if relevel {
            let selection = select(&self.store, &table, &settings)?;
            if selection.levels != self.residency.selection.levels {
                let max = context.capabilities().max_extent_3d;
                residency = Some(Residency::new(&self.store, selection, max)?);
            }
        }
        // Everything that can fail comes first, so that an error leaves the old state in force.
        let current = residency.as_ref().unwrap_or(&self.residency);
        let visibility = (reclassify || residency.is_some() || lit != was_lit)
            .then(|| Visibility::new(&self.store, current, &table, lit));
        let images = (residency.is_some() || lit != was_lit)
            .then(|| Images::new(context, NAME, &self.store, current, lit))
            .transpose()?;
        let lists = visibility
            .as_ref()
            .map(|v| LightLists::new(context, NAME, &v.light))
            .transpose()?;

        let same_light =
            images.is_none() && residency.is_none() && self.settings.same_light(&settings);
        if let Some(images) = images {
            self.images = images;
            self.uploads = Uploads::all(current);
        } else if reclassify {
            self.uploads.reclassify();
        }
        self.uploads.relength();
        if let Some(residency) = residency {
            self.residency = residency;
        }
        if let Some(visibility) = visibility {
            self.visibility = visibility;
        }
        if let Some(lists) = lists {
            self.lists = lists;
        }
        self.exact_bins =
            table.has_exact_bins(sample_lengths(&settings, self.store.volume.min_spacing()));
        self.table = table;
        self.settings = settings;
        if !same_light {
            self.light = light_progress(&self.store, &self.settings);
        }
        Ok(())
    }

    /// Recording a frame failed: whether the device will see what was recorded is up to the host, so everything is uploaded
    /// and traced again.
    pub(super) fn forget(&mut self) {
        self.images.forget();
        self.march_pass.forget();
        self.uploads = Uploads::all(&self.residency);
        self.light = light_progress(&self.store, &self.settings);
    }

    /// Directions traced, and all of them.
    pub(crate) fn light_progress(&self) -> (u32, u32) {
        self.light
            .as_ref()
            .map_or((0, 0), |l| (l.traced(), l.rays()))
    }

    /// True when every brick is on the device.
    pub(crate) fn bricks_complete(&self) -> bool {
        self.uploads.bricks_complete()
    }

    /// For a pass in which what emits does so with `emission`.
    fn reconstruction(&self, emission: bool) -> Reconstruction {
        Reconstruction {
            nearest: self.settings.march.interpolation == Interpolation::Nearest,
            manual: self.images.manual_filter,
            inter_block: self.settings.march.inter_block_interpolation,
            skipping: self.settings.march.empty_space_skipping,
            emission: emission && self.settings.curve.emits(),
            uniform_grid: self.residency.layout.is_grid() && self.uploads.bricks_complete(),
            exact_bins: self.exact_bins,
        }
    }

    pub(crate) fn volume_params(&self) -> VolumeParams {
        let volume = &self.store.volume;
        let (bin_from_sample, first_sample) = self.table.bin_from_sample();
        let gradient = volume.world_from_ix().matrix3.inverse().transpose();
        let bins = self.table.bins() as f32;
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
            pad0: 0.0,
            gradient_y_ws: gradient.y_axis.as_vec3().to_array(),
            pad1: 0.0,
            gradient_z_ws: gradient.z_axis.as_vec3().to_array(),
            pad2: 0.0,
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
            ..
        } = self;
        let mut uploaded_bytes = 0;
        if uploads.pending() {
            let distances = &visibility.distances;
            let lengths = sample_lengths(settings, store.volume.min_spacing());
            let resources = UploadResources {
                images,
                store,
                residency,
                table,
                lengths,
                distances,
            };
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

    /// Traces the next direction, if there is one and the bricks are complete.
    pub(super) fn record_light(
        &mut self,
        context: &Arc<Context>,
        recorder: &mut Recorder<'_>,
        volume: Uniforms,
    ) -> Result<()> {
        // Light follows the linear field, whatever the march does; emission only where it is asked for.
        let emission = self
            .settings
            .ambient_occlusion
            .as_ref()
            .is_some_and(|ao| ao.emission);
        let reconstruction = Reconstruction {
            nearest: false,
            ..self.reconstruction(emission)
        };
        if !self.uploads.bricks_complete() {
            return Ok(());
        }
        let Some(push) = self.light.as_mut().and_then(LightProgress::next) else {
            return Ok(());
        };
        let Self {
            images,
            lists,
            visibility,
            light_pass,
            ..
        } = self;
        let work = &visibility.light;
        recorder.pass(pass_name::LIGHT, |recorder| {
            let resources = LightResources {
                images,
                lists,
                work,
                volume,
            };
            light_pass.trace(context, recorder, reconstruction, &resources, push)
        })?;
        if work.seam.is_empty() {
            return Ok(());
        }
        recorder.pass(pass_name::LIGHT_SEAM, |recorder| {
            let resources = LightResources {
                images,
                lists,
                work,
                volume,
            };
            light_pass.seam(context, recorder, reconstruction, &resources)
        })
    }

    pub(super) fn record_march(
        &mut self,
        context: &Arc<Context>,
        recorder: &mut Recorder<'_>,
        volume: Uniforms,
        frame: &Frame<'_>,
    ) -> Result<()> {
        let target = frame.target;
        let params = self.frame_params(frame);
        let frame_uniforms = recorder.slot().uniforms(bytemuck::bytes_of(&params))?;
        let variant = MarchVariant {
            reconstruction: self.reconstruction(self.settings.lighting.emission),
            light: self.light.is_some(),
            diffuse: self.settings.lighting.shading == Shading::Diffuse,
            jitter: self.settings.march.jitter,
            aux: frame.aux.is_some(),
            scene_depth: frame.depth.is_some(),
            encode_srgb: target.encode_srgb,
            blend: target.blend.then_some(target.format),
        };
        let tile = self.tile.unwrap_or_else(|| self.default_tile());
        let Self {
            images, march_pass, ..
        } = self;
        recorder.pass(pass_name::MARCH, |recorder| {
            let resources = MarchResources {
                images,
                volume,
                frame: frame_uniforms,
                target: target.view,
                scene_depth: frame.depth.map(|d| (d.view, d.layout)),
                aux: frame.aux,
            };
            march_pass.record(context, recorder, variant, &resources, target.size_px, tile)
        })
    }

    pub(super) fn record_bare(
        &mut self,
        context: &Arc<Context>,
        recorder: &mut Recorder<'_>,
        volume: Uniforms,
        frame: &Frame<'_>,
    ) -> Result<()> {
        let params = self.frame_params(frame);
        let frame_uniforms = recorder.slot().uniforms(bytemuck::bytes_of(&params))?;
        let tile = self.tile.unwrap_or_else(|| self.default_tile());
        let Self {
            images,
            bare_pass,
            store,
            ..
        } = self;
        recorder.pass(pass_name::BARE, |recorder| {
            let resources = BareResources {
                images,
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

    /// The largest tile whose dispatch takes a bounded number of samples, a multiple of 8.
    pub(crate) fn default_tile(&self) -> u32 {
        let volume = &self.store.volume;
        let extent =
            DVec3::from_array(volume.size().map(f64::from)) * DVec3::from_array(volume.spacing());
        let longest = extent.length() / self.step_mm();
        ((SAMPLES_A_DISPATCH / longest).sqrt() as u32).clamp(8, 8192) / 8 * 8
    }

    fn step_mm(&self) -> f64 {
        self.settings.march.step * self.store.volume.min_spacing()
    }

    pub(crate) fn frame_params(&self, frame: &Frame<'_>) -> FrameParams {
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
        FrameParams {
            origin_ix: point(rays.origin),
            unit_exponent: (step_mm / curve.unit_distance) as f32,
            origin_dx_ix: vector(rays.origin_dx),
            early_termination: march.early_termination as f32,
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
            pad0: 0,
        }
    }
}

/// Prefix of object names.
const NAME: &str = "umbravox";

fn select(
    store: &Store,
    table: &TransferTable,
    settings: &Settings,
) -> Result<crate::volume::select::Selection> {
    let light = if settings.ambient_occlusion.is_some() {
        LIGHT_TEXEL_BYTES
    } else {
        0
    };
    Residency::select(store, table, &settings.storage, light)
}

fn choose(
    context: &Context,
    store: &Store,
    table: &TransferTable,
    settings: &Settings,
) -> Result<Residency> {
    let selection = select(store, table, settings)?;
    Residency::new(store, selection, context.capabilities().max_extent_3d)
}

/// Lengths that the transfer-function table is made for.
fn sample_lengths(settings: &Settings, voxel_mm: f64) -> SampleLengths {
    let unit = settings.curve.unit_distance;
    let light = settings.ambient_occlusion.as_ref().map_or(1.0, |ao| {
        let part = (ao.radius - ao.offset) / f64::from(ao.samples_per_ray());
        ao.gamma * part * voxel_mm / unit
    });
    SampleLengths {
        march: settings.march.step * voxel_mm / unit,
        light,
    }
}

fn light_progress(store: &Store, settings: &Settings) -> Option<LightProgress> {
    settings.ambient_occlusion.as_ref().map(|ao| {
        LightProgress::new(
            ao,
            &settings.curve,
            store.volume.world_from_ix().matrix3.inverse(),
            store.volume.min_spacing(),
        )
    })
}
