//! How a volume is drawn, apart from the camera.

use std::sync::Arc;

use crate::error::{Error, Result};
use crate::scene::{
    AmbientOcclusion, Classification, ColorManagement, Curve, EnvironmentMap, Gradient,
    Interpolation, Labels, Lighting, March, OpticalModel, RayProjection, Reflectance,
    ScatteringMethod, Scene, Shading, Storage, Surface, VolumeColor, check_data_color,
    check_together,
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
    /// The map of [`Lighting::environment`], where that names one.
    pub environment: Option<Arc<EnvironmentMap>>,
    /// Brightness of the volume's light in targets of an engine, stops; pictures of our own are read back as radiance.
    pub exposure: f64,
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
            data_color: scene.data_color(volume, &curve)?,
            curve,
            labels: Labels::of_scene(scene, volume)?,
            march: scene.march.clone(),
            lighting: scene.lighting.clone(),
            ambient_occlusion: scene.ambient_occlusion.clone(),
            environment: environment(&scene.lighting)?,
            exposure: scene.image.exposure,
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
            check_data_color(&self.march, &self.lighting, self.curve.glows())?;
        }
        if let Some(ao) = &self.ambient_occlusion {
            ao.validate()?;
        }
        self.check_transport()
    }

    /// True when pictures take the march of a medium: an optical model of its own, light without opacity, or an extinction that
    /// differs by channel.
    pub(super) fn transports(&self) -> bool {
        self.lighting.model != OpticalModel::EmissionAbsorption
            || self.curve.glows()
            || self.lighting.extinction != [1.0; 3]
    }

    /// True when pictures are traced by Monte Carlo.
    pub(crate) fn traces_paths(&self) -> bool {
        self.lighting.model == OpticalModel::MultipleScattering
            && self.lighting.scattering.method == ScatteringMethod::MonteCarlo
    }

    /// What the march of a medium cannot do. Models other than the default one were checked with the rest of the scene.
    fn check_transport(&self) -> Result<()> {
        let path = self
            .lighting
            .environment
            .as_ref()
            .and_then(|e| e.path.as_ref());
        if path.is_some() != self.environment.is_some() {
            return Err(Error::invalid(
                "lighting.environment.path",
                "settings hold the map itself; give it with the path, or neither",
            ));
        }
        if !self.transports() {
            return Ok(());
        }
        let why = "\"source\" of a control point and \"extinction\" of the lighting";
        let refuse = |at: &str, give: &str| {
            Err(Error::invalid(
                at,
                format!("does not go with {why}; {give}"),
            ))
        };
        if self.march.projection != RayProjection::Composite {
            return refuse("march.projection", "give \"composite\"");
        }
        if self
            .march
            .classification
            .is_some_and(|c| c != Classification::Post)
        {
            return refuse("march.classification", "give \"post\" or leave it out");
        }
        if self.lighting.shading != Shading::None {
            return refuse("lighting.shading", "give \"none\"");
        }
        if self.ambient_occlusion.is_some() {
            return refuse("ambient_occlusion", "give null");
        }
        Ok(())
    }

    /// True when segments are classified by the values at their ends.
    pub(super) fn is_preintegrated(&self) -> bool {
        self.composites() && self.march.classification() == Classification::Preintegrated
    }

    /// True when samples of a ray are composited by emission and absorption, or their opacities by absorption alone.
    pub(super) fn composites(&self) -> bool {
        let projection = self.march.projection;
        matches!(projection, RayProjection::Composite | RayProjection::Xray) && !self.transports()
    }

    /// The estimator of the gradients that are to be stored, if samples need some and all blocks are one field.
    pub(super) fn stored_gradient(&self) -> Option<Gradient> {
        let lighting = &self.lighting;
        let shaded = match self.march.projection {
            RayProjection::Composite | RayProjection::Isosurface if !self.transports() => {
                lighting.shading == Shading::Diffuse
            }
            _ => self.transports() && lighting.reflectance != Reflectance::Particles,
        };
        let stored = lighting.stored_gradients && self.march.inter_block_interpolation;
        (shaded && stored).then_some(lighting.gradient)
    }

    /// True when something reads the field between voxels.
    pub(super) fn interpolates(&self) -> bool {
        let march = &self.march;
        let picture = march.interpolation != Interpolation::Nearest
            && march.classification() != Classification::Pre;
        picture || self.ambient_occlusion.is_some()
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

    /// True when rays of light gather the same under `other`, given the same data.
    pub(super) fn same_light_rays(&self, other: &Self) -> bool {
        // The bias is added when light is used; everything else goes into the volume.
        let traced = |ao: &Option<AmbientOcclusion>| {
            ao.clone().map(|ao| AmbientOcclusion { bias: 0.0, ..ao })
        };
        traced(&self.ambient_occlusion) == traced(&other.ambient_occlusion)
            && self.curve == other.curve
    }

    /// True when the light volume of `self` is still right under `other`, given equal levels.
    pub(super) fn same_light(&self, other: &Self) -> bool {
        let same_labels = match (self.hiding(), other.hiding()) {
            (Some(one), Some(other)) => one.hide_the_same(other),
            (one, other) => one.is_none() && other.is_none(),
        };
        same_labels
            && self.same_light_rays(other)
            && self.march.inter_block_interpolation == other.march.inter_block_interpolation
    }
}

fn environment(lighting: &Lighting) -> Result<Option<Arc<EnvironmentMap>>> {
    let path = lighting.environment.as_ref().and_then(|e| e.path.as_ref());
    path.map(|path| EnvironmentMap::read(path).map(Arc::new))
        .transpose()
}
