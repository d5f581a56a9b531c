//! What one change does: skipping, a new transfer function, fewer voxels, and everything around the frame.

use std::io::{Read as _, Write as _};
use std::path::Path;
use std::process::Command;
use std::sync::Arc;
use std::time::Instant;

use flate2::Compression;
use flate2::read::GzDecoder;
use flate2::write::GzEncoder;
use tempfile::TempDir;
use umbravox::headless::{Headless, Session};
use umbravox::renderer::Settings;
use umbravox::volume::{Volume, Voxels};
use umbravox::{Error, Result};

use crate::fields::{self, Field};
use crate::figures::{Case, Effects, Reduction, Spread, WholeProcess};
use crate::measure::{self, Clock, wall};
use crate::plan::Plan;

/// Data reductions of figure 5 of Hernell, Ljung and Ynnerman (2007).
const REDUCTIONS: [f64; 5] = [1.0, 8.5, 15.7, 31.4, 92.8];

/// Measures all of them.
///
/// # Errors
/// As [`measure::picture`]; [`Error::Io`] for temporary files.
pub(crate) fn measure(headless: &Headless, plan: &Plan) -> Result<Effects> {
    let base = |field: &str, size| Case {
        field: field.to_owned(),
        size,
        image: plan.image,
        step: 1.0,
        shaded: false,
        preintegrated: false,
        rays: 0,
    };
    let blobs = Case {
        preintegrated: true,
        ..base("blobs", plan.size)
    };
    // The first is the pipeline's; the last has the joining of bricks with it.
    let reduced = Case {
        rays: 5,
        ..base("blobs", 2 * plan.size)
    };
    Ok(Effects {
        skipping: Some(skipping(headless, &base("fog", plan.size), plan.repeats)?),
        edit: Some(edit(headless, &blobs, plan.repeats)?),
        reductions: reductions(headless, &reduced)?,
        process: Some(whole_process(&base("shell", plan.size), plan.repeats)?),
    })
}

fn load(headless: &Headless, case: &Case) -> Result<(&'static Field, Arc<Volume>, Session)> {
    let field = fields::find(&case.field)?;
    let volume = field.volume(case.size)?;
    let session = headless.load(Arc::clone(&volume), &measure::scene(field, case))?;
    Ok((field, volume, session))
}

/// Frames with skipping and without.
fn skipping(headless: &Headless, case: &Case, repeats: u32) -> Result<[Spread; 2]> {
    let (field, volume, mut session) = load(headless, case)?;
    let clock = Clock::of(headless);
    let mut times = [Vec::new(), Vec::new()];
    for repeat in 0..=repeats {
        for (times, on) in times.iter_mut().zip([true, false]) {
            let mut scene = measure::scene(field, case);
            scene.march.empty_space_skipping = on;
            session.set_settings(Settings::of_scene(&scene, &volume)?)?;
            let time = session.timed_frame()?;
            if repeat > 0 {
                times.push(clock.device_ms(&session, "march", time));
            }
        }
    }
    Ok(times.map(Spread::of))
}

/// Plain frames, and frames that follow a new transfer function, with all that it takes to get there.
fn edit(headless: &Headless, case: &Case, repeats: u32) -> Result<[Spread; 2]> {
    let (field, volume, mut session) = load(headless, case)?;
    let scene = measure::scene(field, case);
    let (mut plain, mut edited) = (Vec::new(), Vec::new());
    for repeat in 0..=repeats {
        let mut changed = scene.clone();
        for point in changed.transfer_function.points.iter_mut().flatten() {
            // No two are alike, and all show the same places.
            point.opacity *= 1.0 - 0.01 * f64::from(repeat + 1);
        }
        let settings = Settings::of_scene(&changed, &volume)?;
        let start = Instant::now();
        session.set_settings(settings)?;
        session.timed_frame()?;
        let first = elapsed_ms(start);
        let second = session.timed_frame()?;
        if repeat > 0 {
            edited.push(first);
            plain.push(second);
        }
    }
    Ok([wall(&plain), Spread::of(edited)])
}

/// Light at every reduction: a direction that is not counted, others that are, and the last with the joining of bricks.
fn reductions(headless: &Headless, case: &Case) -> Result<Vec<Reduction>> {
    let field = fields::find(&case.field)?;
    let volume = field.volume(case.size)?;
    let clock = Clock::of(headless);
    let mut points = Vec::new();
    for asked in REDUCTIONS {
        let mut scene = measure::scene(field, case);
        scene.storage.data_reduction = asked;
        let mut session = headless.load(Arc::clone(&volume), &scene)?;
        session.timed_light()?;
        let mut times = Vec::new();
        for _ in 2..case.rays {
            let time = session.timed_light()?;
            times.extend(time.map(|time| clock.device_ms(&session, "light", time)));
        }
        let ms_per_ray = Spread::of(times).median;
        let last = session.timed_light()?;
        let stats = session.stats()?;
        points.extend(stats.lao.zip(last).map(|(light, last)| Reduction {
            size: case.size,
            asked,
            reached: stats.data_reduction,
            ms_per_ray,
            join_ms: clock.beside_ms(&session, "light_seam", last, ms_per_ray),
            voxels: light.voxels,
        }));
    }
    Ok(points)
}

