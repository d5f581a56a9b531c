//! The scene for a volume that comes without one.

use std::path::Path;
use std::sync::Arc;

use serde_json::{Value, json};

use super::framing::Visible;
use super::{Guess, Modality, Override, Scene};
use crate::error::Result;
use crate::volume::Volume;

/// Ambient occlusion looks as far as this share of what is visible, within these bounds (voxels).
const RADIUS_SHARE: f64 = 0.09;
const RADIUS: [f64; 2] = [6.0, 40.0];
/// Samples on one of its rays.
const SAMPLES_PER_RAY: f64 = 8.0;
/// Most and fewest directions.
const RAYS: [f64; 2] = [6.0, 24.0];
/// Samples of light that two cores take in some 15 seconds.
const LIGHT_SAMPLES: f64 = 1e8;
/// Visible voxels above which levels of detail are chosen.
const MAX_VISIBLE: f64 = 3.5e6;
/// Label maps above this are thinned: coarser levels would mix labels.
const MAX_LABEL_VOXELS: usize = 3 << 20;
/// Extents flatter than this, relative to the others, are looked at from above.
const FLAT: f64 = 0.45;
const FLAT_ELEVATION: f64 = 50.0;

/// A scene that suits a volume, and what was decided.
#[derive(Clone, Debug)]
pub struct FirstPicture {
    /// The scene; its transfer function is left automatic.
    pub scene: Scene,
    /// The volume to render it with: the one given, or a thinned one.
    pub volume: Arc<Volume>,
    /// What the volume is taken for.
    pub guess: Guess,
    /// What was reduced, in words.
    pub notices: Vec<String>,
}

impl FirstPicture {
    /// Chooses camera, light and storage for the volume read from `path`; `overrides` come last.
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] for an override that does not fit.
    pub fn of(path: &Path, volume: Arc<Volume>, overrides: &[Override]) -> Result<Self> {
        let guess = Guess::of(&volume);
        let mut notices = Vec::new();
        let is_labels = guess.modality == Modality::Labels;
        let too_many = is_labels && volume.voxels().len() > MAX_LABEL_VOXELS;
        let volume = if too_many {
            let every = (volume.voxels().len() as f64 / MAX_LABEL_VOXELS as f64)
                .cbrt()
                .ceil() as u32;
            notices.push(format!(
                "labels are thinned to every voxel in {every} on each axis; a scene file renders all of them"
            ));
            Arc::new(volume.thinned(every)?)
        } else {
            volume
        };
        let plain = Scene::for_volume(path, overrides)?;
        let suitable = || match too_many {
            true => Guess::of(&volume).preset,
            false => guess.preset,
        };
        let colors = plain.image.color_management;
        let transfer_function = &plain.transfer_function;
        let curve = transfer_function.curve_as(&volume, colors, suitable)?;
        let visible = Visible::of(&volume, &curve);
        let light = Light::of(&volume, &visible, is_labels);
        if light.data_reduction > 1.0 {
            notices.push(format!(
                "storage.data_reduction is {:.1}; 1 renders every voxel",
                light.data_reduction
            ));
        }
        let interpolation = if is_labels { "nearest" } else { "linear" };
        let chosen = json!({
            "camera": {
                "type": "auto",
                "elevation": elevation(&visible),
                "frame": "visible",
            },
            "march": { "interpolation": interpolation },
            "ambient_occlusion": {
                "rays": light.rays,
                "radius": light.radius,
                "step": light.step,
            },
            "storage": { "data_reduction": light.data_reduction },
        });
        Ok(Self {
            scene: Scene::for_volume_with(path, chosen, overrides)?,
            volume,
            guess,
            notices,
        })
    }
}

/// Looks from higher above at what lies flat.
fn elevation(visible: &Visible) -> Value {
    let flat = visible
        .extent_ws()
        .is_some_and(|e| e.z < FLAT * e.x.min(e.y));
    json!(if flat { FLAT_ELEVATION } else { 20.0 })
}

/// Ambient occlusion and storage by what they cost.
struct Light {
    rays: u32,
    radius: f64,
    step: f64,
    data_reduction: f64,
}

impl Light {
    fn of(volume: &Volume, visible: &Visible, is_labels: bool) -> Self {
        let extent = visible.extent_ws().map_or(0.0, glam::DVec3::max_element);
        let radius = (RADIUS_SHARE * extent / volume.min_spacing()).clamp(RADIUS[0], RADIUS[1]);
        let radius = radius.round();
        let step = ((radius - 1.0) / SAMPLES_PER_RAY).max(1.0);
        let samples_per_direction = visible.voxels().max(1.0) * SAMPLES_PER_RAY;
        let rays = (LIGHT_SAMPLES / samples_per_direction).clamp(RAYS[0], RAYS[1]);
        let data_reduction = if is_labels || visible.voxels() <= MAX_VISIBLE {
            1.0
        } else {
            let reduction = volume.voxels().len() as f64 / MAX_VISIBLE;
            (10.0 * reduction).round() / 10.0
        };
        Self {
            rays: rays as u32,
            radius,
            step,
            data_reduction,
        }
    }
}
