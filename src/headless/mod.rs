//! Rendering without a host: a device of our own, pictures read back.

mod frame_time;
mod images;
mod light_volume;
mod limits;
mod probe;
mod provenance;
mod stats;

use std::sync::{Arc, Mutex, PoisonError};

use self::frame_time::Stopwatch;
use self::images::{
    PICTURE_FORMAT, PICTURE_TEXEL_BYTES, picture_image, read_back, texels, through_image,
};
use crate::embed::record_owned;
use crate::error::{Error, Result};
use crate::gpu::{HostMemory, Image, OwnedDevice, OwnedDeviceInfo};
use crate::picture::{Measured, Picture};
use crate::renderer::{Frame, FrameReport, FrameTarget, RayBasis, Renderer, Settings, Work};
use crate::scene::{OpticalModel, RayProjection, Scene, View};
use crate::volume::Volume;

pub use crate::gpu::DeviceInfo;
pub use frame_time::FrameTime;
pub use light_volume::LightVolume;
pub use probe::{Hit, PixelProbe};
pub use provenance::Provenance;
pub use stats::{
    BlockStats, DeviceStats, ImageStats, LightStats, MemoryStats, PassStats, SampleStats,
    ScatteringStats, Stats,
};

/// Bytes of bricks uploaded by one submission.
const UPLOAD_BYTES: usize = 64 << 20;
/// Paths of a pixel before its noise says something.
const LEAST_PATHS: u32 = 16;

/// How the device is opened.
#[derive(Clone, Debug)]
pub struct Options {
    /// Index, or a part of the name, as `umbravox devices` lists them; `None`: the best usable device.
    pub device: Option<String>,
    /// Turn validation and synchronization validation on; see [`Headless::validation_messages`].
    pub validation: bool,
    /// Keep compiled pipelines in the user's cache folder. Default true.
    pub pipeline_cache: bool,
    /// Edge of the tiles that a picture is computed in, pixels; changes no pixel. `None`: chosen by the work.
    pub tile: Option<u32>,
    /// Where device memory comes from. Default gpu-allocator.
    pub memory: MemoryChoice,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            device: None,
            validation: false,
            pipeline_cache: true,
            tile: None,
            memory: MemoryChoice::GpuAllocator,
        }
    }
}

/// Memory back ends that a device of our own can use.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MemoryChoice {
    /// The gpu-allocator crate.
    #[default]
    GpuAllocator,
    /// AMD's Vulkan Memory Allocator.
    #[cfg(feature = "vk-mem")]
    Vma,
}

/// Every device that the Vulkan loader finds, usable or not.
///
/// # Errors
/// [`Error::NoDevice`] when there is no Vulkan loader or no driver.
pub fn devices() -> Result<Vec<DeviceInfo>> {
    crate::gpu::list_devices()
}

type SharedDevice = Arc<Mutex<OwnedDevice>>;

/// An open device.
pub struct Headless {
    device: SharedDevice,
    tile: Option<u32>,
}

impl Headless {
    /// Opens a device.
    ///
    /// # Errors
    /// [`Error::NoDevice`] when none is usable, or none as named; the message lists those that are there.
    pub fn new(options: &Options) -> Result<Self> {
        let device = OwnedDevice::open(&OwnedDeviceInfo {
            device: options.device.clone(),
            validation: options.validation,
            pipeline_cache: options.pipeline_cache,
            memory: Some(match options.memory {
                MemoryChoice::GpuAllocator => HostMemory::GpuAllocator,
                #[cfg(feature = "vk-mem")]
                MemoryChoice::Vma => HostMemory::Vma,
            }),
        })?;
        Ok(Self {
            device: Arc::new(Mutex::new(device)),
            tile: options.tile,
        })
    }

    /// The device.
    pub fn device(&self) -> DeviceInfo {
        lock(&self.device).info.clone()
    }

    /// What the validation layer said so far; empty without validation.
    pub fn validation_messages(&self) -> Vec<String> {
        lock(&self.device).validation_messages()
    }

    /// Puts a volume on the device, as a scene says. The scene's own volume path is not looked at.
    ///
    /// # Errors
    /// [`Error::Invalid`] for scenes that are not valid, [`Error::OutOfMemory`], [`Error::Unsupported`].
    pub fn load(&self, volume: Arc<Volume>, scene: &Scene) -> Result<Session> {
        let settings = Settings::of_scene(scene, &volume)?;
        let view = scene.view(&volume, &settings.curve)?;
        Session::new(
            self.device.clone(),
            volume,
            settings,
            view,
            scene.image.size,
            self.tile,
        )
    }
}

