//! `umbravox bench`.

use std::io::BufRead as _;

use serde::Serialize;
use umbravox::headless::{FrameTime, Session, Stats};
use umbravox::{Error, Result};

use crate::args::BenchArgs;
use crate::{check_validation, input, progress, stats_of, terminal};

/// What `--json` prints.
#[derive(Serialize)]
struct Report {
    frame_ms: Spread,
    /// Processor time of the program, all threads.
    #[serde(skip_serializing_if = "Option::is_none")]
    cpu_ms: Option<Spread>,
    stats: Stats,
}

#[derive(Serialize)]
struct Spread {
    min: f64,
    median: f64,
    max: f64,
}

pub(crate) fn run(args: &BenchArgs) -> Result<()> {
    let scene = input::read_scene(&args.input)?;
    let (headless, (scene, volume)) =
        input::beside_device(&args.device.options(), || input::load(&args.input, scene))?;
    let start = scene.camera.view(&volume, scene.image.size)?;
    let mut session = headless.load(volume.clone(), &scene)?;
    progress::complete_light(&mut session)?;
    let mut number = 0u64;
    let mut next = || -> Result<FrameTime> {
        session.set_view(start.orbited(&volume, args.orbit * number as f64));
        number += 1;
        session.timed_frame()
    };
    for _ in 0..args.warmup {
        next()?;
    }
    let times = if args.paced {
        paced(next)?
    } else {
        (0..args.frames).map(|_| next()).collect::<Result<_>>()?
    };
    let report = report(&mut session, &times)?;
    check_validation(&headless)?;
    if args.json {
        terminal::print_json(&report)
    } else {
        terminal::print_table(&report)
    }
}

/// A frame for each line on stdin, its times printed before the next line is read.
fn paced(mut next: impl FnMut() -> Result<FrameTime>) -> Result<Vec<FrameTime>> {
    let mut times = Vec::new();
    for line in std::io::stdin().lock().lines() {
        line.map_err(|e| Error::io("standard input", e))?;
        let time = next()?;
        let json = serde_json::to_string(&time).map_err(|e| Error::Encode {
            path: "standard output".into(),
            message: e.to_string(),
        })?;
        terminal::print(&(json + "\n"))?;
        times.push(time);
    }
    if times.is_empty() {
        return Err(Error::invalid(
            "--paced",
            "standard input has no line; give one for each frame",
        ));
    }
    Ok(times)
}

/// Of at least one frame.
fn report(session: &mut Session, times: &[FrameTime]) -> Result<Report> {
    let cpu_ms: Option<Vec<f64>> = times.iter().map(|time| time.cpu_ms).collect();
    Ok(Report {
        frame_ms: spread(times.iter().map(|time| time.wall_ms).collect()),
        cpu_ms: cpu_ms.map(spread),
        stats: stats_of(session)?,
    })
}

/// Of at least one time.
fn spread(mut times_ms: Vec<f64>) -> Spread {
    times_ms.sort_by(f64::total_cmp);
    let [low, high] = [(times_ms.len() - 1) / 2, times_ms.len() / 2];
    Spread {
        min: times_ms[0],
        median: 0.5 * (times_ms[low] + times_ms[high]),
        max: times_ms[times_ms.len() - 1],
    }
}
