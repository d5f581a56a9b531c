//! From a DICOM series on disk to the first picture, beside what reading and decoding its files takes:
//! `cargo bench --bench loading`.
//!
//! The floor is `dicom-rs` alone: every file read, its pixels decoded, the objects kept, on all cores. Floor, load
//! and first picture are measured in turn, in one process, with the files in the page cache. Options go after `--`:
//!
//! - `--series PATH` is a folder or an archive, `.tar.xz` say, which is unpacked first. Default: the largest of the
//!   larger volumes, `../shared/data/ct_chest_lidc0314_dicom.tar.xz`;
//! - `--json PATH` also writes the figures there;
//! - `--repeats N` (default 5), after one that is not counted;
//! - `--no-picture` leaves the first picture out, which on a CPU takes far longer than the rest.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use dicom_object::DefaultDicomObject;
use dicom_pixeldata::PixelDecoder as _;
use peak_alloc::PeakAlloc;
use rayon::prelude::*;
use serde::Serialize;
use tempfile::TempDir;
use umbravox::headless::{Headless, Options};
use umbravox::io::{ReadOptions, read};
use umbravox::scene::Scene;
use umbravox::volume::Volume;
use umbravox::{Error, Result, output};

#[global_allocator]
static ALLOCATOR: PeakAlloc = PeakAlloc;

const SERIES: &str = "../shared/data/ct_chest_lidc0314_dicom.tar.xz";
/// Edge of the picture, pixels.
const IMAGE: u32 = 512;

struct Request {
    series: PathBuf,
    json: Option<PathBuf>,
    repeats: u32,
    picture: bool,
}

/// Milliseconds, and host memory in multiples of the voxels' bytes.
#[derive(Serialize)]
struct Figures {
    size: [u32; 3],
    voxel_bytes: u64,
    files: usize,
    floor_ms: Vec<f64>,
    load_ms: Vec<f64>,
    /// Load, everything that depends on the volume, and a first picture without light.
    picture_ms: Vec<f64>,
    load_peak: f64,
    picture_peak: f64,
    /// Processor time of floor and load, all threads, mean of the repeats: what other work on the machine does not change.
    /// Counted in hundredths of a second; 0 where the system does not tell it.
    floor_cpu_ms: f64,
    load_cpu_ms: f64,
}