fn lock(device: &SharedDevice) -> std::sync::MutexGuard<'_, OwnedDevice> {
    device.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What the shaders measure besides colour.
fn measured(settings: &Settings) -> Measured {
    match settings.march.projection {
        _ if settings.lighting.model == OpticalModel::Absorption => Measured::OpticalDepth,
        RayProjection::Composite | RayProjection::Isosurface => Measured::ExpectedDepth,
        RayProjection::Xray => Measured::OpticalDepth,
        RayProjection::Maximum | RayProjection::Minimum | RayProjection::Mean => Measured::Value,
    }
}

/// Of the paths of every pixel: their mean, and the variance of that mean.
struct Moments {
    mean: Vec<[f32; 3]>,
    variance: Vec<[f32; 3]>,
}

/// A volume on a device of our own, with a camera.
pub struct Session {
    renderer: Renderer,
    target: Image,
    /// Depth, sample count, median depth, and what the projection measures.
    aux: Image,
    /// What comes through each channel, where extinctions differ.
    through: Option<Image>,
    view: View,
    times: stats::Times,
    /// Sample counts of the last picture, once read back.
    samples: Option<u64>,
    /// The last picture has depths and sample counts.
    layered: bool,
    /// Dropped last.
    device: SharedDevice,
}

impl Session {
    fn new(
        device: SharedDevice,
        volume: Arc<Volume>,
        settings: Settings,
        view: View,
        [width, height]: [u32; 2],
        tile: Option<u32>,
    ) -> Result<Self> {
        let context = lock(&device).context().clone();
        let limit = context.capabilities().max_extent_2d;
        if width > limit || height > limit {
            return Err(Error::invalid(
                "image.size",
                format!("{width} x {height} is beyond this device's {limit} x {limit}"),
            ));
        }
        let image = |name| picture_image(&context, name, [width, height]);
        let through = through_image(&context, [width, height], &settings)?;
        let mut renderer = Renderer::new(&context, volume, settings)?;
        renderer.set_tile(tile);
        let mut session = Self {
            renderer,
            target: image("umbravox.picture")?,
            aux: image("umbravox.picture.aux")?,
            through,
            view,
            times: stats::Times::default(),
            samples: None,
            layered: false,
            device,
        };
        while session.submit(Work::UploadsOnly)?.bricks_missing > 0 {}
        Ok(session)
    }

    /// Width and height, pixels.
    pub fn size(&self) -> [u32; 2] {
        let [width, height, _] = self.target.extent();
        [width, height]
    }

    /// Directions of the complete light volume; 0 when ambient occlusion is off.
    pub fn light_rays(&self) -> u32 {
        self.renderer.loaded().light_progress().1
    }

    /// Traces one more direction of light. True while directions are left.
    ///
    /// # Errors
    /// [`Error::DeviceLost`], [`Error::Vulkan`].
    pub fn refine_light(&mut self) -> Result<bool> {
        let (traced, rays) = self.renderer.loaded().light_progress();
        if traced == rays {
            return Ok(false);
        }
        let report = self.submit(Work::LightOnly)?;
        Ok(report.light_traced < report.light_rays)
    }

    /// Moves the camera; the light stays.
    pub fn set_view(&mut self, view: View) {
        self.view = view;
    }

    /// Changes transfer function, shading, light or storage; see [`Renderer::set_settings`].
    ///
    /// # Errors
    /// As [`Renderer::set_settings`].
    pub fn set_settings(&mut self, settings: Settings) -> Result<()> {
        let through = through_image(self.renderer.context(), self.size(), &settings)?;
        self.renderer.set_settings(settings)?;
        self.through = through;
        self.samples = None;
        if self.renderer.loaded().light_progress().0 == 0 {
            self.times.restart_light();
        }
        while !self.renderer.loaded().bricks_complete() {
            self.submit(Work::UploadsOnly)?;
        }
        Ok(())
    }

    /// What it draws by.
    pub fn settings(&self) -> &Settings {
        self.renderer.settings()
    }

