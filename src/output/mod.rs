//! Pictures and light volumes to files: PNG, EXR, NRRD; plots of transfer functions and contact sheets.
//!
//! Every file appears whole or not at all: it is written beside its place under another name, then renamed.

mod atomic;
mod backdrop;
mod canvas;
mod exr;
mod nrrd;
mod plot;
mod png;
mod sheet;

use std::io::Read as _;
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
use crate::picture::Picture;
use crate::scene::Image;

pub use atomic::write_bytes;
pub use backdrop::Backdrop;
pub use nrrd::write_light;
pub use plot::{PlotHistogram, write_plot};
pub use sheet::{Frame, write_sheet};

/// Where a picture came from, as keyword and text; goes into the file's metadata.
pub type Provenance<'a> = &'a [(&'a str, String)];

/// Picture formats, chosen by extension.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Png,
    Exr,
}

/// A picture file to be, checked before anything is rendered.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Target {
    path: PathBuf,
    format: Format,
}

impl Target {
    /// Checks extension and place.
    ///
    /// # Errors
    /// [`Error::Invalid`] when the extension is neither `.png` nor `.exr`, or as [`check_place`].
    pub fn new(path: impl Into<PathBuf>) -> Result<Self> {
        let path = path.into();
        let extension = path.extension().unwrap_or_default();
        let format = if extension.eq_ignore_ascii_case("png") {
            Format::Png
        } else if extension.eq_ignore_ascii_case("exr") {
            Format::Exr
        } else {
            return Err(Error::invalid(
                path.display().to_string(),
                format!("extension {extension:?} is not a picture format; give .png or .exr"),
            ));
        };
        check_place(&path)?;
        Ok(Self { path, format })
    }

    /// Where it goes.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Composites over `image.background`, encodes and writes.
    ///
    /// # Errors
    /// [`Error::Io`] or [`Error::Encode`], or as [`Backdrop::of`]; the file is then not there (or as it was before).
    pub fn write(&self, picture: &Picture, image: &Image, provenance: Provenance) -> Result<()> {
        self.write_over(&Backdrop::of(image)?, picture, image, provenance)
    }

    /// The same over a backdrop that is at hand: of many pictures it is read once.
    ///
    /// # Errors
    /// [`Error::Io`] or [`Error::Encode`]; the file is then not there (or as it was before).
    pub fn write_over(
        &self,
        backdrop: &Backdrop,
        picture: &Picture,
        image: &Image,
        provenance: Provenance,
    ) -> Result<()> {
        match self.format {
            Format::Png => png::write(&self.path, picture, image, backdrop, provenance),
            Format::Exr => exr::write(&self.path, picture, backdrop, provenance),
        }
    }
}

/// [`Target::new`] and [`Target::write`] in one.
///
/// # Errors
/// As those two.
pub fn write(path: &Path, picture: &Picture, image: &Image, provenance: Provenance) -> Result<()> {
    Target::new(path)?.write(picture, image, provenance)
}

/// Keywords and texts that [`Target::write`] put into a picture's metadata; of other pictures, the text chunks of a PNG. No
/// pixel is decoded.
///
/// # Errors
/// [`Error::Io`] when the file cannot be read; [`Error::Invalid`] when it is neither PNG nor EXR, damaged, or an EXR
/// without such an attribute.
pub fn read_provenance(path: &Path) -> Result<Vec<(String, String)>> {
    let file = std::fs::File::open(path).map_err(|e| Error::io(path, e))?;
    let mut start = Vec::new();
    file.take(8)
        .read_to_end(&mut start)
        .map_err(|e| Error::io(path, e))?;
    let entries = if start == png::SIGNATURE {
        png::read_text(path)
    } else if start.starts_with(&exr::MAGIC) {
        exr::read_attribute(path)
    } else {
        Err("is neither PNG nor EXR; give a picture that this program wrote".into())
    };
    entries.map_err(|message| Error::invalid(path.display().to_string(), message))
}

/// Checks that a file can be put at `path`: its folder exists and takes files (one is made there and removed), and it is not a
/// folder itself.
///
/// # Errors
/// [`Error::Invalid`]; [`Error::Io`] where the folder takes none.
pub fn check_place(path: &Path) -> Result<()> {
    let at = || path.display().to_string();
    if path.is_dir() {
        return Err(Error::invalid(at(), "is a folder; give a file name"));
    }
    if path.file_name().is_none() {
        return Err(Error::invalid(at(), "is not a file name"));
    }
    let folder = folder_of(path);
    if !folder.is_dir() {
        let message = format!("there is no folder {}; create it first", folder.display());
        return Err(Error::invalid(at(), message));
    }
    atomic::check(path)
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}
