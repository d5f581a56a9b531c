//! DICOM: a series of slices, or one object of several frames.
//!
//! Format: NEMA PS3.3 (image plane C.7.6.2, pixel data C.7.6.3, multi-frame functional groups C.7.6.16) and PS3.5.
//! World space is LPS there too. Parsing and the coded transfer syntaxes are those of the `dicom-rs` crates.

mod attributes;
mod claims;
mod frame;
mod pixels;
mod prefix;
mod resample;
mod series;
mod stack;

use std::path::Path;

use rayon::prelude::*;

use self::frame::Frame;
use self::prefix::{Prefix, Start};
use self::series::Series;
use super::bundle::{Bundle, Member};
use super::element::Element;
use super::formats::{BundleReader, FileReader};
use super::grid::{self, Grid};
use super::source::bad;
use super::{Format, ReadOptions};
use crate::error::Result;
use crate::volume::{Content, Metadata, Volume};

pub(super) const FORMAT: Format = Format {
    name: "DICOM",
    extensions: &["dcm", "ima"],
    reads: "a series in a folder or archive, or one file of it; multi-frame; colours; uncompressed, deflated, RLE, JPEG, \
            JPEG 2000",
    file: Some(FileReader {
        recognise: |head, _| is_dicom(head),
        read: read_series_of,
    }),
    bundle: Some(BundleReader {
        recognise: |bundle| bundle.members().iter().any(is_dicom_member),
        read: read_bundle,
    }),
};

/// Bytes of the preamble, and the word after it (PS3.10, 7.1).
const PREAMBLE: (usize, &[u8]) = (128, b"DICM");
/// Files that only index others (PS3.10, 8.6).
const DIRECTORY_NAME: &str = "DICOMDIR";

fn is_dicom(head: &[u8]) -> bool {
    Prefix::of(head).is_some()
}

fn is_dicom_member(member: &Member) -> bool {
    start_of(member).is_some()
}

/// Of files that hold objects; not of their directory.
fn start_of(member: &Member) -> Option<Start<'_>> {
    let is_directory = member.name().rsplit('/').next() == Some(DIRECTORY_NAME);
    Start::of(member).filter(|_| !is_directory)
}

/// The series that one file belongs to, from the files beside it.
fn read_series_of(path: &Path, options: &ReadOptions<'_>) -> Result<Volume> {
    let beside = Bundle::beside(path, &options.limits)?;
    let asked = beside
        .members()
        .iter()
        .position(|member| member.file().and_then(Path::file_name) == path.file_name());
    // A file that is damaged itself is said to be, and not passed over as one of many.
    let member = asked
        .and_then(|i| beside.members().get(i))
        .ok_or_else(|| bad(path, "this file is not in the listing of its folder".into()))?;
    let start = Start::of(member).ok_or_else(|| bad(path, "this is no DICOM file".into()))?;
    let own = frame::frames(path, 0, &start, &options.limits)?;
    let Some(first) = own.first() else {
        return Err(bad(path, "this DICOM object holds no picture".into()));
    };
    let mut frames = frames_of(&beside, options)?;
    frames.retain(|frame| frame.series_uid == first.series_uid);
    let mut all = series::group(frames);
    let own_series = all
        .iter()
        .position(|series| series.frames.iter().any(|f| Some(f.member) == asked));
    match own_series {
        Some(i) => read(&beside, all.swap_remove(i), options),
        None => Err(bad(path, "this file belongs to no series".into())),
    }
}

fn read_bundle(bundle: &Bundle, options: &ReadOptions<'_>) -> Result<Volume> {
    let all = series::group(frames_of(bundle, options)?);
    let chosen = series::choose(bundle.path(), all, options)?;
    read(bundle, chosen, options)
}

/// The frames of every readable file. Damaged ones are reported and passed over, unless strict.
fn frames_of(bundle: &Bundle, options: &ReadOptions<'_>) -> Result<Vec<Frame>> {
    let (strict, limits) = (options.strict, options.limits);
    let read: Vec<Result<Vec<Frame>>> = bundle
        .members()
        .par_iter()
        .enumerate()
        .filter_map(|(i, member)| {
            let start = start_of(member)?;
            let path = bundle.path_of(member);
            Some(frame::frames(&path, i, &start, &limits))
        })
        .collect();
    let mut frames = Vec::new();
    let mut first_error = None;
    for result in read {
        match result {
            Ok(some) => frames.extend(some),
            Err(error) if strict => return Err(error),
            Err(error) => {
                tracing::warn!("passed over: {error}");
                first_error.get_or_insert(error);
            }
        }
    }
    match first_error {
        Some(error) if frames.is_empty() => Err(error),
        _ => Ok(frames),
    }
}

fn read(bundle: &Bundle, series: Series, options: &ReadOptions<'_>) -> Result<Volume> {
    let path = bundle.path();
    let stack = stack::arrange(path, series, options)?;
    let Some(first) = stack.frames.first() else {
        return Err(bad(path, "the series holds no picture".into()));
    };
    let modality = first.modality.as_deref().unwrap_or_default();
    let metadata = Metadata::stated("DICOM Modality", modality, MODALITIES).with_patient_axes(true);
    let encoding = pixels::Encoding::common(path, &stack.frames)?;
    let axes = [first.columns, first.rows, stack.frames.len() as u64];
    let grid = Grid::of_one(
        path,
        "Columns, Rows and slices",
        axes,
        encoding.element,
        &options.limits,
    )?;
    let keys = "ImageOrientationPatient, PixelSpacing and ImagePositionPatient";
    let world_from_ix = grid::placement(path, keys, stack.steps_ws, stack.origin_ws)?;
    let voxels = pixels::decode(bundle, &stack.frames, &encoding, grid, options)?;
    let Some(positions) = &stack.uneven else {
        let volume = grid::volume(path, voxels, grid, world_from_ix, encoding.rescale)?;
        return Ok(volume.with_metadata(metadata));
    };
    let (voxels, slices) =
        resample::onto_even_slices(path, voxels, grid, positions, &options.limits)?;
    let axes = [first.columns, first.rows, slices];
    let grid = Grid::of_one(
        path,
        "slices after resampling",
        axes,
        encoding.element,
        &options.limits,
    )?;
    let volume = grid::volume(path, voxels, grid, world_from_ix, encoding.rescale)?;
    Ok(volume.with_metadata(metadata))
}

/// Defined terms of `Modality` (PS3.3, C.7.3.1.1.1).
const MODALITIES: &[(&str, Content)] = &[
    ("CT", Content::Ct),
    ("MR", Content::Mr),
    ("PT", Content::Nuclear),
    ("NM", Content::Nuclear),
    ("US", Content::Ultrasound),
    ("SM", Content::Microscopy),
    ("GM", Content::Microscopy),
    ("SEG", Content::Labels),
];

/// Longest text of a file that a message quotes.
fn quoted(text: &str) -> String {
    text.chars().take(80).collect()
}
