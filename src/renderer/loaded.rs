//! The state behind a renderer: data, images, passes, and what changes them.

use std::sync::{Arc, OnceLock};

use super::RayBasis;
use super::beams::most_shown;
use super::gradients::gradients;
use super::light::LightProgress;
use super::packed::packing;
use super::paths::Paths;
use super::prepared::Prepared;
use super::settings::Settings;
use super::transport::Transport;
use crate::atlas::{
    COLOR_TEXEL_BYTES, GradientVolume, Images, LIGHT_TEXEL_BYTES, LabelImages, LightLists,
    PackedCells, Residency, SampleLengths, SampleScale, Shown, Store, TransferTable, Uploads,
    Visibility, VisibilityRequest,
};
use crate::error::Result;
use crate::gpu::Context;
use crate::occlusion;
use crate::pass::bare::BarePass;
use crate::pass::bare_light::BareLightPass;
use crate::pass::beams::Beams;
use crate::pass::gradients::GradientsPass;
use crate::pass::light::LightPass;
use crate::pass::pack_cells::PackCellsPass;
use crate::pass::picture::PicturePass;
use crate::pass::scatter::ScatterPass;
use crate::pass::shadow::ShadowPass;
use crate::scene::{Classification, RayProjection};
use crate::volume::Volume;

/// A volume with its settings, on the device.
pub(crate) struct Loaded {
    pub(super) store: Store,
    pub(super) settings: Settings,
    pub(super) table: TransferTable,
    /// See [`TransferTable::has_exact_bins`]; found once for each change, not for each frame.
    pub(super) exact_bins: bool,
    pub(super) residency: Residency,
    pub(super) visibility: Visibility,
    pub(super) images: Images,
    pub(super) lists: LightLists,
    pub(super) prepared: Prepared,
    pub(super) gradients: Option<GradientVolume>,
    pub(super) labels: Option<LabelImages>,
    pub(super) light: Option<LightProgress>,
    pub(super) transport: Option<Transport>,
    pub(super) paths: Option<Paths>,
    pub(super) beams: Option<Beams>,
    pub(super) uploads: Uploads,
    pub(super) picture_pass: PicturePass,
    pub(super) light_pass: LightPass,
    pub(super) gradients_pass: GradientsPass,
    pub(super) pack_cells_pass: PackCellsPass,
    pub(super) shadow_pass: ShadowPass,
    pub(super) scatter_pass: ScatterPass,
    pub(super) bare_pass: BarePass,
    pub(super) bare_light_pass: BareLightPass,
    pub(super) tile: Option<u32>,
    /// [`Loaded::share_shown`], once it was asked for.
    pub(super) share_shown: OnceLock<f64>,
}

