//! NRRD, "nearly raw raster data": header with the data attached (.nrrd) or beside it (.nhdr).
//!
//! Format: G. Kindlmann, *Definition of NRRD File Format*, <https://teem.sourceforge.net/nrrd/format.html>.

mod header;
mod placement;

use std::path::Path;

use self::header::Header;
use super::detached;
use super::element::Element;
use super::formats::FileReader;
use super::grid::{self, Grid};
use super::payload::{Coding, Payload};
use super::source::Source;
use super::{Format, ReadOptions, text};
use crate::error::Result;
use crate::scene::Endian;
use crate::volume::{Rescale, Volume};

pub(super) const FORMAT: Format = Format {
    name: "NRRD",
    extensions: &["nrrd", "nhdr"],
    reads: "attached or detached, raw, gzip, text or hex, 3-D or 4-D",
    file: Some(FileReader {
        recognise: |head, _| head.starts_with(header::MAGIC),
        read,
    }),
    bundle: None,
};

/// The names of each type (section 5, `type`).
const TYPES: &[(&str, Element)] = &[
    ("uchar", Element::U8),
    ("unsigned char", Element::U8),
    ("uint8", Element::U8),
    ("uint8_t", Element::U8),
    ("signed char", Element::I8),
    ("int8", Element::I8),
    ("int8_t", Element::I8),
    ("ushort", Element::U16),
    ("unsigned short", Element::U16),
    ("unsigned short int", Element::U16),
    ("uint16", Element::U16),
    ("uint16_t", Element::U16),
    ("short", Element::I16),
    ("short int", Element::I16),
    ("signed short", Element::I16),
    ("signed short int", Element::I16),
    ("int16", Element::I16),
    ("int16_t", Element::I16),
    ("uint", Element::U32),
    ("unsigned int", Element::U32),
    ("uint32", Element::U32),
    ("uint32_t", Element::U32),
    ("int", Element::I32),
    ("signed int", Element::I32),
    ("int32", Element::I32),
    ("int32_t", Element::I32),
    ("ulonglong", Element::U64),
    ("unsigned long long", Element::U64),
    ("unsigned long long int", Element::U64),
    ("uint64", Element::U64),
    ("uint64_t", Element::U64),
    ("longlong", Element::I64),
    ("long long", Element::I64),
    ("long long int", Element::I64),
    ("signed long long", Element::I64),
    ("signed long long int", Element::I64),
    ("int64", Element::I64),
    ("int64_t", Element::I64),
    ("float", Element::F32),
    ("double", Element::F64),
];

const ENCODINGS: &[(&str, Coding)] = &[
    ("raw", Coding::Raw),
    ("gzip", Coding::Gzip),
    ("gz", Coding::Gzip),
    ("ascii", Coding::Ascii),
    ("text", Coding::Ascii),
    ("txt", Coding::Ascii),
    ("hex", Coding::Hex),
];

const ENDIANS: &[(&str, Endian)] = &[("little", Endian::Little), ("big", Endian::Big)];

/// Kinds of axes along which voxels lie side by side; along others lie the parts of one value.
const SCALAR_KINDS: &[(&str, ())] = &[
    ("domain", ()),
    ("space", ()),
    ("time", ()),
    ("scalar", ()),
    ("stub", ()),
    ("none", ()),
    ("???", ()),
];

fn read(path: &Path, options: &ReadOptions<'_>) -> Result<Volume> {
    let mut source = Source::open(path)?;
    let header = Header::read(&mut source, options.limits.max_header_bytes)?;

    let element = text::one_of(path, "type", header.required("type")?, TYPES)?;
    let sizes = header.per_axis(
        "sizes",
        text::sizes(path, "sizes", header.required("sizes")?)?,
    )?;
    let grid = Grid::new(path, "sizes", &sizes, element, options)?;
    if let Some(kinds) = header.get("kinds") {
        for kind in header.per_axis("kinds", kinds.split_whitespace().collect())? {
            text::one_of(path, "kinds (of a scalar volume)", kind, SCALAR_KINDS)?;
        }
    }
    let coding = text::one_of(path, "encoding", header.required("encoding")?, ENCODINGS)?;
    let endian = match header.get("endian") {
        Some(endian) => text::one_of(path, "endian", endian, ENDIANS)?,
        None if element.bytes() == 1 || coding == Coding::Ascii => Endian::Little,
        None => {
            return Err(
                header.bad("endian: is missing, and needed for this type; valid are little, big")
            );
        }
    };
    let world_from_ix = placement::world_from_ix(&header, grid.size)?;

    if let Some(name) = header.get("data file") {
        source = detached::open(path, "data file", name)?;
    }
    let skip = skip_to_data(&header, &mut source, coding, grid)?;
    let payload = Payload {
        grid,
        element,
        endian,
        coding,
        skip,
    };
    let voxels = payload.decode(source, options)?;
    let volume = grid::volume(path, voxels, grid, world_from_ix, Rescale::default())?;
    Ok(volume.with_metadata(header.metadata()))
}

/// Applies `line skip` to the file as it is. `byte skip` comes after that and, in compressed data, counts
/// decompressed bytes: it is given back, unless it is -1, which means that the data are the end of the file.
fn skip_to_data(header: &Header, source: &mut Source, coding: Coding, grid: Grid) -> Result<u64> {
    let number = |key: &str| match header.get(key) {
        Some(value) => value
            .parse::<i64>()
            .map_err(|_| header.bad(&format!("{key}: {value:?} is not a whole number"))),
        None => Ok(0),
    };
    let lines = u64::try_from(number("line skip")?)
        .map_err(|_| header.bad("line skip: must not be negative"))?;
    for skipped in 0..lines {
        if !source.skip_line()? {
            return Err(source.bad(format!(
                "line skip: {lines} lines are to be skipped, the file has {skipped}"
            )));
        }
    }
    match number("byte skip")? {
        -1 if coding == Coding::Raw => {
            let before = source
                .remaining()
                .checked_sub(grid.all_bytes)
                .ok_or_else(|| {
                    source.bad(format!(
                        "byte skip -1: the file has {} bytes left, the {:?} voxels need {}",
                        source.remaining(),
                        grid.size,
                        grid.all_bytes
                    ))
                })?;
            Ok(before)
        }
        bytes => u64::try_from(bytes).map_err(|_| {
            header.bad(&format!(
                "byte skip: {bytes} is not valid; a number from 0 is, and -1 with encoding raw"
            ))
        }),
    }
}
