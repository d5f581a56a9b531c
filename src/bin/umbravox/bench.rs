//! `umbravox bench`.

use serde::Serialize;
use umbravox::Result;
use umbravox::headless::{Headless, Stats};

use crate::args::BenchArgs;
use crate::{check_validation, input, progress, stats_of, terminal};

/// What `--json` prints.
#[derive(Serialize)]
struct Report {
    frame_ms: Spread,
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
    let (scene, volume) = input::load(&args.input, scene)?;
    let start = scene.camera.view(&volume, scene.image.size)?;
    let headless = Headless::new(&args.device.options())?;
    let mut session = headless.load(volume.clone(), &scene)?;
    progress::complete_light(&mut session)?;
    let mut frame_ms = Vec::new();
    for frame in 0..u64::from(args.warmup) + u64::from(args.frames) {
        session.set_view(start.orbited(&volume, args.orbit * frame as f64));
        let ms = session.timed_frame()?;
        if frame >= u64::from(args.warmup) {
            frame_ms.push(ms);
        }
    }
    let report = Report {
        frame_ms: spread(frame_ms),
        stats: stats_of(&mut session)?,
    };
    check_validation(&headless)?;
    if args.json {
        terminal::print_json(&report)
    } else {
        terminal::print_table(&report)
    }
}

/// Of at least one frame.
fn spread(mut frame_ms: Vec<f64>) -> Spread {
    frame_ms.sort_by(f64::total_cmp);
    let [low, high] = [(frame_ms.len() - 1) / 2, frame_ms.len() / 2];
    Spread {
        min: frame_ms[0],
        median: 0.5 * (frame_ms[low] + frame_ms[high]),
        max: frame_ms[frame_ms.len() - 1],
    }
}
