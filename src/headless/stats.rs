//! Figures of a session, as `--stats` writes them.

use serde::Serialize;

use crate::gpu::{DeviceInfo, PassTime};
use crate::renderer::{Loaded, Work, pass_name};

/// All of them.
#[derive(Clone, Debug, Serialize)]
pub struct Stats {
    /// The device that rendered.
    pub device: DeviceStats,
    /// The picture.
    pub image: ImageStats,
    /// The last picture, from the start of recording to completion on the device, ms.
    pub frame_ms: f64,
    /// GPU times of the passes of the last direction of light, of the last picture and of the last bare march or bare light; empty
    /// without timestamps.
    pub passes: Vec<PassStats>,
    /// Local ambient occlusion; `null` when it is off.
    pub lao: Option<LightStats>,
    /// Scattered light; `null` for optical models without.
    pub scattering: Option<ScatteringStats>,
    /// Samples of the field in the last picture.
    pub samples: SampleStats,
    /// Blocks of the volume.
    pub blocks: BlockStats,
    /// Voxels of the volume per voxel kept, as achieved.
    pub data_reduction: f64,
    /// Memory.
    pub memory: MemoryStats,
}

/// The picture.
#[derive(Clone, Debug, Serialize)]
pub struct ImageStats {
    /// Width and height, pixels.
    pub size: [u32; 2],
}

/// The device that rendered.
#[derive(Clone, Debug, Serialize)]
pub struct DeviceStats {
    /// Name.
    pub name: String,
    /// Driver and its version.
    pub driver: String,
    /// "discrete", "integrated", "virtual", "cpu" or "other".
    #[serde(rename = "type")]
    pub device_type: String,
}

/// One pass.
#[derive(Clone, Debug, Serialize)]
pub struct PassStats {
    /// Name.
    pub name: &'static str,
    /// Time on the device, ms.
    pub gpu_ms: f64,
}

/// Scattered light.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct ScatteringStats {
    /// Iterations of the solver.
    pub iterations: u32,
    /// Largest change of the last iteration that is known, as a share of the largest fluence; `null` before there is one.
    pub residual: Option<f64>,
    /// Time on the device of all iterations, and of what they start from, ms.
    pub solver_ms: f64,
    /// Paths of every pixel.
    pub paths: u32,
}

/// Local ambient occlusion.
#[derive(Clone, Debug, Serialize)]
pub struct LightStats {
    /// Directions traced so far.
    pub rays: u32,
    /// Mean time of a direction on the device (wall time where there are no timestamps), ms.
    pub ms_per_ray: f64,
    /// Samples of the light volume that a direction is traced for.
    pub voxels: u64,
    /// Of `ambient_occlusion.sampling` `distance`: by how many parts of a ray each distance between samples is longer than the
    /// one before. `None`: samples in every part.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub growth: Option<f64>,
}

/// Samples of the field.
#[derive(Clone, Debug, Serialize)]
pub struct SampleStats {
    /// In the whole picture.
    pub taken: u64,
    /// Per pixel.
    pub per_pixel_mean: f64,
}

/// Blocks of the volume.
#[derive(Clone, Debug, Serialize)]
pub struct BlockStats {
    /// All.
    pub total: usize,
    /// On the device.
    pub resident: usize,
    /// On the device by level: 1^3, 2^3, 4^3, 8^3, 16^3 voxels.
    pub by_level: [usize; 5],
    /// Visible blocks that the memory budget had no room for.
    pub dropped: usize,
}

/// Memory.
#[derive(Clone, Debug, Default, Serialize)]
pub struct MemoryStats {
    /// On the device, held by the renderer now.
    pub device_bytes: u64,
    /// Of those: the second copy of the voxels with packed corners (`storage.packed_cells`); 0 without.
    pub packed_cells_bytes: u64,
    /// Of those: stored gradients (`lighting.stored_gradients`); 0 without.
    pub gradients_bytes: u64,
    /// Of those: what beams leave for the march (`march.beams`), with the size of the picture, and the bits of cells that they look up;
    /// 0 without.
    pub beams_bytes: u64,
    /// Bytes of bricks that were staged and uploaded since the volume was loaded.
    pub uploaded_bytes: u64,
    /// Peak on the host; 0 where it is not counted (the program counts it).
    pub host_peak_bytes: u64,
}

