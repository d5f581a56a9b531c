//! What the optical models cost, and how far the fast ones are from the exact: `cargo bench --bench optics`.
//!
//! The cloud of Max's figures, in several media, is drawn by every method of multiple scattering. Pictures are compared with path
//! tracing: root mean square difference as a share of the picture's root mean square, its noise taken off. Then what shadows cost
//! on a static view, and what majorants of skip cells gain over one for the volume on a sparse scene. Times are of one process, so
//! that ratios mean something. Options go after `--`: `--json PATH` writes the figures there too, `--paths N` (default 512) per pixel of
//! the reference.

use std::process::ExitCode;
use std::sync::Arc;
use std::time::Instant;

use serde::Serialize;
use serde_json::{Value, json};
use umbravox::headless::{Headless, Options};
use umbravox::io::{ReadOptions, volume_of};
use umbravox::picture::Picture;
use umbravox::scene::Scene;
use umbravox::volume::Volume;
use umbravox::{Error, Result};

/// Media of the cloud: name, albedo, phase function.
const MEDIA: [(&str, f64, f64); 3] = [
    ("isotropic, albedo 0.5", 0.5, 0.0),
    ("isotropic, albedo 0.99", 0.99, 0.0),
    ("forward 0.6, albedo 0.9", 0.9, 0.6),
];

/// Names and settings of the methods, from cheap to exact.
fn ladder() -> Vec<(&'static str, Value)> {
    let multiple =
        |scattering: Value| json!({ "model": "multiple_scattering", "scattering": scattering });
    vec![
        ("single_scattering", json!({ "model": "single_scattering" })),
        (
            "shadowed_scattering, sweep",
            json!({ "model": "shadowed_scattering" }),
        ),
        (
            "shadowed_scattering, rays",
            json!({ "model": "shadowed_scattering", "shadows": { "method": "rays" } }),
        ),
        ("diffusion", multiple(json!({ "method": "diffusion" }))),
        ("zonal", multiple(json!({ "method": "zonal" }))),
        (
            "ordinates, 24 bins",
            multiple(json!({ "method": "ordinates", "directions": 24, "resolution": 24 })),
        ),
        (
            "ordinates, 96 bins",
            multiple(json!({ "method": "ordinates", "resolution": 24 })),
        ),
    ]
}

#[derive(Serialize)]
struct Row {
    medium: String,
    method: String,
    /// Share of the picture's root mean square.
    error: f64,
    /// Solver, then the picture.
    solve_ms: f64,
    frame_ms: f64,
    iterations: u32,
}

#[derive(Serialize)]
struct Ratio {
    what: &'static str,
    ratio: f64,
    goal: &'static str,
}

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<()> {
    let (mut json_path, mut paths, mut measured) = (None, 512u32, false);
    let mut args = std::env::args().skip(1);
    while let Some(arg) = args.next() {
        match arg.as_str() {
            "--bench" => measured = true,
            "--test" => measured = false,
            "--json" => json_path = args.next(),
            "--paths" => paths = args.next().and_then(|n| n.parse().ok()).unwrap_or(paths),
            other => return Err(Error::invalid(other, "give --json PATH or --paths N")),
        }
    }
    if !measured {
        paths = 2;
    }
    let headless = Headless::new(&Options::default())?;
    let media = if measured { &MEDIA[..] } else { &MEDIA[..1] };
    let mut rows = Vec::new();
    for &(medium, albedo, g) in media {
        rows.extend(measure_medium(&headless, medium, albedo, g, paths)?);
    }
    let ratios = vec![shadows(&headless)?, majorants(&headless)?];
    print(&headless, &rows, &ratios);
    if let Some(path) = json_path {
        let figures = json!({ "device": headless.device().name, "models": rows, "ratios": ratios });
        umbravox::output::write_bytes(path.as_ref(), figures.to_string().as_bytes())?;
    }
    Ok(())
}

