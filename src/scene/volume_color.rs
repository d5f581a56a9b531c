//! Colours that voxels have themselves.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{ColorManagement, Scene, check_data_color};
use crate::error::{Error, Result};
use crate::volume::Volume;

/// Where colours come from. Opacity is the transfer function's either way.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum VolumeColor {
    /// The voxels' own. Their alpha, where it tells voxels apart, else their luminance is what the transfer function takes for
    /// the value.
    Data,
    /// The transfer function's; the luminance is the value.
    TransferFunction,
}

impl VolumeColor {
    /// # Errors
    /// [`Error::Invalid`] when the volume's voxels are no colours.
    pub(crate) fn require_colors(volume: &Volume) -> Result<()> {
        match volume.colors() {
            Some(_) => Ok(()),
            None => Err(Error::invalid(
                "volume.color",
                "\"data\" needs voxels that are colours of 8 bits; there are none, give \"transfer_function\"",
            )),
        }
    }
}

impl Scene {
    /// How colours of the volume's own are decoded where this scene draws them: where there are some, unless it says otherwise
    /// or has no use for them.
    ///
    /// # Errors
    /// [`Error::Invalid`] when it asks for colours that the volume has not.
    pub fn data_color(&self, volume: &Volume) -> Result<Option<ColorManagement>> {
        let management = Some(self.image.color_management);
        match self.volume.color {
            Some(VolumeColor::TransferFunction) => Ok(None),
            Some(VolumeColor::Data) => VolumeColor::require_colors(volume).map(|()| management),
            None => {
                let useful = check_data_color(&self.march).is_ok();
                Ok(management.filter(|_| useful && volume.colors().is_some()))
            }
        }
    }
}