/// Times collected as frames complete.
#[derive(Debug, Default)]
pub(super) struct Times {
    pub(super) frame_ms: f64,
    picture: Vec<PassTime>,
    light: Vec<PassTime>,
    bare: Vec<PassTime>,
    light_ms: f64,
    light_directions: u32,
    pub(super) uploaded_bytes: u64,
}

impl Times {
    /// The light starts again: what its directions took before says nothing of those to come.
    pub(super) fn restart_light(&mut self) {
        self.light.clear();
        self.light_ms = 0.0;
        self.light_directions = 0;
    }

    /// Of the last direction of light, the last picture and the last bare march.
    pub(super) fn passes(&self) -> Vec<PassStats> {
        let passes = self.light.iter().chain(&self.picture).chain(&self.bare);
        let stats = passes.map(|t| PassStats {
            name: t.name,
            gpu_ms: t.ms,
        });
        stats.collect()
    }

    /// Takes the pass times of a completed submission.
    pub(super) fn add(&mut self, work: Work, times: Vec<PassTime>) {
        match work {
            Work::PictureOnly | Work::Everything => self.picture = times,
            Work::LightOnly => {
                let light = [
                    pass_name::LIGHT,
                    pass_name::LIGHT_SEAM,
                    pass_name::SHADOW,
                    pass_name::SCATTER,
                ];
                self.light_ms += times
                    .iter()
                    .filter(|t| light.contains(&t.name))
                    .map(|t| t.ms)
                    .sum::<f64>();
                self.light_directions += 1;
                self.light = times;
            }
            Work::Bare | Work::BareLight => self.bare = times,
            Work::UploadsOnly | Work::CountLight => {}
        }
    }
}

/// Puts the figures together.
pub(super) fn of(
    device: &DeviceInfo,
    loaded: &Loaded,
    times: &Times,
    image: [u32; 2],
    samples: u64,
    device_bytes: u64,
) -> Stats {
    let selection = &loaded.residency().selection;
    let (traced, rays) = loaded.light_progress();
    let (packed_cells_bytes, gradients_bytes) = loaded.derived_bytes();
    Stats {
        device: DeviceStats {
            name: device.name.clone(),
            driver: device.driver.clone(),
            device_type: device.device_type.clone(),
        },
        image: ImageStats { size: image },
        frame_ms: times.frame_ms,
        passes: times.passes(),
        scattering: loaded
            .scattering_progress()
            .map(|(iterations, residual, paths)| ScatteringStats {
                iterations,
                residual,
                solver_ms: times.light_ms,
                paths,
            }),
        lao: (rays > 0 && loaded.is_occluded()).then(|| LightStats {
            rays: traced,
            ms_per_ray: times.light_ms / f64::from(times.light_directions.max(1)),
            voxels: loaded.visibility().light.samples(),
            growth: loaded.light_growth(),
        }),
        samples: SampleStats {
            taken: samples,
            per_pixel_mean: samples as f64 / (f64::from(image[0]) * f64::from(image[1])),
        },
        blocks: BlockStats {
            total: loaded.store().grid().len(),
            resident: selection.levels.resident(),
            by_level: selection.by_level,
            dropped: selection.dropped,
        },
        data_reduction: selection.data_reduction,
        memory: MemoryStats {
            device_bytes,
            packed_cells_bytes,
            gradients_bytes,
            beams_bytes: loaded.beams_bytes(),
            uploaded_bytes: times.uploaded_bytes,
            host_peak_bytes: 0,
        },
    }
}
