//! What the header of a DICOM object says of each of its frames.

use std::path::Path;

use dicom_object::mem::InMemDicomObject;
use dicom_object::{DefaultDicomObject, OpenFileOptions, Tag};
use glam::DVec3;

use super::super::Limits;
use super::super::bundle::Member;
use super::super::source::bad;
use super::attributes::{Attributes, directions};
use super::claims::{self, NativePixels, Until};
use super::prefix::Start;
use super::quoted;
use crate::error::Result;
use crate::volume::Rescale;

/// Most frames of one object.
const MAX_FRAMES: u64 = 1 << 20;

pub(super) const PIXEL_DATA: Tag = Tag(0x7FE0, 0x0010);
const SERIES_INSTANCE_UID: Tag = Tag(0x0020, 0x000E);
const SERIES_NUMBER: Tag = Tag(0x0020, 0x0011);
const MODALITY: Tag = Tag(0x0008, 0x0060);
const SERIES_DESCRIPTION: Tag = Tag(0x0008, 0x103E);
const SOP_INSTANCE_UID: Tag = Tag(0x0008, 0x0018);
const INSTANCE_NUMBER: Tag = Tag(0x0020, 0x0013);
const TEMPORAL_POSITION: Tag = Tag(0x0020, 0x0100);
const ACQUISITION_NUMBER: Tag = Tag(0x0020, 0x0012);
const ROWS: Tag = Tag(0x0028, 0x0010);
const COLUMNS: Tag = Tag(0x0028, 0x0011);
const NUMBER_OF_FRAMES: Tag = Tag(0x0028, 0x0008);
const SAMPLES_PER_PIXEL: Tag = Tag(0x0028, 0x0002);
const PLANAR_CONFIGURATION: Tag = Tag(0x0028, 0x0006);
const BITS_ALLOCATED: Tag = Tag(0x0028, 0x0100);
const BITS_STORED: Tag = Tag(0x0028, 0x0101);
const HIGH_BIT: Tag = Tag(0x0028, 0x0102);
const PIXEL_REPRESENTATION: Tag = Tag(0x0028, 0x0103);
const PHOTOMETRIC: Tag = Tag(0x0028, 0x0004);
const RESCALE_SLOPE: Tag = Tag(0x0028, 0x1053);
const RESCALE_INTERCEPT: Tag = Tag(0x0028, 0x1052);
const IMAGE_POSITION: Tag = Tag(0x0020, 0x0032);
const IMAGE_ORIENTATION: Tag = Tag(0x0020, 0x0037);
const PIXEL_SPACING: Tag = Tag(0x0028, 0x0030);
const IMAGER_PIXEL_SPACING: Tag = Tag(0x0018, 0x1164);
const SPACING_BETWEEN_SLICES: Tag = Tag(0x0018, 0x0088);
const SLICE_THICKNESS: Tag = Tag(0x0018, 0x0050);
const GRID_FRAME_OFFSETS: Tag = Tag(0x3004, 0x000C);
const SHARED_GROUPS: Tag = Tag(0x5200, 0x9229);
const PER_FRAME_GROUPS: Tag = Tag(0x5200, 0x9230);
const PLANE_POSITION: Tag = Tag(0x0020, 0x9113);
const PLANE_ORIENTATION: Tag = Tag(0x0020, 0x9116);
const PIXEL_MEASURES: Tag = Tag(0x0028, 0x9110);
const VALUE_TRANSFORMATION: Tag = Tag(0x0028, 0x9145);

/// One picture, and where it lies.
#[derive(Clone, Debug)]
pub(super) struct Frame {
    /// Which file of the bundle.
    pub(super) member: usize,
    /// Which picture of that file, from 0.
    pub(super) index: u32,
    pub(super) series_uid: String,
    pub(super) series_number: Option<String>,
    pub(super) series_description: Option<String>,
    pub(super) modality: Option<String>,
    pub(super) instance_uid: Option<String>,
    /// Orders frames of one place: time, acquisition, instance.
    pub(super) order: [f64; 3],
    pub(super) columns: u64,
    pub(super) rows: u64,
    pub(super) format: PixelFormat,
    /// Where the pixels of all frames of the file lie, when they are neither coded nor deflated.
    pub(super) native: Option<NativePixels>,
    pub(super) rescale: Rescale,
    /// Millimetres between columns and between rows, when known.
    pub(super) spacing: Option<[f64; 2]>,
    /// Millimetres between slices, for frames without a position.
    pub(super) slice_spacing: Option<f64>,
    /// Directions of increasing column and of increasing row.
    pub(super) directions: Option<[DVec3; 2]>,
    /// Centre of the first pixel.
    pub(super) position: Option<DVec3>,
}

