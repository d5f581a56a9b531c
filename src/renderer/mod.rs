//! A volume on a device, drawn frame by frame.
//!
//! [`Renderer`] owns the data, the images and the passes of one volume. It records; who submits is no concern of it
//! (`embed` for a host's command buffer, `headless` for our own).

mod beams;
mod draw;
mod gradients;
mod light;
mod loaded;
mod packed;
mod paths;
mod prepared;
mod rays;
mod scattered;
mod settings;
mod transport;

use std::sync::Arc;

use ash::vk;

use crate::error::{Error, Result};
use crate::gpu::{Access, Context, FrameSlots, Image, PassTime, Recorder};
use crate::pass::LARGEST_TILE;
use crate::volume::Volume;
use light::LightWorkload;

pub(crate) use loaded::Loaded;
pub(crate) use paths::Paths;
pub(crate) use rays::{RayBasis, ix_from_clip};

pub use rays::DepthRange;
pub use settings::Settings;

/// What a frame is drawn into, in `GENERAL` while the march runs.
#[derive(Clone, Copy)]
pub(crate) struct FrameTarget<'a> {
    /// The image, if it is ours: neither blended over nor encoded, and the barriers are up to us.
    pub(crate) own: Option<&'a Image>,
    pub(crate) view: vk::ImageView,
    pub(crate) format: vk::Format,
    pub(crate) size_px: [u32; 2],
    pub(crate) encode_srgb: bool,
    /// Composite over what the target holds, instead of over `background`.
    pub(crate) blend: bool,
    /// Linear; alpha 0: the result stays premultiplied over nothing.
    pub(crate) background: [f32; 4],
}

impl FrameTarget<'_> {
    /// To be asked for before passes that draw into it.
    fn use_own(&self, recorder: &mut Recorder<'_>) {
        if let Some(image) = self.own {
            recorder.use_image(image, Access::Storage);
        }
    }
}

/// The host's depth image, sampled in `layout`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FrameDepth {
    pub(crate) view: vk::ImageView,
    pub(crate) layout: vk::ImageLayout,
    pub(crate) range: DepthRange,
    pub(crate) ix_from_clip: glam::DMat4,
}

/// One frame.
pub(crate) struct Frame<'a> {
    pub(crate) rays: RayBasis,
    pub(crate) target: FrameTarget<'a>,
    pub(crate) depth: Option<FrameDepth>,
    /// Depth and sample counts are written here.
    pub(crate) aux: Option<&'a Image>,
    /// What comes through each channel is written here, where extinctions differ.
    pub(crate) through: Option<&'a Image>,
    /// Factor on the volume's radiance.
    pub(crate) exposure: f32,
    /// Seeds the jitter.
    pub(crate) number: u32,
    /// Bytes of bricks to upload at most.
    pub(crate) upload_budget: usize,
}

/// What to record of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Work {
    /// Uploads alone.
    UploadsOnly,
    /// Uploads, one direction of light, the picture.
    Everything,
    /// Uploads and one direction of light.
    LightOnly,
    /// Uploads and the picture.
    PictureOnly,
    /// The bench's bare march instead of the picture.
    Bare,
    /// The bench's bare light, in the direction that comes next; the light volume is lost.
    BareLight,
    /// One direction, of which samples of the field are counted; the light volume is lost.
    CountLight,
}

/// What a recorded frame does and what is still missing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FrameReport {
    /// Bricks on the device once the frame completes.
    pub bricks_resident: usize,
    /// Bricks still to be uploaded; regions they cover are drawn empty until then.
    pub bricks_missing: usize,
    /// Bytes of bricks that this frame uploads.
    pub uploaded_bytes: u64,
    /// Directions in the light volume once the frame completes; of optical models that scatter, iterations of their solver.
    pub light_traced: u32,
    /// Directions of the complete light volume, or iterations at most (fewer once it converges); 0: there is no such volume.
    pub light_rays: u32,
    /// Paths of every pixel of this view once the frame completes; 0: none are traced.
    pub paths_traced: u32,
    /// Paths that the scene asks for; later frames go on refining.
    pub paths: u32,
}

impl FrameReport {
    /// True when later frames of the same scene would look the same (but for jitter).
    pub fn is_complete(&self) -> bool {
        self.bricks_missing == 0
            && self.light_traced == self.light_rays
            && self.paths_traced >= self.paths
    }
}

/// Draws one volume. Any number of renderers share a [`Context`].
///
/// May be dropped at any time while the context lives: what frames in flight use is destroyed when the host's frame numbers
/// say so.
pub struct Renderer {
    context: Arc<Context>,
    slots: FrameSlots,
    loaded: Loaded,
    last_index: u64,
}

impl Renderer {
    /// Analyses a volume (on all CPU cores) and creates its images; nothing is recorded yet.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`], [`Error::Unsupported`] for extents beyond the device's limits, [`Error::Invalid`] for settings
    /// that are out of range ([`Settings::validate`]) or that no residency satisfies.
    pub fn new(context: &Arc<Context>, volume: Arc<Volume>, settings: Settings) -> Result<Self> {
        settings.validate()?;
        settings.check_volume(&volume)?;
        Ok(Self {
            context: context.clone(),
            slots: FrameSlots::default(),
            loaded: Loaded::new(context, volume, settings)?,
            last_index: 0,
        })
    }

    /// The context it draws with.
    pub fn context(&self) -> &Arc<Context> {
        &self.context
    }

    /// What it draws by.
    pub fn settings(&self) -> &Settings {
        self.loaded.settings()
    }