    /// One picture with the light as far as it has come, read back; of Monte Carlo with all its paths. Its number, for the
    /// jitter, is the number of directions traced.
    ///
    /// # Errors
    /// [`Error::DeviceLost`], [`Error::Vulkan`], [`Error::OutOfMemory`].
    pub fn frame(&mut self) -> Result<Picture> {
        while self.refine_paths()? {}
        // Nothing is left to draw where paths have drawn it.
        if self.path_progress().0 == 0 {
            self.draw(true)?;
        }
        let rgba = texels(&self.read_back(&self.target, PICTURE_TEXEL_BYTES)?);
        let aux: Vec<[f32; 4]> = texels(&self.read_back(&self.aux, PICTURE_TEXEL_BYTES)?);
        let through = self
            .through
            .as_ref()
            .map(|through| self.read_back(through, PICTURE_TEXEL_BYTES))
            .transpose()?
            .map(|bytes| {
                texels(&bytes)
                    .into_iter()
                    .map(|[r, g, b, _]| [r, g, b])
                    .collect()
            });
        let variance = self.moments()?.map(|moments| moments.variance);
        let samples: Vec<u32> = aux.iter().map(|a| a[1] as u32).collect();
        self.samples = Some(samples.iter().map(|&n| u64::from(n)).sum());
        Ok(Picture {
            size: self.size(),
            rgba,
            depth: aux.iter().map(|a| a[0]).collect(),
            median_depth: aux.iter().map(|a| a[2]).collect(),
            measure: aux.iter().map(|a| a[3]).collect(),
            measured: measured(self.settings()),
            through,
            variance,
            samples,
        })
    }

    /// Traces one more path from every pixel. True while paths are left, and the noise is above what the scene allows.
    ///
    /// # Errors
    /// As [`Session::frame`].
    pub fn refine_paths(&mut self) -> Result<bool> {
        let (traced, paths) = self.path_progress();
        if traced >= paths {
            return Ok(false);
        }
        self.draw(true)?;
        let traced = traced + 1;
        let noise = self.settings().lighting.scattering.noise;
        // Looked at when the number of paths has doubled: reading back costs as much as some paths.
        if noise > 0.0 && traced >= LEAST_PATHS && traced.is_power_of_two() {
            let (error, mean) = self.noise()?;
            return Ok(traced < paths && error > noise * mean);
        }
        Ok(traced < paths)
    }

    /// Paths of every pixel of this view so far, and those that the scene asks for; 0 where none are traced.
    pub fn path_progress(&self) -> (u32, u32) {
        self.renderer
            .loaded()
            .path_progress_of(&self.view_rays(), self.size())
    }

    fn view_rays(&self) -> RayBasis {
        RayBasis::from_view(&self.view, self.size())
    }

    /// Root mean square standard error of the pixels' means, and the mean of the picture, over all channels.
    fn noise(&mut self) -> Result<(f64, f64)> {
        let Some(Moments { mean, variance }) = self.moments()? else {
            return Ok((0.0, 0.0));
        };
        let count = 3.0 * mean.len() as f64;
        let sum = |values: &[[f32; 3]]| {
            values
                .as_flattened()
                .iter()
                .copied()
                .map(f64::from)
                .sum::<f64>()
        };
        Ok(((sum(&variance) / count).sqrt(), sum(&mean) / count))
    }

    /// Mean radiance of every pixel's paths, and the variance of that mean.
    fn moments(&mut self) -> Result<Option<Moments>> {
        let Some(paths) = self.renderer.loaded().paths() else {
            return Ok(None);
        };
        let n = f64::from(paths.traced().max(1));
        let sums = texels(&self.read_back(&paths.sum, PICTURE_TEXEL_BYTES)?);
        let squares = texels(&self.read_back(&paths.square, PICTURE_TEXEL_BYTES)?);
        let mean = |s: [f32; 4]| std::array::from_fn(|c| (f64::from(s[c]) / n) as f32);
        let variance = |(s, q): (&[f32; 4], &[f32; 4])| {
            std::array::from_fn(|c| {
                let mean = f64::from(s[c]) / n;
                let spread = (f64::from(q[c]) / n - mean * mean).max(0.0);
                (spread / (n - 1.0).max(1.0)) as f32
            })
        };
        let variances = sums.iter().zip(&squares).map(variance).collect();
        Ok(Some(Moments {
            mean: sums.into_iter().map(mean).collect(),
            variance: variances,
        }))
    }

    /// One picture without read-back, colour and opacity alone: but for Monte Carlo without depths and sample counts.
    ///
    /// # Errors
    /// As [`Session::frame`].
    pub fn timed_frame(&mut self) -> Result<FrameTime> {
        self.draw(self.settings().traces_paths())
    }