impl Frame {
    /// Where the pixels lie, unless they are colours or to be decoded: bytes of big-endian words hold pixels of other
    /// than 16 bits in an order of their own (PS3.5, 7.3), which the parser knows.
    pub(super) fn native_pixels(&self) -> Option<NativePixels> {
        self.native.filter(|native| {
            self.format.samples == 1 && (!native.big_endian || self.format.allocated == 16)
        })
    }
}

/// How pixels are stored (PS3.5, 8.1.1).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct PixelFormat {
    pub(super) allocated: u64,
    pub(super) stored: u64,
    pub(super) high_bit: u64,
    pub(super) signed: bool,
    /// 1, or 3 of colours.
    pub(super) samples: u64,
    /// Whether uncompressed samples of one kind lie together (C.7.6.3.1.3).
    pub(super) planar: bool,
    /// Whether the first of three samples is brightness, as stored.
    pub(super) brightness_first: bool,
}

/// The frames of one file, from its header alone. Objects without pixels (reports, structure sets) have none.
pub(super) fn frames(
    path: &Path,
    member_index: usize,
    file: &Start<'_>,
    limits: &Limits,
) -> Result<Vec<Frame>> {
    let native = claims::check(path, file, Until::Pixels, limits)?;
    let object = OpenFileOptions::new()
        .read_until(PIXEL_DATA)
        .from_reader(file.stream())
        .map_err(|e| bad(path, format!("the DICOM header is damaged: {}", chain(&e))))?;
    let attributes = Attributes::of(&object);
    let (Some(rows), Some(columns)) = (attributes.whole(ROWS), attributes.whole(COLUMNS)) else {
        return Ok(Vec::new());
    };
    let format = pixel_format(path, &attributes)?;
    let count = attributes.whole(NUMBER_OF_FRAMES).unwrap_or(1);
    let in_limits = rows.saturating_mul(columns).saturating_mul(count) <= limits.max_voxels;
    if count == 0 || count > MAX_FRAMES || !in_limits {
        return Err(bad(
            path,
            format!(
                "{count} frames of {columns} x {rows} pixels; the limits are {MAX_FRAMES} frames and {} pixels",
                limits.max_voxels
            ),
        ));
    }
    // A coded frame is an item of its own: a tag and a length at least (PS3.5, A.4).
    let least = match native {
        Some(_) => [rows, columns, count, format.samples, format.allocated / 8]
            .iter()
            .fold(1u64, |n, &m| n.saturating_mul(m)),
        None => count.saturating_mul(8),
    };
    let have = native.map_or(file.member().len(), |pixels| pixels.bytes);
    if count > 1 && have < least {
        return Err(bad(
            path,
            format!(
                "{count} frames of {columns} x {rows} pixels take at least {least} bytes, {have} are there: it is cut \
                 short or its header is wrong"
            ),
        ));
    }
    let per_frame = object
        .get(PER_FRAME_GROUPS)
        .and_then(|e| e.items())
        .unwrap_or_default();
    let shared = attributes.item(SHARED_GROUPS);
    (0..count as usize)
        .map(|i| {
            let scopes: Vec<&InMemDicomObject> =
                per_frame.get(i).into_iter().chain(shared).collect();
            let scoped = Attributes {
                scopes,
                object: &object,
            };
            let frame = frame(path, member_index, i, &scoped, [columns, rows], format)?;
            Ok(Frame { native, ..frame })
        })
        .collect()
}

