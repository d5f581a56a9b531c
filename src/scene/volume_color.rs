//! Colours that voxels have themselves.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{ColorManagement, Curve, Lighting, March, OpticalModel, RayProjection, Scene};
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
    /// [`Error::Invalid`] when it asks for colours that the volume has not, or that its march does not draw.
    pub fn data_color(&self, volume: &Volume, curve: &Curve) -> Result<Option<ColorManagement>> {
        let drawn = check_data_color(&self.march, &self.lighting, curve.glows());
        let management = Some(self.image.color_management);
        match self.volume.color {
            Some(VolumeColor::TransferFunction) => Ok(None),
            Some(VolumeColor::Data) => {
                VolumeColor::require_colors(volume)?;
                drawn.map(|()| management)
            }
            None => Ok(management.filter(|_| drawn.is_ok() && volume.colors().is_some())),
        }
    }
}

/// Colours of the data are drawn sample by sample, where nothing but the transfer function has a say in them.
///
/// `glows`: it gives light without opacity.
///
/// # Errors
/// [`Error::Invalid`] for projections of values and for surfaces, and for pictures that are marched as a medium.
pub(crate) fn check_data_color(march: &March, lighting: &Lighting, glows: bool) -> Result<()> {
    let refuse = |why: &str| {
        let message = format!("\"data\" {why}; give \"transfer_function\"");
        Err(Error::invalid("volume.color", message))
    };
    if march.projection != RayProjection::Composite {
        return refuse("needs the projection \"composite\", others draw values and surfaces");
    }
    if lighting.model != OpticalModel::EmissionAbsorption
        || lighting.extinction != [1.0; 3]
        || glows
    {
        return refuse(
            "needs the model \"emission_absorption\", an extinction of [1, 1, 1] and a transfer function without \"source\"",
        );
    }
    Ok(())
}