    /// Changes what it draws by. Levels are chosen again when the transfer function or the storage changed; the light starts
    /// again when transfer function, levels, its own settings or the way that voxels are read (`storage.packed_cells`, where the budget
    /// has room) did, and never otherwise. With `ambient_occlusion.sampling` `distance` and no `growth` a new light looks at voxels on
    /// the host first, for tenths of a second up to seconds.
    ///
    /// # Errors
    /// As [`Renderer::new`]; the old settings stay in force then.
    pub fn set_settings(&mut self, settings: Settings) -> Result<()> {
        settings.validate()?;
        settings.check_volume(&self.loaded.store().volume)?;
        self.loaded.set_settings(&self.context, settings)
    }

    /// Largest edge of a dispatch's tile, pixels; a multiple of 8. Changes no pixel.
    pub fn set_tile(&mut self, tile: Option<u32>) {
        self.loaded.tile = tile.map(|t| t.clamp(8, LARGEST_TILE).next_multiple_of(8));
    }

    /// GPU times (ms) of the passes of the newest frame known to have completed; empty where the device has no timestamps.
    pub fn pass_times(&self) -> Vec<(&'static str, f64)> {
        self.slots
            .latest_times()
            .iter()
            .map(|t| (t.name, t.ms))
            .collect()
    }

    /// The last pass known to have started: what to report when the host's submission says that the device was lost.
    pub fn last_pass(&self) -> Option<&'static str> {
        self.slots.last_started()
    }

    /// Traces the light again from the first direction.
    pub(crate) fn restart_light(&mut self) {
        self.loaded.restart_light();
    }

    /// The volume, its residency and its light, for readers.
    pub(crate) fn loaded(&self) -> &Loaded {
        &self.loaded
    }

    pub(crate) fn pass_times_of(&self, index: u64) -> Vec<PassTime> {
        self.slots.times_of(index)
    }

    /// Uploads and traces everything again from the next frame on: for a host that recorded a frame and then did not submit it.
    pub fn restart(&mut self) {
        self.slots.abandon(self.last_index);
        self.loaded.forget();
    }

    /// Checks the frame numbers and hands out what recording needs. A frame that fails does not count: the next one starts over.
    pub(crate) fn begin_frame<T>(
        &mut self,
        index: u64,
        completed: u64,
        recorder: impl FnOnce(&Arc<Context>, &mut FrameSlots, &mut Loaded) -> Result<T>,
    ) -> Result<T> {
        if index <= self.last_index || completed >= index {
            return Err(Error::invalid(
                "frame index",
                format!(
                    "frame {index} after frame {} with {completed} completed; indices must grow and be above what has \
                     completed",
                    self.last_index
                ),
            ));
        }
        self.context.retire.begin(index);
        let recorded = recorder(&self.context, &mut self.slots, &mut self.loaded);
        match &recorded {
            Ok(_) => self.last_index = index,
            Err(_) => {
                self.slots.abandon(index);
                self.loaded.forget();
            }
        }
        recorded
    }
}

/// Names of the passes, as labels, in timings and in crash reports.
pub(crate) mod pass_name {
    pub(crate) const UPLOAD: &str = "upload";
    pub(crate) const PACK_CELLS: &str = "pack_cells";
    pub(crate) const GRADIENTS: &str = "gradients";
    pub(crate) const PREINTEGRATE: &str = "preintegrate";
    pub(crate) const LIGHT: &str = "light";
    pub(crate) const LIGHT_SEAM: &str = "light_seam";
    pub(crate) const SHADOW: &str = "shadow";
    pub(crate) const SCATTER: &str = "scatter";
    pub(crate) const MARCH: &str = "march";
    pub(crate) const BARE: &str = "bare";
    pub(crate) const BARE_LIGHT: &str = "bare_light";
}

/// Records one frame.
pub(crate) fn record(
    context: &Arc<Context>,
    recorder: &mut Recorder<'_>,
    loaded: &mut Loaded,
    frame: &Frame<'_>,
    work: Work,
) -> Result<FrameReport> {
    let mut report = loaded.record_uploads(context, recorder, frame.upload_budget)?;
    loaded.record_packed_cells(context, recorder)?;
    let volume = recorder
        .slot()
        .uniforms(bytemuck::bytes_of(&loaded.volume_params()))?;
    if matches!(work, Work::Everything | Work::LightOnly) {
        loaded.record_light(context, recorder, volume, LightWorkload::Trace)?;
    }
    if matches!(work, Work::Everything | Work::LightOnly | Work::PictureOnly) {
        loaded.record_light_seam(context, recorder, volume, work != Work::LightOnly)?;
        let iterating = work != Work::PictureOnly;
        loaded.record_transport(context, recorder, volume, &frame.rays, iterating)?;
    }
    if matches!(work, Work::Everything | Work::PictureOnly) {
        loaded.record_gradients(context, recorder, volume)?;
        loaded.record_picture(context, recorder, volume, frame)?;
    }
    if work == Work::BareLight {
        loaded.record_light(context, recorder, volume, LightWorkload::Bare)?;
    }
    if work == Work::CountLight {
        loaded.record_light(context, recorder, volume, LightWorkload::Count)?;
    }
    if work == Work::Bare {
        loaded.record_bare(context, recorder, volume, frame)?;
    }
    // Of passes that found nothing to dispatch: images count as being in the layouts asked for.
    recorder.flush();
    (report.light_traced, report.light_rays) = loaded.light_progress();
    (report.paths_traced, report.paths) = loaded.path_progress();
    Ok(report)
}
