//! How a volume is drawn, apart from the camera.

use crate::error::Result;
use crate::scene::{
    AmbientOcclusion, Classification, ColorManagement, Curve, Labels, Lighting, March,
    RayProjection, Scene, Storage, Surface, VolumeColor, check_data_color, check_together,
};
use crate::volume::Volume;

/// What a [`super::Renderer`] draws by. Values are those of a checked scene ([`Scene::validate`]).
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Transfer function, colours decoded.
    pub curve: Curve,
    /// The colours of the volume's voxels, decoded so, in place of the transfer function's; `None`: the latter.
    pub data_color: Option<ColorManagement>,
    /// Ray sampling.
    pub march: March,
    /// What [`March::surfaces`] makes of the march's isosurfaces.
    pub surfaces: Vec<Surface>,
    /// Shading.
    pub lighting: Lighting,
    /// A segmentation of the same place, and what it hides or colours; `None`: none.
    pub labels: Option<Labels>,
    /// Local ambient occlusion; `None`: off.
    pub ambient_occlusion: Option<AmbientOcclusion>,
    /// Levels of detail and memory.
    pub storage: Storage,
    /// Opacity at which a ray's depth is taken, (0,1].
    pub depth_threshold: f64,
}

impl Settings {
    /// What a scene says, for the volume it draws.
    ///
    /// # Errors
    /// [`crate::error::Error::Invalid`] when the scene is not valid, or the volume lacks the labels it asks for.
    pub fn of_scene(scene: &Scene, volume: &Volume) -> Result<Self> {
        scene.validate()?;
        let colors = scene.image.color_management;
        let curve = scene.transfer_function.curve(volume, colors)?;
        Ok(Self {
            surfaces: scene.march.surfaces(&curve, colors),
            curve,
            data_color: scene.data_color(volume)?,
            labels: Labels::of_scene(scene, volume)?,
            march: scene.march.clone(),
            lighting: scene.lighting.clone(),
            ambient_occlusion: scene.ambient_occlusion.clone(),
            storage: scene.storage.clone(),
            depth_threshold: scene.image.depth_threshold,
        })
    }

    /// Checks every range, as for a scene file.
    ///
    /// # Errors
    /// [`crate::error::Error::Invalid`] names the setting by its scene key.
    pub fn validate(&self) -> Result<()> {
        self.curve.validate()?;
        self.march.validate()?;
        self.lighting.validate()?;
        self.storage.validate()?;
        check_together(&self.march, &self.lighting, self.ambient_occlusion.as_ref())?;
        if self.data_color.is_some() {
            check_data_color(&self.march)?;
        }
        match &self.ambient_occlusion {
            Some(ao) => ao.validate(),
            None => Ok(()),
        }
    }

    /// True when segments are classified by the values at their ends.
    pub(super) fn is_preintegrated(&self) -> bool {
        matches!(
            self.march.projection,
            RayProjection::Composite | RayProjection::Xray
        ) && self.march.classification() == Classification::Preintegrated
    }

    /// Labels must lie where the volume does, and colours that are to be drawn must be there.
    pub(super) fn check_volume(&self, volume: &Volume) -> Result<()> {
        if self.data_color.is_some() {
            VolumeColor::require_colors(volume)?;
        }
        match &self.labels {
            Some(labels) => labels.map().check_overlap(volume),
            None => Ok(()),
        }
    }

    /// The labels, where they hide something.
    pub(super) fn hiding(&self) -> Option<&Labels> {
        self.labels.as_ref().filter(|labels| labels.hide_some())
    }

    /// True when the light volume of `self` is still right under `other`, given equal levels.
    pub(super) fn same_light(&self, other: &Self) -> bool {
        // The bias is added when light is used; everything else goes into the volume.
        let traced = |ao: &Option<AmbientOcclusion>| {
            ao.clone().map(|ao| AmbientOcclusion { bias: 0.0, ..ao })
        };
        let same_labels = match (self.hiding(), other.hiding()) {
            (Some(one), Some(other)) => one.hide_the_same(other),
            (one, other) => one.is_none() && other.is_none(),
        };
        same_labels
            && traced(&self.ambient_occlusion) == traced(&other.ambient_occlusion)
            && self.curve == other.curve
            && self.march.inter_block_interpolation == other.march.inter_block_interpolation
    }
}
