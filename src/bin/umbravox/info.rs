//! `umbravox info`.

use umbravox::Result;
use umbravox::volume::Summary;

use crate::args::InfoArgs;
use crate::{input, terminal};

pub(crate) fn run(args: &InfoArgs) -> Result<()> {
    let scene = input::read_scene(&args.input)?;
    let volume = input::read_volume(&scene)?;
    let summary = Summary::of(&volume);
    if args.json {
        terminal::print_json(&summary)
    } else {
        terminal::print_table(&summary)
    }
}