    /// One picture. `layers`: depths and sample counts as well.
    fn draw(&mut self, layers: bool) -> Result<FrameTime> {
        self.samples = None;
        self.layered = false;
        let time = self.timed(Work::PictureOnly, layers)?;
        self.layered = layers;
        self.times.frame_ms = time.wall_ms;
        Ok(time)
    }

    /// Depths and sample counts of the last picture; draws it again where it had none, which counts in no time.
    fn read_layers(&mut self) -> Result<Vec<[f32; 4]>> {
        if !self.layered {
            let times = std::mem::take(&mut self.times);
            let drawn = self.submit_drawing(Work::PictureOnly, true);
            let uploaded = self.times.uploaded_bytes;
            self.times = times;
            self.times.uploaded_bytes += uploaded;
            drawn?;
            self.layered = true;
        }
        Ok(texels(&self.read_back(&self.aux, PICTURE_TEXEL_BYTES)?))
    }

    /// The light volume on the full grid; traces what is missing first.
    ///
    /// # Errors
    /// As [`Session::frame`].
    pub fn light_volume(&mut self) -> Result<LightVolume> {
        while self.refine_light()? {}
        let atlas = self.read_back(&self.renderer.loaded().images().light, 8)?;
        light_volume::unpack(self.renderer.loaded(), bytemuck::cast_slice(&atlas))
    }

    /// Statistics of the last picture and of the light so far. Of a timed picture samples are counted now, by drawing it again
    /// as settings and camera are now.
    ///
    /// # Errors
    /// As [`Session::frame`].
    pub fn stats(&mut self) -> Result<Stats> {
        let taken = match self.samples {
            Some(taken) => taken,
            None if self.times.frame_ms > 0.0 => {
                let layers = self.read_layers()?;
                layers.iter().map(|a| a[1] as u64).sum()
            }
            None => 0,
        };
        self.samples = Some(taken);
        let allocated = self.renderer.context().allocated_bytes();
        Ok(stats::of(
            &self.device_info(),
            self.renderer.loaded(),
            &self.times,
            self.size(),
            taken,
            allocated,
        ))
    }

    /// See [`Session::submit_drawing`].
    fn timed(&mut self, work: Work, layers: bool) -> Result<FrameTime> {
        let watch = Stopwatch::start();
        self.submit_drawing(work, layers)?;
        Ok(watch.elapsed())
    }

    fn device_info(&self) -> DeviceInfo {
        lock(&self.device).info.clone()
    }

    fn frame_of<'a>(
        &self,
        target: &'a Image,
        aux: Option<&'a Image>,
        through: Option<&'a Image>,
    ) -> Frame<'a> {
        let size_px = self.size();
        Frame {
            rays: RayBasis::from_view(&self.view, size_px),
            target: FrameTarget {
                own: Some(target),
                view: target.view(),
                format: PICTURE_FORMAT,
                size_px,
                encode_srgb: false,
                blend: false,
                background: [0.0; 4],
            },
            depth: None,
            aux,
            through,
            exposure: 1.0,
            number: self.renderer.loaded().light_progress().0,
            upload_budget: UPLOAD_BYTES,
        }
    }

    /// Records, submits and waits.
    fn submit(&mut self, work: Work) -> Result<FrameReport> {
        self.submit_drawing(work, false)
    }

    /// The same. `layers`: with depths and sample counts, where the work draws a picture.
    fn submit_drawing(&mut self, work: Work, layers: bool) -> Result<FrameReport> {
        let frame = self.frame_of(
            &self.target,
            layers.then_some(&self.aux),
            self.through.as_ref(),
        );
        let mut device = lock(&self.device);
        let mut index = 0;
        let submitted = device.submit(|recording| {
            index = recording.index();
            record_owned(&mut self.renderer, recording, &frame, work)
        });
        drop(device);
        if submitted.is_err() {
            // Recorded or not, it has not run.
            self.renderer.restart();
        }
        let report = submitted.map_err(|e| match e {
            Error::DeviceLost { .. } => Error::DeviceLost {
                last_pass: self.renderer.last_pass().map(str::to_owned),
            },
            e => e,
        })?;
        self.times.add(work, self.renderer.pass_times_of(index));
        self.times.uploaded_bytes += report.uploaded_bytes;
        Ok(report)
    }

    /// All texels of an image of ours, tightly packed.
    fn read_back(&self, image: &Image, texel_bytes: u64) -> Result<Vec<u8>> {
        let mut device = lock(&self.device);
        read_back(&mut device, image, texel_bytes)
    }
}
