//! What a volume holds.

use serde::Serialize;

use super::Volume;

/// What a volume holds.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    /// Voxels.
    pub size: [u32; 3],
}

impl Summary {
    /// Of a volume.
    pub fn of(volume: &Volume) -> Self {
        Self {
            size: volume.size(),
        }
    }
}
