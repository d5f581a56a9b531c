//! `umbravox info`.

use serde::Serialize;
use umbravox::Result;
use umbravox::scene::Guess;
use umbravox::volume::Summary;

use crate::args::InfoArgs;
use crate::{input, terminal};

pub(crate) fn run(args: &InfoArgs) -> Result<()> {
    let scene = input::read_scene(&args.input)?;
    let volume = input::read_volume(&scene)?;
    let info = Info {
        summary: Summary::of(&volume),
        content: Guess::of(&volume),
    };
    if args.json {
        terminal::print_json(&info)
    } else {
        terminal::print_table(&info)
    }
}

/// What is printed.
#[derive(Serialize)]
struct Info {
    #[serde(flatten)]
    summary: Summary,
    /// What a picture without a scene takes it for.
    content: Guess,
}
