//! From a DICOM series on disk to the first picture, beside what reading and decoding its files takes:
//! `cargo bench --bench loading`.
//!
//! The floor is `dicom-rs` alone: every file read, its pixels decoded, the objects kept, on all cores. Floor, load and first
//! picture take turns, each in a process of its own, as somebody opens one series, and each a second time in that process, where
//! the floor finds a heap with pages in it. Files are in the page cache, pipelines in the user's cache folder.

use std::alloc::System;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use std::time::Instant;

use clap::{Parser, ValueEnum};
use dicom_object::DefaultDicomObject;
use dicom_pixeldata::PixelDecoder as _;
use peakmem_alloc::{PeakMemAlloc, PeakMemAllocTrait as _};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use tempfile::TempDir;
use umbravox::headless::{Headless, Options};
use umbravox::io::{ReadOptions, read};
use umbravox::scene::Scene;
use umbravox::{Error, Result, output};

#[global_allocator]
static ALLOCATOR: PeakMemAlloc<System> = PeakMemAlloc::new(System);

const SERIES: &str = "../shared/data/ct_chest_lidc0314_dicom.tar.xz";
/// Edge of the picture, pixels.
const IMAGE: u32 = 512;

/// From a DICOM series to the first picture.
#[derive(Parser)]
struct Args {
    /// A folder or an archive, `.tar.xz` say, which is unpacked first. Default: the largest of the larger volumes, in
    /// ../shared/data.
    #[arg(long)]
    series: Option<PathBuf>,
    /// Also write the figures there.
    #[arg(long)]
    json: Option<PathBuf>,
    /// Turns, after one that is not counted.
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=100))]
    repeats: u32,
    /// Leave the first picture out, which on a CPU takes far longer than the rest.
    #[arg(long)]
    no_picture: bool,
    /// Measure one thing in this process, print it as JSON.
    #[arg(long, hide = true)]
    task: Option<Task>,
    /// From `cargo bench`.
    #[arg(long, hide = true)]
    bench: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Task {
    Floor,
    Load,
    Picture,
}

/// What one process measures.
#[derive(Clone, Default, Serialize, Deserialize)]
struct Sample {
    ms: f64,
    /// Of all threads, counted in hundredths of a second; 0 where the system does not tell it.
    cpu_ms: f64,
    /// Most bytes on the heap.
    peak_bytes: usize,
    /// Of the volume, or of all decoded pixels.
    voxel_bytes: u64,
    /// Parts of `ms`, of the first picture: the volume is read, its scene chosen, it is on the device, the picture is read back.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    phases_ms: Vec<f64>,
}

/// The first time in a process and the second, by turn.
type Turns = Vec<[Sample; 2]>;

#[derive(Serialize)]
struct Figures {
    device: String,
    files: usize,
    floor: Turns,
    load: Turns,
    picture: Turns,
}

