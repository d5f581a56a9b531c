//! Every volume of some folders as `umbravox render VOLUME` draws it: a contact sheet, `docs/gallery.png`, and the list
//! `docs/gallery.md`. `make gallery` runs it.
//!
//! `cargo run --release --example gallery [FOLDER]…`; without folders `data/`, and `../shared/data` where there is one
//! (larger volumes, which do not come with the repository). `UMBRAVOX_GALLERY_SIZE` is the edge of a picture, pixels.

mod list;

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Instant;

use umbravox::headless::{Headless, Options};
use umbravox::io::{self, ReadOptions};
use umbravox::output::{self, Frame};
use umbravox::scene::{FirstPicture, Override};
use umbravox::{Error, Result};

use list::Entry;

const SHEET: &str = "docs/gallery.png";
const LIST: &str = "docs/gallery.md";
const FOLDERS: [&str; 2] = ["data", "../shared/data"];
const COLUMNS: u32 = 5;
const DEFAULT_SIZE: u32 = 256;

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
    let given: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let folders = if given.is_empty() {
        let present = FOLDERS.iter().map(PathBuf::from).filter(|f| f.is_dir());
        present.collect()
    } else {
        given
    };
    let size = match std::env::var("UMBRAVOX_GALLERY_SIZE") {
        Ok(text) => text.parse().map_err(|_| {
            Error::invalid(
                "UMBRAVOX_GALLERY_SIZE",
                format!("{text:?} is not a number of pixels"),
            )
        })?,
        Err(_) => DEFAULT_SIZE,
    };
    let headless = Headless::new(&Options::default())?;
    let mut frames = Vec::new();
    let mut entries = Vec::new();
    for path in list::volumes(&folders)? {
        let drawn = draw(&headless, &path, size);
        match drawn {
            Ok((frame, entry)) => {
                eprintln!("{}: {}, {:.1} s", entry.file, entry.modality, entry.seconds);
                frames.push(frame);
                entries.push(Ok(entry));
            }
            Err(error) if error.is_bad_input() => {
                eprintln!("not drawn: {error}");
                let reason = error.to_string();
                let file = format!("{}: ", path.display());
                let reason = reason.strip_prefix(&file).unwrap_or(&reason).to_owned();
                entries.push(Err((list::name_of(&path), reason)));
            }
            Err(error) => return Err(error),
        }
    }
    output::write_sheet(Path::new(SHEET), &frames, COLUMNS)?;
    let text = list::markdown(&entries, &headless.device());
    output::write_bytes(Path::new(LIST), text.as_bytes())
}

/// A volume as the program draws it without a scene, but for the size.
fn draw(headless: &Headless, path: &Path, size: u32) -> Result<(Frame, Entry)> {
    let start = Instant::now();
    let volume = Arc::new(io::read(path, &ReadOptions::default())?);
    let read = start.elapsed();
    let size = Override::parse(&format!("image.size=[{size},{size}]"))?;
    let voxels = volume.size();
    let first = FirstPicture::of(path, volume, &[size])?;
    let mut session = headless.load(first.volume, &first.scene)?;
    while session.refine_light()? {}
    let picture = session.frame()?;
    let entry = Entry {
        file: list::name_of(path),
        voxels,
        modality: format!("{:?}", first.guess.modality),
        reason: first.guess.reason,
        preset: first.guess.preset,
        read_seconds: read.as_secs_f64(),
        seconds: start.elapsed().as_secs_f64(),
        notices: first.notices,
    };
    let frame = Frame {
        picture,
        image: first.scene.image,
        caption: entry.caption(),
    };
    Ok((frame, entry))
}
