//! The figures of Hernell, Ljung and Ynnerman (2007) with this renderer, and those of the integrator's contract: pictures into
//! `docs/figures/`, measurements into `docs/results.md`. `make figures` runs it.
//!
//! `cargo run --release --example figures [pictures|tables] [NAME]` does one half, or the pictures whose name holds `NAME`.

mod difference;
mod ground;
mod pictures;
mod signals;
mod synthetic;
mod tables;

use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;

use umbravox::headless::{Headless, Options, Session};
use umbravox::io::{self, ReadOptions};
use umbravox::picture::Picture;
use umbravox::scene::Scene;
use umbravox::volume::Volume;
use umbravox::{Error, Result};

const FOLDER: &str = "docs/figures";
const RESULTS: &str = "docs/results.md";
/// Where `examples/synthetic.json` expects it.
const SYNTHETIC_VOLUME: &str = "out/synthetic.nrrd";

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<()> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let args: Vec<&str> = args.iter().map(String::as_str).collect();
    let (pictures, tables, only) = match args[..] {
        [] => (true, true, ""),
        ["pictures"] => (true, false, ""),
        ["pictures", name] => (true, false, name),
        ["tables"] => (false, true, ""),
        _ => {
            return Err(Error::invalid(
                args.join(" "),
                "give nothing, pictures [NAME] or tables",
            ));
        }
    };
    for folder in [FOLDER, "out"] {
        std::fs::create_dir_all(folder).map_err(|e| Error::io(folder, e))?;
    }
    let headless = Headless::new(&Options::default())?;
    if pictures {
        synthetic::write(Path::new(SYNTHETIC_VOLUME))?;
        signals::write()?;
        ground::write()?;
        pictures::render(&headless, Path::new(FOLDER), only)?;
    }
    if tables {
        tables::measure(&headless, Path::new(FOLDER), Path::new(RESULTS))?;
    }
    Ok(())
}

/// A scene's volume, and the scene on the device.
struct Loaded {
    volume: Arc<Volume>,
    session: Session,
}

fn load(headless: &Headless, scene: &Scene) -> Result<Loaded> {
    let options = ReadOptions {
        raw: scene.volume.raw.clone(),
        ..Default::default()
    };
    let volume = Arc::new(io::volume_of(&scene.volume, &options)?);
    let session = headless.load(Arc::clone(&volume), scene)?;
    Ok(Loaded { volume, session })
}

/// A picture with the light complete.
fn picture(session: &mut Session) -> Result<Picture> {
    while session.refine_light()? {}
    session.frame()
}
