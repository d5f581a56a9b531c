//! What a command works on: a scene and its volume.

use std::path::Path;
use std::sync::Arc;

use umbravox::io::{self, ReadOptions};
use umbravox::output;
use umbravox::scene::{self, Override, Scene};
use umbravox::volume::Volume;
use umbravox::{Error, Result};

use crate::args::InputArgs;

/// The scene named on the command line, or the one that suits the volume named there.
pub(crate) fn read_scene(args: &InputArgs) -> Result<Scene> {
    let overrides = args
        .overrides
        .iter()
        .map(|text| Override::parse(text))
        .collect::<Result<Vec<_>>>()?;
    if scene::is_scene_file(&args.path)? {
        Scene::read(&args.path, &overrides)
    } else {
        Scene::for_volume(&args.path, &overrides)
    }
}

/// The volume of a scene.
pub(crate) fn read_volume(scene: &Scene) -> Result<Arc<Volume>> {
    io::read(&scene.volume.path, &ReadOptions::from(&scene.volume)).map(Arc::new)
}

/// Checks that a file can be put at `output` and that nothing is read from there.
pub(crate) fn check_output(output: &Path, args: &InputArgs, scene: &Scene) -> Result<()> {
    output::check_place(output)?;
    // An output that does not exist yet is no input.
    let Ok(place) = output.canonicalize() else {
        return Ok(());
    };
    let is_input = [&args.path, &scene.volume.path]
        .into_iter()
        .any(|input| input.canonicalize().is_ok_and(|input| input == place));
    if is_input {
        return Err(Error::invalid(
            output.display().to_string(),
            "is also an input; give another file",
        ));
    }
    Ok(())
}
