//! Pictures and light, each in turn with its limit, so that both meet the same clock rates and the same load.

use std::sync::Arc;

use umbravox::Result;
use umbravox::headless::{FrameTime, Headless, Session};
use umbravox::renderer::Settings;
use umbravox::scene::{
    AmbientOcclusion, Camera, Classification, Image, Lighting, March, RaySampling, Scene, Shading,
    Storage, VolumeSource,
};
use umbravox::volume::Volume;

use crate::fields::Field;
use crate::figures::{Case, Growing, Light, Picture, Spread};

/// Bytes of a pixel: the picture, what the headless renderer measures beside it, and the buffer that is read back through.
const PIXEL_BYTES: u64 = 3 * 16;

/// A scene that draws `case`.
pub(crate) fn scene(field: &Field, case: &Case) -> Scene {
    let classification = if case.preintegrated {
        Classification::Preintegrated
    } else {
        Classification::Post
    };
    Scene {
        volume: VolumeSource {
            path: field.name.into(),
            ..Default::default()
        },
        camera: Camera::default(),
        image: Image {
            size: [case.image; 2],
            ..Default::default()
        },
        transfer_function: field.transfer_function(),
        march: March {
            step: case.step,
            classification: Some(classification),
            ..Default::default()
        },
        lighting: Lighting {
            shading: if case.shaded {
                Shading::Diffuse
            } else {
                Shading::None
            },
            ..Default::default()
        },
        ambient_occlusion: (case.rays > 0).then(|| AmbientOcclusion {
            rays: case.rays,
            ..Default::default()
        }),
        storage: Storage::default(),
    }
}

/// A picture and the bare march, in turn.
///
/// # Errors
/// As [`Headless::load`] and [`Session::frame`].
pub(crate) fn picture(
    headless: &Headless,
    field: &Field,
    volume: &Arc<Volume>,
    case: &Case,
    repeats: u32,
) -> Result<Picture> {
    let scene = scene(field, case);
    let mut session = headless.load(Arc::clone(volume), &scene)?;
    let bare_samples = all_samples(&mut session, volume, &scene)?;
    let clock = Clock::of(headless);
    let (mut frames, mut march_ms, mut bare_ms) = (Vec::new(), Vec::new(), Vec::new());
    for repeat in 0..=repeats {
        let frame = session.timed_frame()?;
        let march = clock.device_ms(&session, "march", frame);
        let bare = session.timed_bare_march()?;
        let bare = clock.device_ms(&session, "bare", bare);
        if repeat > 0 {
            frames.push(frame);
            march_ms.push(march);
            bare_ms.push(bare);
        }
    }
    session.timed_frame()?;
    let stats = session.stats()?;
    Ok(Picture {
        case: case.clone(),
        size: volume.size(),
        visible: visible_share(field, volume)?,
        frame_ms: wall(&frames),
        cpu_ms: cpu(&frames),
        march_ms: Spread::of(march_ms),
        bare_ms: Spread::of(bare_ms),
        samples: stats.samples.taken,
        bare_samples,
        voxel_bytes: volume.voxels().len() as u64 * volume.voxels().voxel_type().bytes() as u64,
        resident_bytes: stats.memory.device_bytes
            - stats.memory.packed_cells_bytes
            - stats.memory.beams_bytes
            - PIXEL_BYTES * u64::from(case.image).pow(2),
        packed_bytes: stats.memory.packed_cells_bytes,
        uploaded_bytes: stats.memory.uploaded_bytes,
    })
}

/// Light of `case.rays` directions and bare light, in turn; `None` where samples cannot be counted.
///
/// # Errors
/// As [`picture`].
pub(crate) fn light(
    headless: &Headless,
    field: &Field,
    volume: &Arc<Volume>,
    case: &Case,
) -> Result<Option<Light>> {
    let mut session = headless.load(Arc::clone(volume), &scene(field, case))?;
    let clock = Clock::of(headless);
    let (mut trace_ms, mut bare_ms) = (Vec::new(), Vec::new());
    // Once for the pipelines, then once for each direction.
    for repeat in 0..=case.rays {
        // Each bare direction starts the light again: both sides trace the first direction.
        let trace = session.timed_light()?;
        let trace = trace.map(|time| clock.device_ms(&session, "light", time));
        let bare = session.timed_bare_light()?;
        let bare = bare.map(|time| clock.device_ms(&session, "bare_light", time));
        if let (1.., Some(trace), Some(bare)) = (repeat, trace, bare) {
            trace_ms.push(trace);
            bare_ms.push(bare);
        }
    }
    let Some(samples) = session.count_light_samples()? else {
        return Ok(None);
    };
    let (Some(ao), Some(stats)) = (
        session.settings().ambient_occlusion.clone(),
        session.stats()?.lao,
    ) else {
        return Ok(None);
    };
    let parts = u64::from(ao.samples_per_ray());
    Ok(Some(Light {
        field: field.name.to_owned(),
        size: volume.size(),
        rays: case.rays,
        trace_ms: Spread::of(trace_ms),
        bare_ms: Spread::of(bare_ms),
        voxels: stats.voxels,
        samples,
        bare_samples: stats.voxels * parts,
        brute_force_samples: volume.voxels().len() as u64 * u64::from(case.rays) * parts,
        growing: None,
    }))
}

