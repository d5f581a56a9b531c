//! What `bench/peers/run.py` found.

use std::collections::BTreeMap;
use std::path::Path;

use serde::Deserialize;
use umbravox::{Error, Result};

use crate::figures::Spread;

/// Its JSON; what else that holds is for readers.
#[derive(Debug, Deserialize)]
pub(crate) struct Peers {
    pub(crate) cores: u32,
    pub(crate) vtk: String,
    pub(crate) rows: Vec<Row>,
}

/// All renderers on one scene.
#[derive(Debug, Deserialize)]
pub(crate) struct Row {
    pub(crate) scene: String,
    pub(crate) image: [u32; 2],
    pub(crate) step: f64,
    pub(crate) shaded: bool,
    /// Of ours with each of theirs, and of theirs with each other; `None`: equal.
    pub(crate) psnr_db: BTreeMap<String, Option<f64>>,
    times: BTreeMap<String, Times>,
}

#[derive(Debug, Deserialize)]
struct Times {
    wall_ms: Spread,
    cpu_ms: Spread,
}

pub(crate) const OURS: &str = "umbravox";
pub(crate) const GPU: &str = "vtk_gpu";
pub(crate) const FIXED_POINT: &str = "vtk_fixed_point";

impl Row {
    /// Median processor time of a frame over the cores, ms: what an idle machine would take.
    pub(crate) fn cpu_ms(&self, renderer: &str, cores: u32) -> f64 {
        let times = self.times.get(renderer);
        times.map_or(f64::NAN, |t| t.cpu_ms.median / f64::from(cores.max(1)))
    }

    /// Median wall time of a frame, ms.
    pub(crate) fn wall_ms(&self, renderer: &str) -> f64 {
        let times = self.times.get(renderer);
        times.map_or(f64::NAN, |t| t.wall_ms.median)
    }

    /// How many times our processor time another renderer takes.
    pub(crate) fn times_ours(&self, renderer: &str) -> f64 {
        self.cpu_ms(renderer, 1) / self.cpu_ms(OURS, 1)
    }
}

/// Reads a report; `None` where there is no such file.
///
/// # Errors
/// [`Error::Invalid`] for files of another form.
pub(crate) fn read(path: &Path) -> Result<Option<Peers>> {
    let Ok(text) = std::fs::read(path) else {
        return Ok(None);
    };
    let peers = serde_json::from_slice(&text);
    peers
        .map(Some)
        .map_err(|e| Error::invalid(path.display().to_string(), e.to_string()))
}
