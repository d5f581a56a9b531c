//! `umbravox light`.

use umbravox::{Error, Result, output};

use crate::args::LightArgs;
use crate::{check_validation, input, progress};

pub(crate) fn run(args: &LightArgs) -> Result<()> {
    let extension = args.output.extension().unwrap_or_default();
    if !extension.eq_ignore_ascii_case("nrrd") {
        return Err(Error::invalid(
            args.output.display().to_string(),
            format!("extension {extension:?} is not a light volume format; give .nrrd"),
        ));
    }
    output::check_place(&args.output)?;
    let scene = input::read_scene(&args.input)?;
    if scene.ambient_occlusion.is_none() {
        return Err(Error::invalid(
            "ambient_occlusion",
            "is off, so there is no light volume; turn it on, as with --set ambient_occlusion.rays=32",
        ));
    }
    input::check_output(&args.output, &args.input.path, &scene)?;
    let (headless, (scene, volume)) =
        input::beside_device(&args.device.options(), || input::load(&args.input, scene))?;
    let world_from_ix = volume.world_from_ix();
    let mut session = headless.load(volume, &scene)?;
    progress::complete_light(&mut session)?;
    let light = session.light_volume()?;
    check_validation(&headless)?;
    output::write_light(&args.output, light.size, &light.rgba, world_from_ix)
}