fn scene(lighting: &Value, albedo: f64, g: f64, opacity: f64) -> Result<Scene> {
    let mut lighting = lighting.clone();
    if lighting["shadows"].is_null() {
        lighting["shadows"] = json!({ "spacing": 1 });
    }
    lighting["albedo"] = json!([albedo, albedo, albedo]);
    lighting["phase"] = json!({ "type": "henyey_greenstein", "g": g });
    if g == 0.0 {
        lighting["phase"] = json!({ "type": "isotropic" });
    }
    lighting["lights"] =
        json!([{ "type": "directional", "direction": [-0.6, -0.3, 0.8], "irradiance": [3, 3, 3] }]);
    let scene = json!({
        "volume": { "procedural": { "type": "cloud", "size": [48, 48, 36] } },
        "camera": { "type": "auto", "azimuth": 25, "elevation": 12, "zoom": 1.2 },
        "image": { "size": [96, 72], "color_management": "none" },
        "transfer_function": { "unit_distance": 1.0, "points": [
            { "value": 0, "color": [1, 1, 1], "opacity": 0.0 },
            { "value": 1, "color": [1, 1, 1], "opacity": opacity },
        ] },
        "march": { "step": 0.5, "early_termination": 1 },
        "lighting": lighting,
    });
    Scene::from_json(&scene.to_string(), ".".as_ref(), &[])
}

/// Pixels on an edge that are averaged.
const FINER: u32 = 4;

/// The mean of each square of pixels.
fn averaged(finer: &Picture) -> Picture {
    let size = finer.size.map(|n| n / FINER);
    let pixel = |i: usize| -> [f32; 4] {
        let (x, y) = (i % size[0] as usize, i / size[0] as usize);
        let edge = FINER as usize;
        let mut sum = [0.0f32; 4];
        for part in 0..edge * edge {
            let at = (y * edge + part / edge) * finer.size[0] as usize + x * edge + part % edge;
            sum = std::array::from_fn(|c| sum[c] + finer.rgba[at][c]);
        }
        sum.map(|c| c / (FINER * FINER) as f32)
    };
    let count = size[0] as usize * size[1] as usize;
    Picture {
        size,
        rgba: (0..count).map(pixel).collect(),
        ..finer.clone()
    }
}

struct Drawn {
    picture: Picture,
    solve_ms: f64,
    frame_ms: f64,
    iterations: u32,
}

fn draw(headless: &Headless, volume: &Arc<Volume>, scene: &Scene) -> Result<Drawn> {
    let mut session = headless.load(Arc::clone(volume), scene)?;
    // Pipelines are compiled on the way; the second time around nothing else is different.
    while session.refine_light()? {}
    session.timed_frame()?;
    let mut session = headless.load(Arc::clone(volume), scene)?;
    let start = Instant::now();
    while session.refine_light()? {}
    let solve_ms = start.elapsed().as_secs_f64() * 1e3;
    let picture = session.frame()?;
    let stats = session.stats()?;
    Ok(Drawn {
        picture,
        solve_ms,
        frame_ms: stats.frame_ms,
        iterations: stats.scattering.map_or(0, |s| s.iterations),
    })
}

fn measure_medium(
    headless: &Headless,
    medium: &str,
    albedo: f64,
    g: f64,
    paths: u32,
) -> Result<Vec<Row>> {
    let row = |method: &str, drawn: &Drawn, error: f64| Row {
        medium: medium.into(),
        method: method.into(),
        error,
        solve_ms: drawn.solve_ms,
        frame_ms: drawn.frame_ms,
        iterations: drawn.iterations,
    };
    let traced = json!({ "model": "multiple_scattering", "scattering": { "method": "monte_carlo", "samples": paths } });
    let traced = scene(&traced, albedo, g, 0.3)?;
    let volume = Arc::new(volume_of(&traced.volume, &ReadOptions::default())?);
    let reference = draw(headless, &volume, &traced)?;
    let mut rows = Vec::new();
    for (method, lighting) in ladder() {
        // Zones are for isotropic media alone; others cost ordinates the square of the bins.
        if g != 0.0 && (method == "zonal" || method == "ordinates, 96 bins") {
            continue;
        }
        let mut scene = scene(&lighting, albedo, g, 0.3)?;
        let mut drawn = draw(headless, &volume, &scene)?;
        // Paths start anywhere in their pixel: so do rays, near enough, of a picture with sixteen times the pixels.
        scene.image.size = scene.image.size.map(|n| FINER * n);
        drawn.picture = averaged(&draw(headless, &volume, &scene)?.picture);
        rows.push(row(
            method,
            &drawn,
            difference(&drawn.picture, &reference.picture),
        ));
        eprintln!("{medium}: {method}");
    }
    let noise = noise(&reference.picture);
    rows.push(row(
        &format!("monte_carlo, a path of {paths} (error: noise of all)"),
        &reference,
        noise,
    ));
    Ok(rows)
}

