//! Times of every pass on fixed scenes, beside what the device can do: `cargo bench`.
//!
//! Each picture is measured in turn with a bare march: the same rays with one texture fetch and one look-up of the
//! transfer function a sample, without levels of detail, skipping or early termination. Its samples per second are
//! the device's limit. Options go after `--`:
//!
//! - `--json PATH` also writes every figure there;
//! - `--only NAME` measures the fields whose name holds `NAME`.
//!
//! `UMBRAVOX_BENCH_SIZE` sets the edge of the procedural volumes, voxels (default 128); `UMBRAVOX_BENCH_IMAGE` that of
//! the pictures, pixels (default twice as many).

mod fields;
mod measure;
mod report;

use std::process::ExitCode;

use measure::Plan;
use umbravox::headless::{Headless, Options};
use umbravox::{Error, Result};

/// What the command line and the environment ask for.
struct Request {
    json: Option<String>,
    only: String,
    plan: Plan,
}

fn main() -> ExitCode {
    match request().and_then(|request| run(&request)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn request() -> Result<Request> {
    let mut request = Request {
        json: None,
        only: String::new(),
        plan: Plan::smoke(),
    };
    let mut args = std::env::args().skip(1);
    let mut measured = false;
    while let Some(arg) = args.next() {
        match arg.as_str() {
            "--bench" => measured = true, // from `cargo bench`
            "--test" => measured = false,
            "--json" => request.json = args.next(),
            "--only" => request.only = args.next().unwrap_or_default(),
            other => return Err(Error::invalid(other, "give --json PATH or --only NAME")),
        }
    }
    if measured {
        let size = from_environment("UMBRAVOX_BENCH_SIZE", 128)?;
        let image = from_environment("UMBRAVOX_BENCH_IMAGE", 2 * size)?;
        request.plan = Plan::full(size, image);
    }
    Ok(request)
}

fn from_environment(name: &str, default: u32) -> Result<u32> {
    let Ok(text) = std::env::var(name) else {
        return Ok(default);
    };
    let value = text.parse().ok().filter(|n| (16..=2048).contains(n));
    value.ok_or_else(|| Error::invalid(name, format!("{text:?} is not a number from 16 to 2048")))
}

fn run(request: &Request) -> Result<()> {
    let headless = Headless::new(&Options::default())?;
    let mut results = Vec::new();
    for field in fields::all(request.plan.size)? {
        if field.name.contains(&request.only) {
            eprintln!("{}: {}", field.name, field.about);
            results.push(measure::field(&headless, &field, &request.plan)?);
        }
    }
    let device = headless.device();
    report::print(&device, &request.plan, &results);
    match &request.json {
        Some(path) => report::write_json(path.as_ref(), &device, &request.plan, &results),
        None => Ok(()),
    }
}
