//! Rendering on an own device.

use std::sync::Arc;

use serde::Serialize;

use crate::error::{Error, Result};
use crate::picture::Picture;
use crate::scene::{Scene, View};
use crate::volume::Volume;

/// How the device is opened.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Name (part of it) or index.
    pub device: Option<String>,
    /// Validation layers.
    pub validation: bool,
    /// Keep compiled pipelines on disk.
    pub pipeline_cache: bool,
    /// Tile edge, pixels.
    pub tile: Option<u32>,
}

/// A Vulkan device.
#[derive(Clone, Debug, Serialize)]
pub struct DeviceInfo {
    /// What `--device` takes.
    pub index: usize,
    /// Name.
    pub name: String,
    /// Driver and its version.
    pub driver: String,
    /// Kind.
    pub device_type: String,
    /// Vulkan version.
    pub api_version: String,
    /// Whether it can render.
    pub usable: bool,
    /// Why not.
    pub reason: Option<String>,
}

/// Memory use.
#[derive(Clone, Debug, Default, Serialize)]
pub struct MemoryStats {
    /// Device.
    pub device_bytes: u64,
    /// Host.
    pub host_peak_bytes: u64,
}

/// Statistics.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Stats {
    /// Memory.
    pub memory: MemoryStats,
}

/// Light on the full grid.
#[derive(Clone, Debug)]
pub struct LightVolume {
    /// Voxels.
    pub size: [u32; 3],
    /// RGB light, A 1 where computed.
    pub rgba: Vec<[f32; 4]>,
}

/// Every device.
pub fn devices() -> Result<Vec<DeviceInfo>> {
    Err(missing())
}

fn missing() -> Error {
    Error::NoDevice("no device".into())
}

/// An open device.
pub struct Headless;

impl Headless {
    /// Opens a device.
    pub fn new(_options: &Options) -> Result<Self> {
        Err(missing())
    }

    /// Puts a volume on the device.
    pub fn load(&self, _volume: Arc<Volume>, _scene: &Scene) -> Result<Session> {
        Err(missing())
    }
}

/// A loaded scene.
pub struct Session;

impl Session {
    /// Directions.
    pub fn light_rays(&self) -> u32 {
        0
    }
    /// One more direction.
    pub fn refine_light(&mut self) -> Result<bool> {
        Err(missing())
    }
    /// One picture.
    pub fn frame(&mut self) -> Result<Picture> {
        Err(missing())
    }
    /// The complete light.
    pub fn light_volume(&mut self) -> Result<LightVolume> {
        Err(missing())
    }
    /// Moves the camera.
    pub fn set_view(&mut self, _view: View) {}
    /// Milliseconds of one frame.
    pub fn timed_frame(&mut self) -> Result<f64> {
        Err(missing())
    }
    /// Statistics.
    pub fn stats(&self) -> Stats {
        Stats::default()
    }
}
