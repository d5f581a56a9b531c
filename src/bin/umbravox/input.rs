//! What a command works on: a scene and its volume.

use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use umbravox::headless::{Headless, Options};
use umbravox::io::{self, ReadOptions};
use umbravox::output;
use umbravox::scene::{self, FirstPicture, Guess, Override, Scene};
use umbravox::volume::Volume;
use umbravox::{Error, Result};

use crate::args::InputArgs;
use crate::progress;

/// The scene named on the command line, or the one that suits the volume named there.
pub(crate) fn read_scene(args: &InputArgs) -> Result<Scene> {
    let overrides = overrides(args)?;
    if scene::is_scene_file(&args.path)? {
        Scene::read(&args.path, &overrides)
    } else {
        Scene::for_volume(&args.path, &overrides)
    }
}

/// A scene and its volume. For a volume named on the command line the scene is one that suits it; what was reduced for
/// that is said on stderr.
pub(crate) fn load(args: &InputArgs, scene: Scene) -> Result<(Scene, Arc<Volume>)> {
    let volume = read_volume(&scene)?;
    if scene::is_scene_file(&args.path)? {
        return Ok((scene, volume));
    }
    let first = FirstPicture::of(&args.path, volume, &overrides(args)?)?;
    for notice in &first.notices {
        tracing::warn!("{notice}");
    }
    let Guess {
        modality,
        reason,
        preset,
    } = &first.guess;
    tracing::info!("taken for {modality:?} ({reason}): transfer function {preset}");
    Ok((first.scene, first.volume))
}

/// Opens the device while `read` reads what it is to draw. What is wrong with the input is said first.
pub(crate) fn beside_device<T>(
    options: &Options,
    read: impl FnOnce() -> Result<T>,
) -> Result<(Headless, T)> {
    std::thread::scope(|scope| {
        // Drivers take one core for tens of milliseconds to start.
        let device = scope.spawn(|| Headless::new(options));
        let read = read()?;
        let device = device.join();
        let device = device.unwrap_or_else(|panic| std::panic::resume_unwind(panic))?;
        Ok((device, read))
    })
}

fn overrides(args: &InputArgs) -> Result<Vec<Override>> {
    let parse = |text: &String| Override::parse(text);
    args.overrides.iter().map(parse).collect()
}

/// The volume of a scene with its labels, and a progress bar.
pub(crate) fn read_volume(scene: &Scene) -> Result<Arc<Volume>> {
    let bar = progress::reading();
    let show = |read, all| {
        bar.set_length(all);
        bar.set_position(read);
    };
    let options = ReadOptions {
        progress: Some(&show),
        ..ReadOptions::from(&scene.volume)
    };
    let volume = io::volume_of(&scene.volume, &options);
    bar.finish_and_clear();
    let labels = scene.volume.labels.as_ref();
    let labels = labels
        .map(|labels| io::read_labels(&labels.path, &ReadOptions::from(labels)).map(Arc::new))
        .transpose();
    Ok(Arc::new(volume?.with_labels(labels?)?))
}

/// Bytes of an input that are searched for the names of its data files.
const HEADER_BYTES: u64 = 64 << 10;

/// Checks that a file can be put at `output` and that nothing is read from there: not the file named on the command line, nor
/// those of its scene. Gives the output's place, the same for every way of writing it.
pub(crate) fn check_output(output: &Path, named: &Path, scene: &Scene) -> Result<PathBuf> {
    output::check_place(output)?;
    let labels = scene.volume.labels.iter().map(|labels| &labels.path);
    let files = labels.chain(&scene.transfer_function.file);
    let inputs = [named, &scene.volume.path].into_iter();
    check_no_input(output, inputs.chain(files.map(PathBuf::as_path)))?;
    let folder = match output.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let folder = folder.canonicalize().map_err(|e| Error::io(folder, e))?;
    Ok(folder.join(output.file_name().unwrap_or_default()))
}

/// Checks that nothing is read from `output`.
pub(crate) fn check_no_input<'a>(
    output: &Path,
    mut inputs: impl Iterator<Item = &'a Path>,
) -> Result<()> {
    if inputs.any(|input| is_read(input, output)) {
        return Err(Error::invalid(
            output.display().to_string(),
            "is also an input; give another file",
        ));
    }
    Ok(())
}

/// True when reading `input` may read an existing file at `output`: the file itself, one in the folder, the other half of an Analyze pair, or a data
/// file that its header names.
fn is_read(input: &Path, output: &Path) -> bool {
    let (Ok(place), Ok(input)) = (output.canonicalize(), input.canonicalize()) else {
        return false;
    };
    if input.is_dir() && place.starts_with(&input) {
        return true;
    }
    let half = |p: &Path| p.extension().is_some_and(|e| e == "hdr" || e == "img");
    if input == place
        || (half(&input) && half(&place) && input.with_extension("") == place.with_extension(""))
    {
        return true;
    }
    let (Some(name), Ok(file)) = (place.file_name(), std::fs::File::open(&input)) else {
        return false;
    };
    let mut header = Vec::new();
    let name = name.as_encoded_bytes();
    file.take(HEADER_BYTES).read_to_end(&mut header).is_ok()
        && input.parent() == place.parent()
        && header.windows(name.len()).any(|part| part == name)
}