impl Loaded {
    pub(super) fn new(
        context: &Arc<Context>,
        volume: Arc<Volume>,
        settings: Settings,
    ) -> Result<Self> {
        let store = Store::new(volume)?;
        let table = transfer_table(&store, &settings);
        let residency = choose(context, &store, &table, &settings)?;
        let lit = settings.ambient_occlusion.is_some();
        let visibility = Visibility::new(&visibility_request(
            context, &store, &residency, &table, &settings,
        ))?;
        let prepared = Prepared::new(context, NAME, &table, &residency, &settings)?;
        let mut images = Images::new(context, NAME, &store, &residency, lit, settings.data_color)?;
        let labels = label_images(context, &settings)?;
        let gradients = gradients(context, &store, &residency, &settings)?;
        images.packed_cells = packing(context, &store, &residency, &settings, gradients.as_ref())
            .map(|packing| PackedCells::new(context, NAME, packing))
            .transpose()?;
        images.shown_cells = Images::shown_cells(context, NAME, visibility.cells.as_deref())?;
        let lists = LightLists::new(context, NAME, &visibility.light)?;
        let light = light_progress(&store, &settings, None);
        let uploads = Uploads::all(&residency);
        let transport = Transport::new(context, NAME, &store, &residency, &table, &settings)?;
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
            prepared,
            gradients,
            labels,
            light,
            transport,
            paths: None,
            beams: None,
            uploads,
            picture_pass: PicturePass::new(context)?,
            light_pass: LightPass::default(),
            gradients_pass: GradientsPass::default(),
            pack_cells_pass: PackCellsPass::default(),
            shadow_pass: ShadowPass::default(),
            scatter_pass: ScatterPass::default(),
            bare_pass: BarePass::default(),
            bare_light_pass: BareLightPass::default(),
            tile: None,
            share_shown: OnceLock::new(),
        })
    }

    pub(crate) fn settings(&self) -> &Settings {
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
        let old = &self.settings;
        // What picks values differently shows other cells and keeps other levels.
        let reclassify = settings.curve != old.curve
            || settings.surfaces != old.surfaces
            || settings.march.projection != old.march.projection
            || settings.march.interpolation != old.march.interpolation
            || settings.march.classification() != old.march.classification()
            || settings.is_preintegrated() != old.is_preintegrated();
        let lit = settings.ambient_occlusion.is_some();
        let was_lit = old.ambient_occlusion.is_some();
        let color = settings.data_color;
        let reimage = lit != was_lit || color != old.data_color;
        let relevel = reclassify || settings.storage != old.storage || reimage;
        let table = if reclassify {
            transfer_table(&self.store, &settings)
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
        let lights_other = lit_reach(&self.store, &settings) != lit_reach(&self.store, old);
        let request = visibility_request(context, &self.store, current, &table, &settings);
        let visibility = if residency.is_some() || lights_other {
            Some(Visibility::new(&request)?)
        } else if reclassify || most_shown(context, &settings) != most_shown(context, old) {
            self.visibility.changed(&request)?
        } else {
            None
        };
        let reprepare = reclassify || residency.is_some() || settings.march.step != old.march.step;
        let prepared = if reprepare {
            self.prepared
                .other_images(context, NAME, &table, current, &settings)?
        } else {
            None
        };
        let images = (residency.is_some() || reimage)
            .then(|| Images::new(context, NAME, &self.store, current, lit, color))
            .transpose()?;
        let map = |settings: &Settings| settings.labels.as_ref().map(|l| Arc::as_ptr(l.map()));
        let labels = (map(&settings) != map(old))
            .then(|| label_images(context, &settings))
            .transpose()?;
        let regradient = residency.is_some()
            || reimage
            || settings.stored_gradient() != old.stored_gradient()
            || settings.interpolates() != old.interpolates()
            || settings.storage != old.storage;
        let gradients = regradient
            .then(|| gradients(context, &self.store, current, &settings))
            .transpose()?;
        let other_places = visibility.is_some()
            || shading_reach(&self.store, &settings) != shading_reach(&self.store, old);
        let kept = gradients.as_ref().unwrap_or(&self.gradients).as_ref();
        let packing = packing(context, &self.store, current, &settings, kept);
        // Texels of an atlas that stays need not be packed again.
        let repack = images.is_some()
            || packing != self.images.packed_cells.as_ref().map(PackedCells::packing);
        let cells = repack
            .then(|| {
                packing
                    .map(|packing| PackedCells::new(context, NAME, packing))
                    .transpose()
            })
            .transpose()?;
        let seen = visibility.as_ref().unwrap_or(&self.visibility);
        let shown_cells = (visibility.is_some() || images.is_some())
            .then(|| Images::shown_cells(context, NAME, seen.cells.as_deref()))
            .transpose()?;
        let lists = visibility
            .as_ref()
            .map(|v| LightLists::new(context, NAME, &v.light))
            .transpose()?;

        let transport = match &self.transport {
            Some(transport) if residency.is_none() && transport.serves(&settings) => None,
            None if !settings.transports() => None,
            _ => Some(Transport::new(
                context,
                NAME,
                &self.store,
                current,
                &table,
                &settings,
            )?),
        };

        // Chosen by looking at many rays; labels and levels have no part in it.
        let growth = self
            .settings
            .same_light_rays(&settings)
            .then(|| self.light_growth());
        // Light that was read in another way differs in last bits.
        let same_light = images.is_none()
            && cells.is_none()
            && residency.is_none()
            && self.settings.same_light(&settings)
            && visibility
                .as_ref()
                .is_none_or(|new| new.light.lists_equal(&self.visibility.light));
        if let Some(images) = images {
            self.images = images;
            self.uploads = Uploads::all(current);
        }
        if let Some(cells) = cells {
            self.images.packed_cells = cells;
        }
        if let Some(shown_cells) = shown_cells {
            self.images.shown_cells = shown_cells;
        }
        self.uploads.reclassify();
        self.share_shown = OnceLock::new();
        if let Some(residency) = residency {
            residency.warn_of_coarser(&settings.storage);
            self.residency = residency;
        }
        if let Some(visibility) = visibility {
            if !Arc::ptr_eq(&visibility.leaps, &self.visibility.leaps) {
                self.uploads.leap_anew();
            }
            self.visibility = visibility;
        }
        if let Some(gradients) = gradients {
            self.gradients = gradients;
        } else if let (Some(gradients), true) = (&mut self.gradients, other_places) {
            gradients.look_again();
        }
        if let Some(lists) = lists {
            self.lists = lists;
        }
        if let Some(transport) = transport {
            self.transport = transport;
            self.paths = None;
        }
        if reprepare {
            self.prepared.renew(prepared);
        }
        if let Some(labels) = labels {
            self.labels = labels;
        } else if let Some(labels) = &mut self.labels {
            labels.restyle();
        }
        self.exact_bins =
            table.has_exact_bins(sample_lengths(&settings, self.store.volume.min_spacing()));
        self.table = table;
        self.settings = settings;
        if !same_light {
            self.light = light_progress(&self.store, &self.settings, growth);
        }
        Ok(())
    }

    /// Recording a frame failed: whether the device will see what was recorded is up to the host, so everything is uploaded
    /// and traced again.
    pub(super) fn forget(&mut self) {
        self.images.forget();
        self.picture_pass.forget();
        self.prepared.forget();
        self.gradients.iter_mut().for_each(GradientVolume::forget);
        self.transport.iter_mut().for_each(Transport::forget);
        self.paths.iter_mut().for_each(Paths::forget);
        self.beams.iter_mut().for_each(Beams::forget);
        self.labels.iter_mut().for_each(LabelImages::forget);
        self.uploads = Uploads::all(&self.residency);
        self.restart_light();
    }

    pub(super) fn restart_light(&mut self) {
        self.light.iter_mut().for_each(LightProgress::restart);
    }

    /// By how many parts of a ray of light each distance between samples is longer than the one before; `None`: not at all.
    pub(crate) fn light_growth(&self) -> Option<f64> {
        self.light.as_ref().and_then(LightProgress::growth)
    }

    /// Directions traced, and all of them; of scattered light the iterations.
    pub(crate) fn light_progress(&self) -> (u32, u32) {
        let scattered = self.transport.as_ref().and_then(|t| t.scattered.as_ref());
        match (&self.light, scattered) {
            (Some(light), _) => (light.traced(), light.rays()),
            (None, Some(scattered)) => scattered.progress(),
            (None, None) => (0, 0),
        }
    }

    /// True when there is local ambient occlusion.
    pub(crate) fn is_occluded(&self) -> bool {
        self.light.is_some()
    }

    /// Of optical models that scatter: iterations of the solver, its residual where that is known, paths of every pixel.
    pub(crate) fn scattering_progress(&self) -> Option<(u32, Option<f64>, u32)> {
        let transport = self.transport.as_ref()?;
        if !self.settings.lighting.model.scatters() {
            return None;
        }
        let (iterations, residual) = match &transport.scattered {
            None => (0, None),
            // What cannot be read is not known.
            Some(scattered) => (scattered.progress().0, scattered.residual().ok().flatten()),
        };
        Some((iterations, residual, self.path_progress().0))
    }

    /// Paths of every pixel of the last view, and those that the scene asks for; 0 where none are traced.
    pub(crate) fn path_progress(&self) -> (u32, u32) {
        if !self.settings.traces_paths() {
            return (0, 0);
        }
        let traced = self.paths.as_ref().map_or(0, Paths::traced);
        (traced, self.settings.lighting.scattering.samples)
    }

    /// The same, for rays that need not be those of the last view.
    pub(crate) fn path_progress_of(&self, rays: &RayBasis, size_px: [u32; 2]) -> (u32, u32) {
        let (_, asked) = self.path_progress();
        let paths = self.paths.as_ref().filter(|p| p.are_of(rays, size_px));
        (paths.map_or(0, Paths::traced), asked)
    }

    /// The sums of the paths, where some were traced.
    pub(crate) fn paths(&self) -> Option<&Paths> {
        self.paths.as_ref()
    }

    /// True when every brick is on the device.
    pub(crate) fn bricks_complete(&self) -> bool {
        self.uploads.bricks_complete()
    }
}

