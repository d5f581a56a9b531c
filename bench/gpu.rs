//! Times and counters of every pass on fixed scenes, beside what the device can do: `cargo bench --bench gpu`.
//!
//! Each picture is measured in turn with a bare march, and each direction of light with a bare light: as many samples,
//! each one texture read and one look-up of the transfer function, and nothing else. Their samples per second are the
//! device's limit. `docs/performance.md` says what is measured and how; `-- --help` lists the options.

mod effects;
mod export;
mod fields;
mod figures;
mod goals;
mod measure;
mod peers;
mod plan;
mod plot;
mod procedural;
mod report;
mod tables;

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Parser, value_parser};
use fields::{FIELDS, Field};
use figures::{Case, Effects, Run};
use plan::{Plan, Set};
use umbravox::Result;
use umbravox::headless::{Headless, Options};

/// Measures the renderer on fixed scenes, in turn with the limits of the device.
#[derive(Parser)]
struct Request {
    /// How much is measured.
    #[arg(long, value_enum, default_value_t)]
    set: Set,
    /// Write figures.json and report.html into this folder.
    #[arg(long, value_name = "FOLDER")]
    into: Option<PathBuf>,
    /// Take only the fields whose names hold this.
    #[arg(long, value_name = "NAME", default_value = "")]
    only: String,
    /// Measure nothing; write scenes and volumes for other renderers into this folder.
    #[arg(long, value_name = "FOLDER")]
    export: Option<PathBuf>,
    /// With --export: edge of the pictures, pixels.
    #[arg(long, value_name = "N", default_value_t = 512, value_parser = value_parser!(u32).range(16..=4096))]
    image: u32,
    /// Measure nothing; write report.html from the figures.json and peers.json of this folder.
    #[arg(long, value_name = "FOLDER")]
    report: Option<PathBuf>,
    /// With --report: put the tables into this document, between its marks.
    #[arg(long, value_name = "FILE.md", requires = "report")]
    document: Option<PathBuf>,
    /// Given by `cargo bench`; without it everything runs once, at a small size.
    #[arg(long, hide = true)]
    bench: bool,
    /// Given by `cargo test`.
    #[arg(long, hide = true)]
    test: bool,
}

fn main() -> ExitCode {
    match run(&Request::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(request: &Request) -> Result<()> {
    if let Some(folder) = &request.report {
        return report::again(folder, request.document.as_deref());
    }
    let set = if request.bench && !request.test {
        request.set
    } else {
        Set::Smoke
    };
    let plan = Plan::new(set);
    let fields = |field: &&Field| plan.takes(field) && field.name.contains(&request.only);
    let mut absent = Vec::new();
    for field in FIELDS.iter().filter(fields) {
        if let Some(path) = field.absent() {
            eprintln!(
                "NOT MEASURED: {}: {} is not there",
                field.name,
                path.display()
            );
            absent.push(field.name.to_owned());
        }
    }
    let mut fields = FIELDS
        .iter()
        .filter(fields)
        .filter(|f| f.absent().is_none());
    if let Some(folder) = &request.export {
        return fields.try_for_each(|field| export::write(field, plan.size, request.image, folder));
    }
    let measured = measure_all(&plan, fields, absent, request.only.is_empty())?;
    report::print(&measured);
    match &request.into {
        Some(folder) => report::write(folder, &measured),
        None => Ok(()),
    }
}

fn measure_all<'a>(
    plan: &Plan,
    fields: impl Iterator<Item = &'a Field>,
    absent: Vec<String>,
    effects: bool,
) -> Result<Run> {
    let headless = Headless::new(&Options::default())?;
    let device = headless.device();
    let mut run = Run {
        device: device.name,
        driver: device.driver,
        cores: std::thread::available_parallelism().map_or(1, usize::from),
        load: [load_average(), None],
        repeats: plan.repeats,
        pictures: Vec::new(),
        lights: Vec::new(),
        effects: Effects::default(),
        absent,
    };
    for field in fields {
        measure_field(&headless, plan, field, &mut run)?;
    }
    if effects {
        eprintln!("effects of single changes");
        run.effects = effects::measure(&headless, plan)?;
    }
    run.load[1] = load_average();
    Ok(run)
}

fn measure_field(headless: &Headless, plan: &Plan, field: &Field, run: &mut Run) -> Result<()> {
    eprintln!("{}: {}", field.name, field.about);
    let mut volume = field.volume(plan.size)?;
    let mut size = plan.size;
    for case in plan.cases(field) {
        if case.size != size {
            size = case.size;
            volume = field.volume(size)?;
        }
        let picture = measure::picture(headless, field, &volume, &case, plan.repeats)?;
        run.pictures.push(picture);
    }
    if field.is_computed() {
        volume = field.volume(plan.light_size)?;
    }
    if volume.voxels().len() as u64 > plan.light_voxels {
        return Ok(());
    }
    let lit = Case {
        field: field.name.to_owned(),
        size: plan.light_size,
        image: plan.image,
        step: 1.0,
        shaded: false,
        preintegrated: false,
        rays: plan.rays,
    };
    let Some(mut light) = measure::light(headless, field, &volume, &lit)? else {
        return Ok(());
    };
    let all = Case {
        rays: plan.all_rays,
        ..lit
    };
    light.growing = measure::growing(headless, field, &volume, &all)?;
    run.lights.push(light);
    Ok(())
}

/// Of the last minute; `None` where the system does not tell.
fn load_average() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/loadavg").ok()?;
    text.split_whitespace().next()?.parse().ok()
}
