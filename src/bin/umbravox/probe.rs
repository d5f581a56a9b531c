//! `umbravox probe`.

use serde::Serialize;
use umbravox::headless::PixelProbe;
use umbravox::{Error, Result};

use crate::args::ProbeArgs;
use crate::{check_validation, input, progress, terminal};

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
    match (args.world, args.pixel) {
        (_, Some(pixel)) => print(args, &at_pixel(args, pixel)?),
        (Some(world), None) => print(args, &at_point(args, world)?),
        (None, None) => Err(Error::invalid("probe", "give --world X,Y,Z or --pixel X,Y")),
    }
}

fn print(args: &ProbeArgs, probe: &impl Serialize) -> Result<()> {
    if args.json {
        terminal::print_json(probe)
    } else {
        terminal::print_table(probe)
    }
}

fn at_pixel(args: &ProbeArgs, pixel: [u32; 2]) -> Result<PixelProbe> {
    let scene = input::read_scene(&args.input)?;
    let (headless, (scene, volume)) =
        input::beside_device(&args.device.options(), || input::load(&args.input, scene))?;
    let mut session = headless.load(volume, &scene)?;
    progress::complete_light(&mut session)?;
    let probe = session.probe_pixel(pixel)?;
    check_validation(&headless)?;
    Ok(probe)
}

fn at_point(args: &ProbeArgs, world: [f64; 3]) -> Result<Probe> {
    let scene = input::read_scene(&args.input)?;
    let volume = input::read_volume(&scene)?;
    let world_ws = world.into();
    let voxel = volume.world_from_ix().inverse().transform_point3(world_ws);
    let Some(value) = volume.sample(voxel) else {
        let last = volume.size().map(|n| n - 1);
        return Err(Error::invalid(
            "--world",
            format!(
                "{world_ws} mm is voxel {voxel}, outside of the field; it goes from voxel [0, 0, 0] to {last:?}"
            ),
        ));
    };
    Ok(Probe {
        world,
        voxel: voxel.to_array(),
        value,
    })
}
