//! What is measured of a field.

use std::sync::Arc;

use serde::Serialize;
use umbravox::Result;
use umbravox::headless::{Headless, LightStats, Session, Stats};
use umbravox::renderer::Settings;
use umbravox::scene::{
    AmbientOcclusion, Camera, Image, Lighting, March, Scene, Shading, Storage, VolumeSource,
};

use crate::fields::Field;

/// How much is measured.
#[derive(Debug, Serialize)]
pub(crate) struct Plan {
    /// Edge of the procedural volumes, voxels.
    pub(crate) size: u32,
    /// Edge of the pictures, pixels.
    pub(crate) image: u32,
    /// Measured pictures of a kind, after one that is not counted.
    pub(crate) repeats: u32,
    /// Traced directions of light.
    pub(crate) rays: u32,
}

impl Plan {
    pub(crate) fn full(size: u32, image: u32) -> Self {
        Self {
            size,
            image,
            repeats: 5,
            rays: 6,
        }
    }

    /// Enough to see that everything runs.
    pub(crate) fn smoke() -> Self {
        Self {
            size: 24,
            image: 16,
            repeats: 1,
            rays: 2,
        }
    }
}

/// Figures of one field.
#[derive(Debug, Serialize)]
pub(crate) struct Measured {
    pub(crate) field: &'static str,
    /// Share of the voxels that the transfer function shows.
    pub(crate) visible: f64,
    pub(crate) pictures: Vec<Picture>,
    pub(crate) light: Option<Light>,
}

/// Figures of one kind of picture.
#[derive(Debug, Serialize)]
pub(crate) struct Picture {
    pub(crate) kind: &'static str,
    /// Voxels.
    pub(crate) step: f64,
    /// From the start of recording to completion.
    pub(crate) frame_ms: Spread,
    /// The march alone, on the device.
    pub(crate) march_ms: Spread,
    /// The bare march of the same rays, on the device.
    pub(crate) bare_ms: Spread,
    pub(crate) samples: u64,
    pub(crate) bare_samples: u64,
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

/// Figures of the light pass.
#[derive(Debug, Serialize)]
pub(crate) struct Light {
    pub(crate) ms_per_ray: f64,
    /// Voxels that light is computed for.
    pub(crate) voxels: u64,
}

impl Light {
    pub(crate) fn ms_per_million_voxels(&self) -> f64 {
        self.ms_per_ray / (self.voxels as f64 * 1e-6)
    }
}

#[derive(Debug, Serialize)]
pub(crate) struct Spread {
    pub(crate) min: f64,
    pub(crate) median: f64,
    pub(crate) max: f64,
}

impl Spread {
    fn of(mut values: Vec<f64>) -> Self {
        values.sort_by(f64::total_cmp);
        let at = |place: usize| values.get(place).copied().unwrap_or(f64::NAN);
        Self {
            min: at(0),
            median: at(values.len() / 2),
            max: at(values.len().saturating_sub(1)),
        }
    }
}

/// A kind of picture.
struct Kind {
    name: &'static str,
    step: f64,
    shading: Shading,
    lit: bool,
}

const fn kind(name: &'static str, step: f64, shading: Shading, lit: bool) -> Kind {
    Kind {
        name,
        step,
        shading,
        lit,
    }
}

const KINDS: [Kind; 4] = [
    kind("plain", 1.0, Shading::None, false),
    kind("plain", 0.5, Shading::None, false),
    kind("diffuse", 1.0, Shading::Diffuse, false),
    kind("LAO", 1.0, Shading::None, true),
];

/// Measures everything of a field.
///
/// # Errors
/// As [`Session::frame`].
pub(crate) fn field(headless: &Headless, field: &Field, plan: &Plan) -> Result<Measured> {
    let mut measured = Measured {
        field: field.name,
        visible: visible_share(field)?,
        pictures: Vec::new(),
        light: None,
    };
    for kind in &KINDS {
        let scene = scene(field, kind, plan);
        let mut session = headless.load(Arc::clone(&field.volume), &scene)?;
        while session.refine_light()? {}
        measured
            .pictures
            .push(picture(&mut session, field, &scene, kind, plan)?);
        if let Some(LightStats {
            ms_per_ray, voxels, ..
        }) = session.stats()?.lao
        {
            measured.light = Some(Light { ms_per_ray, voxels });
        }
    }
    Ok(measured)
}

/// Measures pictures and bare marches in turn, so that both meet the same clock rates and the same load.
fn picture(
    session: &mut Session,
    field: &Field,
    scene: &Scene,
    kind: &Kind,
    plan: &Plan,
) -> Result<Picture> {
    let bare_samples = all_samples(session, field, scene)?;
    let (mut frame_ms, mut march_ms, mut bare_ms) = (Vec::new(), Vec::new(), Vec::new());
    let mut samples = 0;
    for repeat in 0..=plan.repeats {
        let frame = session.timed_frame()?;
        let bare = session.timed_bare_march()?;
        if repeat == 0 {
            continue; // pipelines were built
        }
        let stats = session.stats()?;
        samples = stats.samples.taken;
        frame_ms.push(frame);
        march_ms.push(pass_ms(&stats, "march").unwrap_or(frame));
        bare_ms.push(pass_ms(&stats, "bare").unwrap_or(bare));
    }
    Ok(Picture {
        kind: kind.name,
        step: kind.step,
        frame_ms: Spread::of(frame_ms),
        march_ms: Spread::of(march_ms),
        bare_ms: Spread::of(bare_ms),
        samples,
        bare_samples,
    })
}

/// Samples of a picture that skips nothing and ends no ray early, as the bare march takes them.
fn all_samples(session: &mut Session, field: &Field, scene: &Scene) -> Result<u64> {
    let mut whole = scene.clone();
    whole.march.empty_space_skipping = false;
    whole.march.early_termination = 1.0;
    session.set_settings(Settings::of_scene(&whole, &field.volume)?)?;
    session.timed_frame()?;
    let samples = session.stats()?.samples.taken;
    session.set_settings(Settings::of_scene(scene, &field.volume)?)?;
    Ok(samples)
}

/// Time of a pass on the device; `None` without timestamps.
fn pass_ms(stats: &Stats, name: &str) -> Option<f64> {
    stats
        .passes
        .iter()
        .find(|p| p.name == name)
        .map(|p| p.gpu_ms)
}

fn scene(field: &Field, kind: &Kind, plan: &Plan) -> Scene {
    Scene {
        volume: VolumeSource {
            path: field.name.into(),
            ..Default::default()
        },
        camera: Camera::default(),
        image: Image {
            size: [plan.image; 2],
            ..Default::default()
        },
        transfer_function: field.transfer_function.clone(),
        march: March {
            step: kind.step,
            ..Default::default()
        },
        lighting: Lighting {
            shading: kind.shading,
            ..Default::default()
        },
        ambient_occlusion: kind.lit.then(|| AmbientOcclusion {
            rays: plan.rays,
            ..Default::default()
        }),
        storage: Storage::default(),
    }
}

/// Share of the voxels that the transfer function shows.
fn visible_share(field: &Field) -> Result<f64> {
    let volume = &field.volume;
    let curve = field.transfer_function.curve(volume, Default::default())?;
    let voxels = volume.voxels();
    let shown = (0..voxels.len()).filter(|&at| {
        let value = volume.value_from_stored(voxels.get(at));
        curve.evaluate(value).opacity > 0.0
    });
    Ok(shown.count() as f64 / voxels.len() as f64)
}