/// Light of `case.rays` directions by samples farther apart with distance, and uniform sampling, in turn; `None` where samples
/// cannot be counted.
///
/// # Errors
/// As [`picture`].
pub(crate) fn growing(
    headless: &Headless,
    field: &Field,
    volume: &Arc<Volume>,
    case: &Case,
) -> Result<Option<Growing>> {
    let clock = Clock::of(headless);
    let mut uniform = headless.load(Arc::clone(volume), &scene(field, case))?;
    let mut changed = scene(field, case);
    if let Some(ao) = &mut changed.ambient_occlusion {
        ao.sampling = RaySampling::Distance;
    }
    let mut growing = headless.load(Arc::clone(volume), &changed)?;
    let mut times = [Vec::new(), Vec::new()];
    for direction in 0..case.rays {
        for (session, times) in [&mut uniform, &mut growing].into_iter().zip(&mut times) {
            let time = session.timed_light()?;
            let time = time.map(|time| clock.device_ms(session, "light", time));
            // The first is the pipeline's.
            times.extend(time.filter(|_| direction > 0));
        }
    }
    let (expected, actual) = (uniform.light_volume()?, growing.light_volume()?);
    let lit = expected.rgba.iter().zip(&actual.rgba);
    let errors = lit
        .filter(|(voxel, _)| voxel[3] > 0.0)
        .flat_map(|(a, b)| [0, 1, 2].map(|channel| f64::from(a[channel] - b[channel])));
    let (mut count, mut squares, mut largest) = (0.0, 0.0, 0f64);
    for error in errors {
        count += 1.0;
        squares += error * error;
        largest = largest.max(error.abs());
    }
    let growth = growing.stats()?.lao.and_then(|light| light.growth);
    let Some(samples) = growing.count_light_samples()? else {
        return Ok(None);
    };
    let ao = growing.settings().ambient_occlusion.as_ref();
    let parts = ao.map_or(0, |ao| u64::from(ao.samples_per_ray()));
    let [uniform_ms, trace_ms] = times.map(Spread::of);
    Ok(Some(Growing {
        rays: case.rays,
        growth,
        uniform_ms,
        trace_ms,
        samples,
        brute_force_samples: volume.voxels().len() as u64 * u64::from(case.rays) * parts,
        rms_error: (squares / f64::max(count, 1.0)).sqrt(),
        largest_error: largest,
    }))
}

/// How long a device works.
pub(crate) enum Clock {
    /// By its timestamps.
    Timestamps,
    /// The processor is the device: processor time over the cores, which other work on the machine does not stretch.
    Processor { cores: f64 },
}

impl Clock {
    pub(crate) fn of(headless: &Headless) -> Self {
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        match headless.device().device_type.as_str() {
            "cpu" => Self::Processor {
                cores: cores as f64,
            },
            _ => Self::Timestamps,
        }
    }

    /// Of the last pass of this name, which was all of `time`'s work on the device.
    pub(crate) fn device_ms(&self, session: &Session, pass: &str, time: FrameTime) -> f64 {
        match (self, time.cpu_ms) {
            (Self::Processor { cores }, Some(cpu_ms)) => cpu_ms / cores,
            _ => pass_ms(session, pass).unwrap_or(time.wall_ms),
        }
    }

    /// Of the last pass of this name, beside which the device did other work in `time` that takes `others_ms` by itself.
    pub(crate) fn beside_ms(
        &self,
        session: &Session,
        pass: &str,
        time: FrameTime,
        others_ms: f64,
    ) -> f64 {
        match self {
            Self::Processor { .. } => {
                f64::max(self.device_ms(session, pass, time) - others_ms, 0.0)
            }
            Self::Timestamps => pass_ms(session, pass).unwrap_or(0.0),
        }
    }
}

/// By the clock.
pub(crate) fn wall(times: &[FrameTime]) -> Spread {
    Spread::of(times.iter().map(|time| time.wall_ms).collect())
}

fn cpu(times: &[FrameTime]) -> Option<Spread> {
    let times: Option<Vec<f64>> = times.iter().map(|time| time.cpu_ms).collect();
    times.map(Spread::of)
}

/// Samples of a picture that skips nothing and ends no ray early, as the bare march takes them.
fn all_samples(session: &mut Session, volume: &Volume, scene: &Scene) -> Result<u64> {
    let mut whole = scene.clone();
    whole.march.empty_space_skipping = false;
    whole.march.early_termination = 1.0;
    whole.march.classification = Some(Classification::Post);
    whole.lighting.shading = Shading::None;
    session.set_settings(Settings::of_scene(&whole, volume)?)?;
    session.timed_frame()?;
    let samples = session.stats()?.samples.taken;
    session.set_settings(Settings::of_scene(scene, volume)?)?;
    Ok(samples)
}

/// Time of a pass on the device; `None` without timestamps.
fn pass_ms(session: &Session, name: &str) -> Option<f64> {
    let passes = session.passes();
    passes.iter().find(|p| p.name == name).map(|p| p.gpu_ms)
}

/// Share of the voxels that the transfer function shows.
fn visible_share(field: &Field, volume: &Volume) -> Result<f64> {
    use rayon::prelude::*;
    let curve = field
        .transfer_function()
        .curve(volume, Default::default())?;
    let voxels = volume.voxels();
    let shown = (0..voxels.len()).into_par_iter().filter(|&at| {
        let value = volume.value_from_stored(voxels.get(at));
        curve.evaluate(value).opacity > 0.0
    });
    Ok(shown.count() as f64 / voxels.len() as f64)
}