fn frame(
    path: &Path,
    member: usize,
    index: usize,
    attributes: &Attributes<'_>,
    [columns, rows]: [u64; 2],
    format: PixelFormat,
) -> Result<Frame> {
    let first = |tag| attributes.number(tag).unwrap_or(0.0);
    let one = |group, tag| attributes.grouped::<1>(group, tag).map(|[x]| x);
    let rescale = Rescale {
        slope: one(VALUE_TRANSFORMATION, RESCALE_SLOPE).unwrap_or(1.0),
        intercept: one(VALUE_TRANSFORMATION, RESCALE_INTERCEPT).unwrap_or(0.0),
    };
    if rescale.slope == 0.0 {
        return Err(bad(
            path,
            "RescaleSlope is 0; a number other than 0 is needed".into(),
        ));
    }
    let directions = attributes
        .grouped::<6>(PLANE_ORIENTATION, IMAGE_ORIENTATION)
        .and_then(directions);
    let spacing = attributes
        .grouped::<2>(PIXEL_MEASURES, PIXEL_SPACING)
        .or_else(|| attributes.numbers(IMAGER_PIXEL_SPACING))
        .map(|[between_rows, between_columns]| [between_columns, between_rows]);
    if let Some(spacing) = spacing
        && spacing.iter().any(|&s| s <= 0.0)
    {
        return Err(bad(
            path,
            format!("PixelSpacing {spacing:?}: numbers above 0 are needed"),
        ));
    }
    Ok(Frame {
        member,
        // The number of frames is checked to be small.
        index: index as u32,
        series_uid: attributes.text(SERIES_INSTANCE_UID).unwrap_or_default(),
        series_number: attributes.text(SERIES_NUMBER).map(|t| quoted(&t)),
        modality: attributes.text(MODALITY),
        series_description: attributes.text(SERIES_DESCRIPTION).map(|t| quoted(&t)),
        instance_uid: attributes.text(SOP_INSTANCE_UID),
        order: [
            first(TEMPORAL_POSITION),
            first(ACQUISITION_NUMBER),
            first(INSTANCE_NUMBER) + index as f64,
        ],
        columns,
        rows,
        format,
        native: None,
        rescale,
        spacing,
        slice_spacing: one(PIXEL_MEASURES, SPACING_BETWEEN_SLICES)
            .or_else(|| one(PIXEL_MEASURES, SLICE_THICKNESS))
            .filter(|&s| s > 0.0),
        position: position(attributes, index, directions),
        directions,
    })
}

/// The frame's own position, or that of the object moved along the normal by the frame's offset (RT Dose, C.8.8.3).
fn position(
    attributes: &Attributes<'_>,
    index: usize,
    directions: Option<[DVec3; 2]>,
) -> Option<DVec3> {
    let position = DVec3::from(attributes.grouped::<3>(PLANE_POSITION, IMAGE_POSITION)?);
    let Some(offsets) = attributes.object.get(GRID_FRAME_OFFSETS) else {
        return Some(position);
    };
    let offsets = offsets.to_multi_float64().ok()?;
    let [row, column] = directions?;
    let along = *offsets.get(index)? - offsets.first()?;
    Some(position + row.cross(column) * along)
}

fn pixel_format(path: &Path, attributes: &Attributes<'_>) -> Result<PixelFormat> {
    let samples = attributes.whole(SAMPLES_PER_PIXEL).unwrap_or(1);
    let photometric = attributes.text(PHOTOMETRIC).unwrap_or_default();
    if !matches!(samples, 1 | 3) {
        return Err(bad(
            path,
            format!(
                "{samples} samples per pixel ({}); 1 and 3 are read",
                quoted(&photometric)
            ),
        ));
    }
    let allocated = attributes.whole(BITS_ALLOCATED).unwrap_or(0);
    let stored = attributes.whole(BITS_STORED).unwrap_or(allocated);
    let high_bit = attributes
        .whole(HIGH_BIT)
        .unwrap_or(stored.saturating_sub(1));
    if !matches!(allocated, 8 | 16 | 32)
        || !(1..=allocated).contains(&stored)
        || high_bit >= allocated
        || high_bit + 1 < stored
    {
        return Err(bad(
            path,
            format!(
                "BitsAllocated {allocated}, BitsStored {stored}, HighBit {high_bit}: 8, 16 or 32 bits allocated, \
                 and no more stored, are read"
            ),
        ));
    }
    Ok(PixelFormat {
        allocated,
        stored,
        high_bit,
        signed: attributes.whole(PIXEL_REPRESENTATION) == Some(1),
        samples,
        planar: samples > 1 && attributes.whole(PLANAR_CONFIGURATION) == Some(1),
        brightness_first: photometric.starts_with("YBR"),
    })
}

/// Opens an object up to its pixels, them included.
pub(super) fn open(path: &Path, member: &Member, limits: &Limits) -> Result<DefaultDicomObject> {
    let Some(file) = Start::of(member) else {
        return Err(bad(path, "this is no DICOM file any more".into()));
    };
    claims::check(path, &file, Until::PixelsEnd, limits)?;
    OpenFileOptions::new()
        .read_to(PIXEL_DATA)
        .from_reader(file.stream())
        .map_err(|e| bad(path, format!("the DICOM object is damaged: {}", chain(&e))))
}

/// An error with all its causes, on one line.
pub(super) fn chain(error: &dyn std::error::Error) -> String {
    let mut text = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        text = format!("{text}: {error}");
        cause = error.source();
    }
    text
}