/// Root mean square difference as a share of the reference's, its noise taken off.
fn difference(picture: &Picture, reference: &Picture) -> f64 {
    let pairs = picture.rgba.iter().zip(&reference.rgba);
    let (mut apart, mut whole) = (0.0, 0.0);
    for (a, b) in pairs {
        for c in 0..3 {
            apart += (f64::from(a[c]) - f64::from(b[c])).powi(2);
            whole += f64::from(b[c]).powi(2);
        }
    }
    let noise = variance(reference);
    ((apart - noise).max(0.0) / whole).sqrt()
}

fn variance(picture: &Picture) -> f64 {
    let variances = picture.variance.iter().flatten().flatten();
    variances.map(|&v| f64::from(v)).sum()
}

fn noise(picture: &Picture) -> f64 {
    let whole: f64 = picture
        .rgba
        .iter()
        .flat_map(|p| &p[..3])
        .map(|&c| f64::from(c).powi(2))
        .sum();
    (variance(picture) / whole).sqrt()
}

/// Median of frames of two scenes, taken in turn.
fn alternated(headless: &Headless, volume: &Arc<Volume>, scenes: [&Scene; 2]) -> Result<[f64; 2]> {
    let mut sessions = Vec::new();
    for scene in scenes {
        let mut session = headless.load(Arc::clone(volume), scene)?;
        while session.refine_light()? {}
        session.timed_frame()?;
        sessions.push(session);
    }
    let is_cpu = headless.device().device_type == "cpu";
    let mut times: [Vec<f64>; 2] = [Vec::new(), Vec::new()];
    for _ in 0..7 {
        for (session, times) in sessions.iter_mut().zip(&mut times) {
            let time = session.timed_frame()?;
            // A processor that is the device works in its own time, whoever shares the machine.
            times.push(time.cpu_ms.filter(|_| is_cpu).unwrap_or(time.wall_ms));
        }
    }
    Ok(times.map(|mut times| {
        times.sort_by(f64::total_cmp);
        times[times.len() / 2]
    }))
}

fn shadows(headless: &Headless) -> Result<Ratio> {
    let of = |model: &str| -> Result<Scene> {
        let mut scene = scene(&json!({ "model": model }), 0.99, 0.6, 0.3)?;
        scene.image.size = [384, 288];
        Ok(scene)
    };
    let (without, with) = (of("single_scattering")?, of("shadowed_scattering")?);
    let volume = Arc::new(volume_of(&without.volume, &ReadOptions::default())?);
    let [without, with] = alternated(headless, &volume, [&without, &with])?;
    Ok(Ratio {
        what: "frame with swept shadows / without, static view",
        ratio: with / without,
        goal: "at most 2",
    })
}

/// A dense heap in the corner of an empty volume, with a thin wisp elsewhere.
fn majorants(headless: &Headless) -> Result<Ratio> {
    let of = |majorant: &str| -> Result<Scene> {
        let lighting = json!({ "model": "multiple_scattering", "scattering": { "method": "monte_carlo", "majorant": majorant } });
        let mut scene = scene(&lighting, 0.9, 0.0, 0.98)?;
        let cloud = json!({ "type": "cloud", "size": [128, 128, 128], "turbulence": 0, "ellipsoids": [
            { "center": [0.5, 0.5, 0.5], "radii": [0.05, 0.05, 0.05], "density": 1.0 },
            { "center": [0.3, 0.6, 0.4], "radii": [0.08, 0.03, 0.03], "density": 0.02 },
        ] });
        let procedural = serde_json::from_value(cloud);
        scene.volume.procedural =
            Some(procedural.map_err(|e| Error::invalid("cloud", e.to_string()))?);
        scene.image.size = [128, 128];
        Ok(scene)
    };
    let (local, global) = (of("local")?, of("global")?);
    let volume = Arc::new(volume_of(&local.volume, &ReadOptions::default())?);
    let [local, global] = alternated(headless, &volume, [&local, &global])?;
    Ok(Ratio {
        what: "path with one majorant for the volume / with those of skip cells, sparse",
        ratio: global / local,
        goal: "at least 5",
    })
}

fn print(headless: &Headless, rows: &[Row], ratios: &[Ratio]) {
    println!("{}\n", headless.device().name);
    println!("| medium | method | error | solver, ms | iterations | frame, ms |");
    println!("| --- | --- | --- | --- | --- | --- |");
    for r in rows {
        println!(
            "| {} | {} | {:.1} % | {:.0} | {} | {:.0} |",
            r.medium,
            r.method,
            100.0 * r.error,
            r.solve_ms,
            r.iterations,
            r.frame_ms
        );
    }
    println!();
    for r in ratios {
        println!("{}: {:.2} (goal: {})", r.what, r.ratio, r.goal);
    }
}