/// Prefix of object names.
pub(super) const NAME: &str = "umbravox";

fn label_images(context: &Arc<Context>, settings: &Settings) -> Result<Option<LabelImages>> {
    let labels = settings.labels.as_ref();
    labels
        .map(|labels| LabelImages::new(context, NAME, labels))
        .transpose()
}

fn transfer_table(store: &Store, settings: &Settings) -> TransferTable {
    TransferTable::new(
        &settings.curve,
        SampleScale::of(&store.volume),
        settings.is_preintegrated(),
    )
}

pub(super) fn shown<'a>(table: &'a TransferTable, settings: &'a Settings) -> Shown<'a> {
    let lit = settings.ambient_occlusion.is_some();
    Shown::new(table, &settings.march, &settings.surfaces, lit)
}

fn visibility_request<'a>(
    context: &Context,
    store: &'a Store,
    residency: &'a Residency,
    table: &'a TransferTable,
    settings: &'a Settings,
) -> VisibilityRequest<'a> {
    VisibilityRequest {
        store,
        residency,
        shown: shown(table, settings),
        interpolation: settings.march.interpolation,
        lit: lit_reach(store, settings),
        cells: most_shown(context, settings),
    }
}

/// [`shading_reach`] where there is light.
fn lit_reach(store: &Store, settings: &Settings) -> Option<[u32; 3]> {
    let lit = settings.ambient_occlusion.is_some();
    lit.then(|| shading_reach(store, settings))
}

