//! The `umbravox` program.

mod args;
mod bench;
mod conformance;
mod devices;
mod formats;
mod info;
mod input;
mod light;
mod probe;
mod progress;
mod render;
mod series;
mod terminal;
mod tf;

use std::alloc::System;
use std::process::ExitCode;

use peakmem_alloc::{PeakMemAlloc, PeakMemAllocTrait as _};

use args::Command;

/// Counts host memory, for `memory.host_peak_bytes` of the statistics.
#[global_allocator]
static ALLOCATOR: PeakMemAlloc<System> = PeakMemAlloc::new(System);

fn main() -> ExitCode {
    let cli = match args::parse() {
        Ok(cli) => cli,
        Err(status) => return status,
    };
    terminal::log_to_stderr(cli.verbose);
    let result = match &cli.command {
        Command::Conformance(args) => match conformance::run(args) {
            Ok(true) => Ok(()),
            Ok(false) => return terminal::failed(),
            Err(error) => Err(error),
        },
        Command::Render(args) => render::run(args),
        Command::Info(args) => info::run(args),
        Command::Probe(args) => probe::run(args),
        Command::Formats(args) => formats::run(args),
        Command::Tf(command) => tf::run(command),
        Command::Light(args) => light::run(args),
        Command::Bench(args) => bench::run(args),
        Command::Devices(args) => devices::run(args),
        Command::Schema => terminal::print_json(&umbravox::scene::schema()),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => terminal::report(&error),
    }
}

/// Statistics of a session, with what only the program knows.
fn stats_of(
    session: &mut umbravox::headless::Session,
) -> umbravox::Result<umbravox::headless::Stats> {
    let mut stats = session.stats()?;
    stats.memory.host_peak_bytes = ALLOCATOR.get_peak_memory() as u64;
    Ok(stats)
}

/// Fails when the validation layer (`--validation`) had anything to say.
fn check_validation(headless: &umbravox::headless::Headless) -> umbravox::Result<()> {
    match headless.validation_messages().as_slice() {
        [] => Ok(()),
        messages => Err(umbravox::Error::Validation(messages.join("\n"))),
    }
}