fn main() -> ExitCode {
    let done = request().and_then(|request| match request {
        Some(request) => run(&request),
        None => Ok(()),
    });
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

/// `None` where there is nothing to measure.
fn request() -> Result<Option<Request>> {
    let mut request = Request {
        series: Path::new(env!("CARGO_MANIFEST_DIR")).join(SERIES),
        json: None,
        repeats: 5,
        picture: true,
    };
    let mut args = std::env::args().skip(1);
    let mut measured = false;
    while let Some(arg) = args.next() {
        let mut value = || {
            args.next()
                .ok_or_else(|| Error::invalid(arg.as_str(), "give a value after it"))
        };
        match arg.as_str() {
            "--bench" => measured = true, // from `cargo bench`
            "--test" => measured = false,
            "--no-picture" => request.picture = false,
            "--series" => request.series = value()?.into(),
            "--json" => request.json = Some(value()?.into()),
            "--repeats" => {
                let text = value()?;
                request.repeats = text
                    .parse()
                    .ok()
                    .filter(|n| (1..=100).contains(n))
                    .ok_or_else(|| {
                        Error::invalid(
                            "--repeats",
                            format!("{text:?} is not a number from 1 to 100"),
                        )
                    })?;
            }
            _ => {
                return Err(Error::invalid(
                    arg,
                    "give --series PATH, --json PATH, --repeats N or --no-picture",
                ));
            }
        }
    }
    if !request.series.exists() {
        println!(
            "nothing is measured: {} is not there; --series names another",
            request.series.display()
        );
        return Ok(None);
    }
    Ok(measured.then_some(request))
}

fn run(request: &Request) -> Result<()> {
    let scratch = TempDir::new_in(env!("CARGO_TARGET_TMPDIR"))
        .map_err(|e| Error::io(env!("CARGO_TARGET_TMPDIR"), e))?;
    let folder = if request.series.is_dir() {
        request.series.clone()
    } else {
        unpack(&request.series, scratch.path())?;
        scratch.path().to_owned()
    };
    let mut files = Vec::new();
    files_below(&folder, &mut files)?;
    let headless = Headless::new(&Options::default())?;
    let mut figures = measure(&headless, &folder, &files, request)?;
    print(&headless, &mut figures);
    let Some(path) = &request.json else {
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

fn files_below(folder: &Path, files: &mut Vec<PathBuf>) -> Result<()> {
    let io = |e| Error::io(folder, e);
    for entry in std::fs::read_dir(folder).map_err(io)? {
        let path = entry.map_err(io)?.path();
        if path.is_dir() {
            files_below(&path, files)?;
        } else {
            files.push(path);
        }
    }
    Ok(())
}

fn measure(
    headless: &Headless,
    folder: &Path,
    files: &[PathBuf],
    request: &Request,
) -> Result<Figures> {
    let mut figures = Figures {
        size: [0; 3],
        voxel_bytes: 0,
        files: files.len(),
        floor_ms: Vec::new(),
        load_ms: Vec::new(),
        picture_ms: Vec::new(),
        load_peak: 0.0,
        picture_peak: 0.0,
        floor_cpu_ms: 0.0,
        load_cpu_ms: 0.0,
    };
    for repeat in 0..=request.repeats {
        let (start, cpu) = (Instant::now(), cpu_ms());
        let decoded = decode_alone(files)?;
        let (floor, floor_cpu) = (elapsed_ms(start), cpu_ms() - cpu);
        let decoded: u64 = decoded.into_iter().map(|(_, bytes)| bytes).sum();

        let (held, start, cpu) = (ALLOCATOR.current_usage(), Instant::now(), cpu_ms());
        ALLOCATOR.reset_peak_usage();
        let volume = read(folder, &ReadOptions::default())?;
        let (load, load_cpu) = (elapsed_ms(start), cpu_ms() - cpu);
        let load_peak = ALLOCATOR.peak_usage() - held;
        note_size(&mut figures, &volume);
        assert!(
            decoded as u64 >= figures.voxel_bytes,
            "all files were decoded"
        );
        drop(volume);

        let (held, start) = (ALLOCATOR.current_usage(), Instant::now());
        ALLOCATOR.reset_peak_usage();
        if request.picture {
            first_picture(headless, folder)?;
        }
        let picture = elapsed_ms(start);
        let picture_peak = ALLOCATOR.peak_usage() - held;
        if repeat == 0 {
            continue; // the page cache is filled, pipelines are built
        }
        figures.floor_ms.push(floor);
        figures.floor_cpu_ms += floor_cpu / f64::from(request.repeats);
        figures.load_cpu_ms += load_cpu / f64::from(request.repeats);
        figures.load_ms.push(load);
        if request.picture {
            figures.picture_ms.push(picture);
        }
        let voxels = |bytes: usize| bytes as f64 / figures.voxel_bytes as f64;
        figures.load_peak = figures.load_peak.max(voxels(load_peak));
        figures.picture_peak = figures.picture_peak.max(voxels(picture_peak));
    }
    Ok(figures)
}

fn elapsed_ms(start: Instant) -> f64 {
    start.elapsed().as_secs_f64() * 1e3
}

/// Processor time of this process so far; Linux counts it in hundredths of a second (proc_pid_stat(5)).
fn cpu_ms() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    // The second field is a name in parentheses and may hold anything.
    let after = stat.rsplit(')').next().unwrap_or_default();
    let ticks = after.split_whitespace().skip(11).take(2);
    ticks.filter_map(|n| n.parse::<f64>().ok()).sum::<f64>() * 10.0
}

fn note_size(figures: &mut Figures, volume: &Volume) {
    let voxels = volume.voxels();
    figures.size = volume.size();
    figures.voxel_bytes = (voxels.len() * voxels.voxel_type().bytes()) as u64;
}

/// What `dicom-rs` takes for the files alone, on all cores: each object, and how many bytes its pixels decode to.
fn decode_alone(files: &[PathBuf]) -> Result<Vec<(DefaultDicomObject, u64)>> {
    let decoded = files.par_iter().map(|path| {
        let damaged = |e: &dyn std::error::Error| Error::volume(path, e.to_string());
        let object = dicom_object::open_file(path).map_err(|e| damaged(&e))?;
        let bytes = object
            .decode_pixel_data()
            .map_err(|e| damaged(&e))?
            .data()
            .len();
        Ok((object, bytes as u64))
    });
    decoded.collect()
}

fn first_picture(headless: &Headless, folder: &Path) -> Result<()> {
    let mut scene = Scene::for_volume(folder, &[])?;
    scene.image.size = [IMAGE; 2];
    scene.ambient_occlusion = None;
    let volume = read(folder, &ReadOptions::from(&scene.volume))?;
    let picture = headless.load(volume.into(), &scene)?.frame()?;
    let seen = picture.rgba.iter().any(|pixel| pixel[3] > 0.5);
    if seen {
        return Ok(());
    }
    Err(Error::volume(folder, "the first picture shows nothing"))
}

fn print(headless: &Headless, figures: &mut Figures) {
    let median = |values: &[f64]| {
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        sorted.get(sorted.len() / 2).copied().unwrap_or(f64::NAN)
    };
    let device = headless.device();
    let [x, y, z] = figures.size;
    println!("{} ({})", device.name, device.driver);
    println!(
        "{x} x {y} x {z} in {} files, {:.1} MiB of voxels, picture {IMAGE} x {IMAGE}, median (min–max) of {}",
        figures.files,
        figures.voxel_bytes as f64 / f64::from(1 << 20),
        figures.load_ms.len()
    );
    println!();
    println!("| | ms | of the floor | peak host memory / voxels |");
    println!("| --- | --: | --: | --: |");
    let floor = median(&figures.floor_ms);
    for (what, times, peak) in [
        ("floor: dicom-rs alone", &figures.floor_ms, None),
        ("load", &figures.load_ms, Some(figures.load_peak)),
        (
            "load and first picture",
            &figures.picture_ms,
            Some(figures.picture_peak),
        ),
    ] {
        if times.is_empty() {
            continue;
        }
        let [least, most] = [f64::min as fn(f64, f64) -> f64, f64::max]
            .map(|pick| times.iter().copied().reduce(pick).unwrap_or(f64::NAN));
        println!(
            "| {what} | {:.0} ({least:.0}–{most:.0}) | {:.2} | {} |",
            median(times),
            median(times) / floor,
            peak.map(|p| format!("{p:.2}")).unwrap_or_default()
        );
    }
    println!();
    println!(
        "processor time: floor {:.0} ms, load {:.0} ms, {:.2} of the floor",
        figures.floor_cpu_ms,
        figures.load_cpu_ms,
        figures.load_cpu_ms / figures.floor_cpu_ms
    );
}
