//! NIfTI-1 and NIfTI-2: one file (.nii, .nii.gz), or header and image beside each other (.hdr and .img).
//!
//! Format: R. W. Cox et al., `nifti1.h` and `nifti2.h`, <https://nifti.nimh.nih.gov>. World space is RAS there
//! and becomes LPS here.

mod header;
mod placement;

use std::path::{Path, PathBuf};

use self::header::Header;
use super::components::Components;
use super::element::Element;
use super::formats::FileReader;
use super::grid::{self, Grid};
use super::payload::{Coding, Payload};
use super::source::{self, GZIP_MAGIC, Source, gunzipped_head};
use super::{Format, HEAD_BYTES, ReadOptions};
use crate::error::{Error, Result};
use crate::volume::{Content, Metadata, Rescale, Volume};

pub(super) const FORMAT: Format = Format {
    name: "NIfTI",
    extensions: &["nii", "nii.gz", "hdr", "hdr.gz", "img", "img.gz"],
    reads: "NIfTI-1 and -2, one file or a pair, plain or gzip, 3-D or 4-D; colours, complex numbers",
    file: Some(FileReader {
        recognise: |head, path| {
            header::is_header(&gunzipped_head(head, header::MAX_BYTES))
                || header_of_image(path).is_some()
        },
        read,
    }),
    bundle: None,
};

fn read(path: &Path, options: &ReadOptions<'_>) -> Result<Volume> {
    let start = source::head(path, HEAD_BYTES)?;
    let plain = gunzipped_head(&start, header::MAX_BYTES);
    if !header::is_header(&plain)
        && let Some(header) = header_of_image(path)
    {
        return read(&header, options);
    }
    let header = Header::parse(path, &plain)?;
    let (element, count) = header.element()?;
    let colour = element == Element::U8;
    let components = Components::of(path, count, element, colour, options)?;
    let grid = Grid::new(path, "dim", &header.axes()?, element, options)?;
    let world_from_ix = placement::world_from_ix(&header)?;
    let rescale = rescale(&header)?;
    let skip = header.data_offset()?;

    let source = if header.is_pair() {
        image_of_header(path)?
    } else {
        Source::open(path)?
    };
    let gzip = if header.is_pair() {
        // Image data may start with any bytes.
        ends_with(source.path(), ".gz")
    } else {
        start.starts_with(GZIP_MAGIC)
    };
    let payload = Payload {
        grid,
        element,
        endian: header.endian(),
        coding: if gzip { Coding::Gzip } else { Coding::Raw },
        skip,
        components,
    };
    let voxels = payload.decode(source, options)?;
    let volume = grid::volume(path, voxels, grid, world_from_ix, rescale)?;
    Ok(volume.with_metadata(metadata(&header)))
}

/// `intent_code` names labels (`NIFTI_INTENT_LABEL`, `NIFTI_INTENT_NEURONAME`); an echo time in `descrip`, as dcm2niix
/// writes it, is one of magnetic resonance.
fn metadata(header: &Header) -> Metadata {
    let intent = header.intent_code().to_string();
    let intents = &[("1002", Content::Labels), ("1005", Content::Labels)];
    let mut metadata = Metadata::stated("NIfTI intent_code", &intent, intents);
    if metadata.content.is_none() && header.description().starts_with("TE=") {
        metadata = Metadata::stated("NIfTI descrip", "TE=", &[("TE=", Content::Mr)]);
    }
    let (qform, sform) = header.form_codes();
    metadata.with_patient_axes(qform > 0 || sform > 0)
}

/// `scl_slope` 0, or not a number, means that there is no scaling.
fn rescale(header: &Header) -> Result<Rescale> {
    let (slope, intercept) = header.scaling();
    if slope == 0.0 || !slope.is_finite() {
        return Ok(Rescale::default());
    }
    if !intercept.is_finite() {
        return Err(header.bad(format!(
            "scl_inter is {intercept}; a finite number is needed"
        )));
    }
    Ok(Rescale { slope, intercept })
}

fn ends_with(path: &Path, ending: &str) -> bool {
    path.to_string_lossy().to_lowercase().ends_with(ending)
}

/// The same file name with another ending in place of one of `from`, in lower or upper case.
fn siblings(path: &Path, from: &[&str], to: &[&str]) -> Vec<PathBuf> {
    let Some(name) = path.file_name().and_then(|n| n.to_str()) else {
        return Vec::new();
    };
    from.iter()
        .filter_map(|ending| {
            let stem = name.get(..name.len().checked_sub(ending.len())?)?;
            name.to_lowercase().ends_with(ending).then_some(stem)
        })
        .flat_map(|stem| {
            to.iter()
                .map(move |ending| path.with_file_name(format!("{stem}{ending}")))
        })
        .collect()
}

/// The header beside an image file, if there is one.
fn header_of_image(path: &Path) -> Option<PathBuf> {
    siblings(path, &[".img", ".img.gz"], &[".hdr", ".hdr.gz"])
        .into_iter()
        .find(|header| {
            source::head(header, HEAD_BYTES)
                .is_ok_and(|head| header::is_header(&gunzipped_head(&head, header::MAX_BYTES)))
        })
}

fn image_of_header(path: &Path) -> Result<Source> {
    let candidates = siblings(path, &[".hdr", ".hdr.gz"], &[".img", ".img.gz", ".IMG"]);
    let image = candidates.iter().find(|image| image.is_file()).ok_or_else(|| {
        Error::volume(
            path,
            "the magic says that the voxels are in an .img or .img.gz file of the same name; there is none",
        )
    })?;
    Source::open(image)
}