/// `umbravox render` of a compressed NIfTI file, and its parts.
fn whole_process(case: &Case, repeats: u32) -> Result<WholeProcess> {
    let folder = TempDir::new_in(env!("CARGO_TARGET_TMPDIR"))
        .map_err(|e| Error::io(env!("CARGO_TARGET_TMPDIR"), e))?;
    let [packed, picture, stats] =
        ["volume.nii.gz", "picture.png", "stats.json"].map(|name| folder.path().join(name));
    let volume = fields::find(&case.field)?.volume(case.size)?;
    write_nifti(&packed, &volume).map_err(|e| Error::io(&packed, e))?;
    let image = format!("image.size=[{0},{0}]", case.image);
    let (mut render_ms, mut parts_ms) = (Vec::new(), Vec::new());
    for repeat in 0..=repeats.min(2) {
        let start = Instant::now();
        let status = Command::new(env!("CARGO_BIN_EXE_umbravox"))
            .args([
                "render",
                "--set",
                &image,
                "--set",
                "ambient_occlusion.rays=2",
            ])
            .arg(&packed)
            .arg("-o")
            .arg(&picture)
            .arg("--stats")
            .arg(&stats)
            .stderr(std::process::Stdio::null())
            .status();
        let whole = elapsed_ms(start);
        let status = status.map_err(|e| Error::io("umbravox", e))?;
        if !status.success() {
            return Err(Error::invalid("umbravox render", status.to_string()));
        }
        let start = Instant::now();
        let mut bytes = Vec::new();
        std::fs::File::open(&packed)
            .and_then(|file| GzDecoder::new(file).read_to_end(&mut bytes))
            .map_err(|e| Error::io(&packed, e))?;
        let unpack = elapsed_ms(start);
        if repeat > 0 {
            render_ms.push(whole);
            parts_ms.push(unpack + device_ms(&stats)?);
        }
    }
    Ok(WholeProcess {
        render_ms: Spread::of(render_ms),
        parts_ms: Spread::of(parts_ms),
    })
}

/// The frame and all directions of light, as `--stats` says.
fn device_ms(path: &Path) -> Result<f64> {
    let text = std::fs::read(path).map_err(|e| Error::io(path, e))?;
    let stats: serde_json::Value = serde_json::from_slice(&text)
        .map_err(|e| Error::invalid(path.display().to_string(), e.to_string()))?;
    let number = |value: &serde_json::Value| value.as_f64().unwrap_or(0.0);
    let light = &stats["lao"];
    Ok(number(&stats["frame_ms"]) + number(&light["rays"]) * number(&light["ms_per_ray"]))
}

/// NIfTI-1 of 8-bit voxels of 1 mm, compressed as gzip does by default.
fn write_nifti(path: &Path, volume: &Volume) -> std::io::Result<()> {
    let Voxels::U8(voxels) = volume.voxels() else {
        return Err(std::io::Error::other("computed volumes have 8 bits"));
    };
    let mut header = [0u8; 352];
    let mut put = |at: usize, bytes: &[u8]| header[at..at + bytes.len()].copy_from_slice(bytes);
    put(0, &348i32.to_le_bytes());
    let [x, y, z] = volume.size().map(|n| n as i16);
    for (at, n) in [3, x, y, z, 1, 1, 1, 1].into_iter().enumerate() {
        put(40 + 2 * at, &n.to_le_bytes()); // dim
        put(76 + 4 * at, &1f32.to_le_bytes()); // pixdim
    }
    put(70, &2i16.to_le_bytes()); // datatype: unsigned char
    put(72, &8i16.to_le_bytes()); // bitpix
    put(108, &352f32.to_le_bytes()); // vox_offset
    put(123, &[2]); // xyzt_units: mm
    put(344, b"n+1\0");
    let mut packer = GzEncoder::new(std::fs::File::create(path)?, Compression::default());
    packer.write_all(&header)?;
    packer.write_all(voxels)?;
    packer.finish().map(drop)
}

fn elapsed_ms(start: Instant) -> f64 {
    start.elapsed().as_secs_f64() * 1e3
}
