//! What a run finds, as JSON holds it. Times are milliseconds.

use serde::{Deserialize, Serialize};
use umbravox::scene::AmbientOcclusion;

/// Everything of a run.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct Run {
    pub(crate) device: String,
    pub(crate) driver: String,
    pub(crate) cores: usize,
    /// One-minute load average before and after; what else runs makes times uncertain.
    pub(crate) load: [Option<f64>; 2],
    /// Measured frames of a picture, after one that is not counted.
    pub(crate) repeats: u32,
    pub(crate) pictures: Vec<Picture>,
    pub(crate) lights: Vec<Light>,
    pub(crate) effects: Effects,
    /// Fields that were asked for and are not at hand.
    pub(crate) absent: Vec<String>,
}

/// What is drawn.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Case {
    pub(crate) field: String,
    /// Edge of the volume, voxels, where that can be chosen.
    pub(crate) size: u32,
    /// Edge of the picture, pixels.
    pub(crate) image: u32,
    /// Voxels.
    pub(crate) step: f64,
    pub(crate) shaded: bool,
    /// Classified along each segment instead of at its middle.
    pub(crate) preintegrated: bool,
    /// Directions of local ambient occlusion; 0: none.
    pub(crate) rays: u32,
}

/// Figures of a picture.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct Picture {
    pub(crate) case: Case,
    /// Voxels on x, y, z.
    pub(crate) size: [u32; 3],
    /// Share of the voxels that the transfer function shows.
    pub(crate) visible: f64,
    /// From the start of recording to completion.
    pub(crate) frame_ms: Spread,
    /// Processor time of the same.
    pub(crate) cpu_ms: Option<Spread>,
    /// The march alone, on the device: by its timestamps, or, where the processor is the device, processor time over the cores.
    pub(crate) march_ms: Spread,
    /// The bare march of the same rays, likewise.
    pub(crate) bare_ms: Spread,
    pub(crate) samples: u64,
    pub(crate) bare_samples: u64,
    pub(crate) voxel_bytes: u64,
    /// Voxels, index, tables and, where there is one, the light volume.
    pub(crate) resident_bytes: u64,
    /// Packed corners of voxel cells, which only drivers that filter on the processor have.
    #[serde(default)]
    pub(crate) packed_bytes: u64,
    /// Bricks staged and uploaded.
    pub(crate) uploaded_bytes: u64,
}

impl Picture {
    /// Samples per second.
    pub(crate) fn rate(&self) -> f64 {
        self.samples as f64 / (self.march_ms.median * 1e-3)
    }

    /// Samples per second of the bare march.
    pub(crate) fn limit(&self) -> f64 {
        self.bare_samples as f64 / (self.bare_ms.median * 1e-3)
    }
}

/// Figures of local ambient occlusion.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct Light {
    pub(crate) field: String,
    pub(crate) size: [u32; 3],
    pub(crate) rays: u32,
    /// Of one direction, as [`Picture::march_ms`].
    pub(crate) trace_ms: Spread,
    /// Of one direction of bare light.
    pub(crate) bare_ms: Spread,
    /// Of the light volume, that light is computed for, in whole groups of 4^3.
    pub(crate) voxels: u64,
    /// Of the field, in all directions.
    pub(crate) samples: u64,
    /// The bare light takes them, in one direction.
    pub(crate) bare_samples: u64,
    /// What equation 2 asks for: every voxel, every direction, every sample of a ray.
    pub(crate) brute_force_samples: u64,
    /// The same light by samples that lie farther apart the farther out they are.
    #[serde(default)]
    pub(crate) growing: Option<Growing>,
}

/// Figures of `ambient_occlusion.sampling` `distance`, beside those of uniform sampling, direction by direction in turn.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct Growing {
    pub(crate) rays: u32,
    /// Chosen by the renderer; none: uniform.
    pub(crate) growth: Option<f64>,
    /// Of one direction, uniform.
    pub(crate) uniform_ms: Spread,
    /// Of one direction, growing.
    pub(crate) trace_ms: Spread,
    /// Of the field, in all directions.
    pub(crate) samples: u64,
    /// What equation 2 asks for.
    pub(crate) brute_force_samples: u64,
    /// Of the light, of 1, beside uniform sampling.
    pub(crate) rms_error: f64,
    pub(crate) largest_error: f64,
}

impl Growing {
    pub(crate) fn fewer(&self) -> f64 {
        self.brute_force_samples as f64 / self.samples as f64
    }
}

impl Light {
    pub(crate) fn rate(&self) -> f64 {
        self.samples as f64 / f64::from(self.rays) / (self.trace_ms.median * 1e-3)
    }

    pub(crate) fn limit(&self) -> f64 {
        self.bare_samples as f64 / (self.bare_ms.median * 1e-3)
    }

    /// How many times fewer samples uniform sampling takes than equation 2 asks for.
    pub(crate) fn fewer(&self) -> f64 {
        self.brute_force_samples as f64 / self.samples as f64
    }
}

/// What one change does, the two sides measured in turn.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(crate) struct Effects {
    /// Fog with skipping and without.
    pub(crate) skipping: Option<[Spread; 2]>,
    /// A plain frame, and from a new transfer function to the end of the first frame that shows it.
    pub(crate) edit: Option<[Spread; 2]>,
    /// Light by data reduction.
    pub(crate) reductions: Vec<Reduction>,
    pub(crate) process: Option<WholeProcess>,
}

/// A point of the paper's figure 5.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct Reduction {
    /// Edge of the volume, voxels; 0 in runs before that was written, whose times count joining otherwise.
    #[serde(default)]
    pub(crate) size: u32,
    pub(crate) asked: f64,
    pub(crate) reached: f64,
    /// Of a direction.
    pub(crate) ms_per_ray: f64,
    /// Of joining bricks, once for all directions.
    #[serde(default)]
    pub(crate) join_ms: f64,
    pub(crate) voxels: u64,
}

impl Reduction {
    /// Of a direction with its share of joining, where there are as many as unless something else is asked for.
    pub(crate) fn ms(&self) -> f64 {
        self.ms_per_ray + self.join_ms / f64::from(AmbientOcclusion::default().rays)
    }
}

/// From a compressed file to a picture.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct WholeProcess {
    /// `umbravox render`, from start to exit.
    pub(crate) render_ms: Spread,
    /// Its parts that nothing can save: decompression alone, the frame, the directions of light.
    pub(crate) parts_ms: Spread,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Spread {
    pub(crate) min: f64,
    pub(crate) median: f64,
    pub(crate) max: f64,
}

impl Spread {
    /// Of at least one value.
    pub(crate) fn of(mut values: Vec<f64>) -> Self {
        values.sort_by(f64::total_cmp);
        let at = |place: usize| values.get(place).copied().unwrap_or(f64::NAN);
        let last = values.len().saturating_sub(1);
        Self {
            min: at(0),
            median: 0.5 * (at(last / 2) + at(values.len() / 2)),
            max: at(last),
        }
    }
}