fn main() -> ExitCode {
    match run(&Args::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(args: &Args) -> Result<()> {
    let default = Path::new(env!("CARGO_MANIFEST_DIR")).join(SERIES);
    let series = args.series.as_deref().unwrap_or(&default);
    if let Some(task) = args.task {
        return measure(task, series);
    }
    if !series.exists() {
        let series = series.display();
        println!("nothing is measured: {series} is not there; --series names another");
        return Ok(());
    }
    if !args.bench {
        return Ok(()); // `cargo test --benches`
    }
    let scratch = TempDir::new_in(env!("CARGO_TARGET_TMPDIR"))
        .map_err(|e| Error::io(env!("CARGO_TARGET_TMPDIR"), e))?;
    let folder = if series.is_dir() {
        series
    } else {
        unpack(series, scratch.path())?;
        scratch.path()
    };
    let device = Headless::new(&Options::default())?.device();
    let mut figures = Figures {
        device: format!("{} ({})", device.name, device.driver),
        files: files_below(folder)?.len(),
        floor: Vec::new(),
        load: Vec::new(),
        picture: Vec::new(),
    };
    for turn in 0..=args.repeats {
        let take = |task, turns: &mut Turns| -> Result<()> {
            let sample = in_a_process(task, folder)?;
            if turn > 0 {
                turns.push(sample);
            }
            Ok(())
        };
        take(Task::Floor, &mut figures.floor)?;
        take(Task::Load, &mut figures.load)?;
        if !args.no_picture {
            take(Task::Picture, &mut figures.picture)?;
        }
    }
    print(&figures);
    let Some(path) = &args.json else {
        return Ok(());
    };
    let text = serde_json::to_string_pretty(&figures).map_err(|e| Error::Encode {
        path: path.clone(),
        message: e.to_string(),
    })?;
    output::write_bytes(path, text.as_bytes())
}

fn unpack(archive: &Path, into: &Path) -> Result<()> {
    let io = |e| Error::io(archive, e);
    let file = std::fs::File::open(archive).map_err(io)?;
    let plain = lzma_rust2::XzReader::new(std::io::BufReader::new(file), true);
    tar::Archive::new(plain).unpack(into).map_err(io)
}

fn files_below(folder: &Path) -> Result<Vec<PathBuf>> {
    let io = |e| Error::io(folder, e);
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(io)? {
        let path = entry.map_err(io)?.path();
        if path.is_dir() {
            files.extend(files_below(&path)?);
        } else {
            files.push(path);
        }
    }
    Ok(files)
}

fn in_a_process(task: Task, folder: &Path) -> Result<[Sample; 2]> {
    let failed = |why: String| Error::invalid(format!("{task:?}"), why);
    let name = format!("{task:?}").to_lowercase();
    let program = std::env::current_exe().map_err(|e| failed(e.to_string()))?;
    let mut command = Command::new(program);
    command.args(["--task", &name, "--series"]).arg(folder);
    let done = command.output().map_err(|e| failed(e.to_string()))?;
    if !done.status.success() {
        return Err(failed(String::from_utf8_lossy(&done.stderr).into_owned()));
    }
    serde_json::from_slice(&done.stdout).map_err(|e| failed(e.to_string()))
}

/// Twice, and prints both.
fn measure(task: Task, folder: &Path) -> Result<()> {
    let files = files_below(folder)?;
    let headless = match task {
        Task::Picture => Some(Headless::new(&Options::default())?),
        _ => None,
    };
    let once = || -> Result<Sample> {
        ALLOCATOR.reset_peak_memory();
        let (start, cpu) = (Instant::now(), cpu_ms());
        let (voxel_bytes, ends) = match &headless {
            Some(headless) => first_picture(headless, folder)?,
            None if task == Task::Floor => (decode_alone(&files)?, Vec::new()),
            None => (load(folder)?, Vec::new()),
        };
        let starts = std::iter::once(&start).chain(&ends);
        let phases = starts.zip(&ends);
        Ok(Sample {
            ms: start.elapsed().as_secs_f64() * 1e3,
            cpu_ms: cpu_ms() - cpu,
            peak_bytes: ALLOCATOR.get_peak_memory(),
            voxel_bytes,
            phases_ms: phases.map(|(a, b)| (*b - *a).as_secs_f64() * 1e3).collect(),
        })
    };
    let text = serde_json::to_string(&[once()?, once()?]);
    println!(
        "{}",
        text.map_err(|e| Error::invalid("figures", e.to_string()))?
    );
    Ok(())
}

/// Processor time of this process so far; Linux counts it in hundredths of a second (proc_pid_stat(5)).
fn cpu_ms() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    // The second field is a name in parentheses and may hold anything.
    let after = stat.rsplit(')').next().unwrap_or_default();
    let ticks = after.split_whitespace().skip(11).take(2);
    ticks.filter_map(|n| n.parse::<f64>().ok()).sum::<f64>() * 10.0
}

/// What `dicom-rs` does for the files alone, on all cores. All objects are kept until the last is decoded.
fn decode_alone(files: &[PathBuf]) -> Result<u64> {
    let decoded = files.par_iter().map(|path| {
        let damaged = |e: &dyn std::error::Error| Error::volume(path, e.to_string());
        let object = dicom_object::open_file(path).map_err(|e| damaged(&e))?;
        let pixels = object.decode_pixel_data().map_err(|e| damaged(&e))?;
        let bytes = pixels.data().len() as u64;
        drop(pixels);
        Ok((object, bytes))
    });
    let decoded: Vec<(DefaultDicomObject, u64)> = decoded.collect::<Result<_>>()?;
    Ok(decoded.iter().map(|(_, bytes)| bytes).sum())
}

fn load(folder: &Path) -> Result<u64> {
    let volume = read(folder, &ReadOptions::default())?;
    let voxels = volume.voxels();
    Ok((voxels.len() * voxels.voxel_type().bytes()) as u64)
}

/// Bytes of voxels, and when each phase ended.
fn first_picture(headless: &Headless, folder: &Path) -> Result<(u64, Vec<Instant>)> {
    let mut scene = Scene::for_volume(folder, &[])?;
    scene.image.size = [IMAGE; 2];
    scene.ambient_occlusion = None;
    let volume = read(folder, &ReadOptions::from(&scene.volume))?;
    let bytes = (volume.voxels().len() * volume.voxels().voxel_type().bytes()) as u64;
    let mut ends = vec![Instant::now()];
    let mut session = headless.load(volume.into(), &scene)?;
    ends.push(Instant::now());
    let picture = session.frame()?;
    ends.push(Instant::now());
    if picture.rgba.iter().any(|pixel| pixel[3] > 0.5) {
        return Ok((bytes, ends));
    }
    Err(Error::volume(folder, "the first picture shows nothing"))
}

fn print(figures: &Figures) {
    let voxel_bytes = figures
        .load
        .first()
        .map_or(1, |[first, _]| first.voxel_bytes) as f64;
    println!("{}", figures.device);
    println!(
        "{} files, {:.1} MiB of voxels, picture {IMAGE} x {IMAGE}; median (min–max) of {} processes",
        figures.files,
        voxel_bytes / f64::from(1 << 20),
        figures.load.len()
    );
    for (which, title) in ["first in a process", "again in that process"]
        .iter()
        .enumerate()
    {
        println!();
        println!(
            "| {title} | ms | of the floor | processor time, ms | of the floor | peak heap / voxels |"
        );
        println!("| --- | --: | --: | --: | --: | --: |");
        let of = |turns: &Turns, pick: &dyn Fn(&Sample) -> f64| -> Vec<f64> {
            let mut values: Vec<f64> = turns.iter().map(|turn| pick(&turn[which])).collect();
            values.sort_by(f64::total_cmp);
            values
        };
        let median = |values: &[f64]| values.get(values.len() / 2).copied().unwrap_or(f64::NAN);
        let floor = median(&of(&figures.floor, &|s| s.ms));
        let floor_cpu = median(&of(&figures.floor, &|s| s.cpu_ms));
        for (what, turns) in [
            ("floor: dicom-rs alone", &figures.floor),
            ("load", &figures.load),
            ("load and first picture", &figures.picture),
        ] {
            let ms = of(turns, &|s| s.ms);
            let (Some(least), Some(most)) = (ms.first(), ms.last()) else {
                continue;
            };
            let cpu = median(&of(turns, &|s| s.cpu_ms));
            let peak = median(&of(turns, &|s| s.peak_bytes as f64 / voxel_bytes));
            println!(
                "| {what} | {:.0} ({least:.0}–{most:.0}) | {:.2} | {cpu:.0} | {:.2} | {peak:.2} |",
                median(&ms),
                median(&ms) / floor,
                cpu / floor_cpu
            );
        }
        for (phase, what) in ["read", "choose and upload", "draw and read back"]
            .iter()
            .enumerate()
            .filter(|_| !figures.picture.is_empty())
        {
            let ms = of(&figures.picture, &|s| {
                s.phases_ms.get(phase).copied().unwrap_or(f64::NAN)
            });
            println!("| – of the picture: {what} | {:.0} | | | | |", median(&ms));
        }
    }
}
