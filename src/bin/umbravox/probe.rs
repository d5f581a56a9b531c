//! `umbravox probe`.

use serde::Serialize;
use umbravox::{Error, Result};

use crate::args::ProbeArgs;
use crate::{input, terminal};

/// What the field is at a point.
#[derive(Serialize)]
struct Probe {
    /// Millimetres, LPS.
    world: [f64; 3],
    /// Continuous voxel index.
    voxel: [f64; 3],
    /// Trilinear, in the file's own units.
    value: f64,
}

pub(crate) fn run(args: &ProbeArgs) -> Result<()> {
    let scene = input::read_scene(&args.input)?;
    let volume = input::read_volume(&scene)?;
    let world = args.world.into();
    let voxel = volume.world_from_ix().inverse().transform_point3(world);
    let Some(value) = volume.sample(voxel) else {
        let last = volume.size().map(|n| n - 1);
        return Err(Error::invalid(
            "--world",
            format!(
                "{world} mm is voxel {voxel}, outside of the field; it goes from voxel [0, 0, 0] to {last:?}"
            ),
        ));
    };
    let probe = Probe {
        world: args.world,
        voxel: voxel.to_array(),
        value,
    };
    if args.json {
        terminal::print_json(&probe)
    } else {
        terminal::print_table(&probe)
    }
}