/// How far from a place that shows something a sample may be that is lit for it, in voxels.
pub(super) fn shading_reach(store: &Store, settings: &Settings) -> [u32; 3] {
    if !settings.is_preintegrated() {
        return [0; 3];
    }
    // A segment shows what lies between its ends, and is lit at its middle.
    let half_mm = 0.5 * settings.march.step * store.volume.min_spacing();
    let ix_from_world = store.volume.world_from_ix().matrix3.inverse();
    let size = store.volume.size();
    // Beyond the volume nothing is lit: steps of any length look as far as it goes.
    std::array::from_fn(|axis| {
        let reach = (half_mm * ix_from_world.row(axis).length()).ceil() as u32;
        reach.min(size[axis])
    })
}

fn select(
    store: &Store,
    table: &TransferTable,
    settings: &Settings,
) -> Result<crate::volume::select::Selection> {
    let others = other_texel_bytes(settings);
    Residency::select(store, &shown(table, settings), &settings.storage, others)
}

/// Bytes that a texel of the atlas has beside its value.
pub(super) fn other_texel_bytes(settings: &Settings) -> u32 {
    let light = settings
        .ambient_occlusion
        .as_ref()
        .map(|_| LIGHT_TEXEL_BYTES);
    let color = settings.data_color.map(|_| COLOR_TEXEL_BYTES);
    light.unwrap_or(0) + color.unwrap_or(0)
}

fn choose(
    context: &Context,
    store: &Store,
    table: &TransferTable,
    settings: &Settings,
) -> Result<Residency> {
    let selection = select(store, table, settings)?;
    let residency = Residency::new(store, selection, context.capabilities().max_extent_3d)?;
    residency.warn_of_coarser(&settings.storage);
    Ok(residency)
}

/// Lengths that the transfer-function table is made for.
pub(super) fn sample_lengths(settings: &Settings, voxel_mm: f64) -> SampleLengths {
    let unit = settings.curve.unit_distance;
    let Settings { march, .. } = settings;
    let light = settings.ambient_occlusion.as_ref().map_or(1.0, |ao| {
        let part = (ao.radius - ao.offset) / f64::from(ao.samples_per_ray());
        ao.gamma * part * voxel_mm / unit
    });
    SampleLengths {
        // Voxels that are classified, and values that rays project, have no length of their own.
        march: match (march.projection, march.classification()) {
            (
                RayProjection::Composite | RayProjection::Xray,
                Classification::Post | Classification::Preintegrated,
            ) => march.step * voxel_mm / unit,
            _ => 1.0,
        },
        light,
    }
}

/// `growth`: of the distances between samples, where it is known; finding it may take seconds.
fn light_progress(
    store: &Store,
    settings: &Settings,
    growth: Option<Option<f64>>,
) -> Option<LightProgress> {
    settings.ambient_occlusion.as_ref().map(|ao| {
        let choose = || occlusion::growth(&store.volume, &settings.curve, ao);
        LightProgress::new(
            ao,
            &settings.curve,
            store.volume.world_from_ix().matrix3.inverse(),
            store.volume.min_spacing(),
            growth.unwrap_or_else(choose),
        )
    })
}
