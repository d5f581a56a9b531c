//! Levels of detail and memory.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How much of the volume is kept on the device.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Storage {
    /// Voxels of the volume per voxel kept, >= 1; 1 keeps everything at the finest level. Default 1.
    pub data_reduction: f64,
    /// Device memory for voxels and light, MiB, > 0; binds where it is tighter than `data_reduction`. Gradients of shaded pictures
    /// are stored in what it leaves, or estimated at every sample where they do not fit. Default 1024.
    pub memory_budget_mib: f64,
    /// On drivers that filter textures on the processor, keep the corners of voxel cells side by side in a second copy of the
    /// voxels, 1.8 bytes for one of 8 bits and 5.3 for one of 16, where the budget has room after the gradients: samples take about
    /// two thirds of the time. Default true.
    pub packed_cells: bool,
}

impl Storage {
    /// The memory budget.
    pub(crate) fn budget_bytes(&self) -> u64 {
        (self.memory_budget_mib * 1024.0 * 1024.0) as u64
    }
}

impl Default for Storage {
    fn default() -> Self {
        Self {
            data_reduction: 1.0,
            memory_budget_mib: 1024.0,
            packed_cells: true,
        }
    }
}
