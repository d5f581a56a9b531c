//! VTK image data in XML (.vti).
//!
//! Format: Kitware, *VTK File Formats*, XML. One piece; inline (ascii, base64) and appended (raw, base64) arrays, plain
//! or with `vtkZLibDataCompressor`. World space is taken as LPS millimetres.

mod data;
mod markup;

use std::path::Path;

use glam::DVec3;

use self::markup::Element as Tag;
use super::components::Components;
use super::element::Element;
use super::formats::FileReader;
use super::grid::{self, Grid};
use super::payload::Payload;
use super::source::{Source, bad};
use super::{Format, ReadOptions, bundle, text};
use crate::error::Result;
use crate::scene::Endian;
use crate::volume::{Rescale, Volume};

pub(super) const FORMAT: Format = Format {
    name: "VTK image data",
    extensions: &["vti"],
    reads: "one piece, point or cell scalars; ascii, base64 or raw, plain or zlib",
    file: Some(FileReader {
        recognise: |head, _| {
            let text = String::from_utf8_lossy(head);
            text.contains("<VTKFile") && text.contains("ImageData")
        },
        read,
    }),
    bundle: None,
};

const TYPES: &[(&str, Element)] = &[
    ("UInt8", Element::U8),
    ("Int8", Element::I8),
    ("UInt16", Element::U16),
    ("Int16", Element::I16),
    ("UInt32", Element::U32),
    ("Int32", Element::I32),
    ("UInt64", Element::U64),
    ("Int64", Element::I64),
    ("Float32", Element::F32),
    ("Float64", Element::F64),
];

/// The text before appended data starts with this; the data follow its underscore.
const APPENDED: &[u8] = b"<AppendedData";

fn read(path: &Path, options: &ReadOptions<'_>) -> Result<Volume> {
    let bytes = bundle::whole_file(path, &options.limits)?;
    let split = find(&bytes, APPENDED).unwrap_or(bytes.len());
    let (head, appended) = bytes.split_at_checked(split).unwrap_or((&bytes, &[]));
    let head = String::from_utf8_lossy(head);
    let missing = |what: &str| bad(path, format!("{what} is missing"));
    let file = markup::first(&head, "VTKFile").ok_or_else(|| missing("VTKFile"))?;
    let image = markup::first(&head, "ImageData").ok_or_else(|| missing("ImageData"))?;
    if markup::all(&head, "Piece").count() > 1 {
        return Err(bad(path, "several pieces are not read; one is".into()));
    }
    let (array, on_cells) = scalars(path, &head)?;
    let components = array.attribute("NumberOfComponents").unwrap_or("1");
    let components = text::number(path, "NumberOfComponents", components)?;
    let kind = array
        .attribute("type")
        .ok_or_else(|| missing("type of the DataArray"))?;
    let element = text::one_of(path, "type", kind, TYPES)?;
    // Bytes of three or four components are what VTK draws as colours. 0 is written of arrays that nothing was said about.
    let count = u64::max(components, 1);
    let colour = element == Element::U8 && matches!(count, 3 | 4);
    let components = Components::of(path, count, element, colour, options)?;

    let extent = image
        .attribute("WholeExtent")
        .ok_or_else(|| missing("WholeExtent"))?;
    let extent: Vec<i64> = text::numbers(path, "WholeExtent", extent, "a whole number")?;
    let &[x0, x1, y0, y1, z0, z1] = extent.as_slice() else {
        return Err(bad(
            path,
            format!("WholeExtent {extent:?}: 6 numbers are needed"),
        ));
    };
    // Between n + 1 points lie n cells.
    let points = if on_cells { 0 } else { 1 };
    let axes = [(x0, x1), (y0, y1), (z0, z1)].map(|(first, last)| {
        let count = last.saturating_sub(first).saturating_add(points);
        u64::try_from(count).unwrap_or(0)
    });
    let grid = Grid::of_one(path, "WholeExtent", axes, element, &options.limits)?;
    let first = DVec3::new(x0 as f64, y0 as f64, z0 as f64) + if on_cells { 0.5 } else { 0.0 };
    let world_from_ix = placement(path, &image, first)?;

    let endian = match file.attribute("byte_order") {
        Some(order) => text::one_of(
            path,
            "byte_order",
            order,
            &[("LittleEndian", Endian::Little), ("BigEndian", Endian::Big)],
        )?,
        None => Endian::Little,
    };
    let voxel_bytes = grid.bytes.saturating_mul(components.count as u64);
    let (bytes, coding) = data::array(path, &file, &array, appended, voxel_bytes, endian)?;
    let payload = Payload {
        grid,
        element,
        endian,
        coding,
        skip: 0,
        components,
    };
    let voxels = payload.decode(Source::from_bytes(path, bytes), options)?;
    grid::volume(path, voxels, grid, world_from_ix, Rescale::default())
}

/// The array that is named as scalars, else the first; of points, else of cells. True for cells.
fn scalars<'a>(path: &Path, head: &'a str) -> Result<(Tag<'a>, bool)> {
    for (section, on_cells) in [("PointData", false), ("CellData", true)] {
        let Some(data) = markup::first(head, section) else {
            continue;
        };
        let inside = data
            .inside()
            .ok_or_else(|| bad(path, format!("{section} has no end: the file is cut short")))?;
        let array = match data.attribute("Scalars") {
            Some(name) => Some(
                markup::all(inside, "DataArray")
                    .find(|array| array.attribute("Name") == Some(name))
                    .ok_or_else(|| bad(path, format!("{section} has no DataArray {name:?}")))?,
            ),
            None => markup::first(inside, "DataArray"),
        };
        if let Some(array) = array {
            return Ok((array, on_cells));
        }
    }
    Err(bad(
        path,
        "there is no DataArray in PointData or CellData".into(),
    ))
}

fn placement(path: &Path, image: &Tag<'_>, first: DVec3) -> Result<glam::DAffine3> {
    let three = |key: &str, default: [f64; 3]| match image.attribute(key) {
        Some(value) => Ok(text::floats(path, key, value, 3)?
            .try_into()
            .unwrap_or(default)),
        None => Ok(default),
    };
    let spacing = grid::positive_spacing(path, "Spacing", three("Spacing", [1.0; 3])?)?;
    let origin = DVec3::from(three("Origin", [0.0; 3])?);
    let directions = match image.attribute("Direction") {
        Some(value) => text::floats(path, "Direction", value, 9)?,
        None => vec![1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
    };
    // Row by row: columns are the directions of the index axes.
    let mut steps = [DVec3::ZERO; 3];
    for (i, (step, spacing)) in steps.iter_mut().zip(spacing.to_array()).enumerate() {
        let column: Vec<f64> = directions.iter().skip(i).step_by(3).copied().collect();
        *step = DVec3::from_slice(column.get(..3).unwrap_or(&[f64::NAN; 3])) * spacing;
    }
    let [x, y, z] = steps;
    let origin = origin + x * first.x + y * first.y + z * first.z;
    grid::placement(path, "Direction, Spacing and Origin", steps, origin)
}

/// Where a byte string first occurs.
fn find(bytes: &[u8], wanted: &[u8]) -> Option<usize> {
    bytes
        .windows(wanted.len())
        .position(|window| window == wanted)
}
