//! NRRD, "nearly raw raster data": header with the data attached (.nrrd) or beside it (.nhdr).
//!
//! Format: G. Kindlmann, *Definition of NRRD File Format*, <https://teem.sourceforge.net/nrrd/format.html>.

mod header;
mod layout;
mod placement;

use std::path::{Path, PathBuf};

use self::header::Header;
use self::layout::Layout;
use super::detached;
use super::element::Element;
use super::formats::FileReader;
use super::grid;
use super::payload::{Coding, Payload};
use super::source::Source;
use super::{Format, ReadOptions, parts, text};
use crate::error::Result;
use crate::scene::Endian;
use crate::volume::{Rescale, Volume};

pub(super) const FORMAT: Format = Format {
    name: "NRRD",
    extensions: &["nrrd", "nhdr"],
    reads: "attached, detached or in several files, raw, gzip, bzip2, text or hex; 3-D or 4-D, vectors, colours",
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
    ("bzip2", Coding::Bzip2),
    ("bz2", Coding::Bzip2),
];

const ENDIANS: &[(&str, Endian)] = &[("little", Endian::Little), ("big", Endian::Big)];

fn read(path: &Path, options: &ReadOptions<'_>) -> Result<Volume> {
    let mut source = Source::open(path)?;
    let header = Header::read(&mut source, options.limits.max_header_bytes)?;

    let element = text::one_of(path, "type", header.required("type")?, TYPES)?;
    let sizes = header.per_axis(
        "sizes",
        text::sizes(path, "sizes", header.required("sizes")?)?,
    )?;
    let layout = Layout::of(&header, &sizes, element, options)?;
    let grid = layout.grid;
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
    let world_from_ix = placement::world_from_ix(&header, grid.size, layout.first)?;

    let skip = Skip::of(&header, coding)?;
    let mut payload = Payload {
        grid,
        element,
        endian,
        coding,
        skip: 0,
        components: layout.components,
    };
    let voxels = match data_files(&header, &mut source, options)? {
        Data::Files(files) => {
            let to_data = move |source: &mut Source, bytes| skip.apply(source, bytes);
            payload.decode_files(path, files, to_data, options)?
        }
        one => {
            if let Data::File(file) = one {
                source = file;
            }
            payload.skip = skip.apply(&mut source, payload.bytes(grid.all_bytes))?;
            payload.decode(source, options)?
        }
    };
    let volume = grid::volume(path, voxels, grid, world_from_ix, Rescale::default())?;
    Ok(volume.with_metadata(header.metadata()))
}

/// Where the voxels are.
enum Data {
    /// After the header.
    Attached,
    File(Source),
    Files(Vec<PathBuf>),
}

/// `data file` (section 7): a name, `LIST` with names on the lines that follow, or a pattern and three numbers.
fn data_files(header: &Header, source: &mut Source, options: &ReadOptions<'_>) -> Result<Data> {
    const KEY: &str = "data file";
    let path = header.path();
    let Some(value) = header.get(KEY) else {
        return Ok(Data::Attached);
    };
    let words: Vec<&str> = value.split_whitespace().collect();
    let limits = &options.limits;
    let names = match words.as_slice() {
        ["LIST"] | ["LIST", _] => parts::listed(source, limits)?,
        [pattern, min, max, step] | [pattern, min, max, step, _] if pattern.contains('%') => {
            let number = |text| text::number(path, KEY, text);
            let numbers = [number(min)?, number(max)?, number(step)?];
            parts::numbered(path, KEY, pattern, numbers, limits)?
        }
        _ => return detached::open(path, KEY, value).map(Data::File),
    };
    parts::files(path, KEY, &names).map(Data::Files)
}

/// What lies before the data of a file: `line skip`, then `byte skip`.
#[derive(Clone, Copy)]
struct Skip {
    lines: u64,
    /// `None`: the data are the end of the file.
    bytes: Option<u64>,
}

impl Skip {
    fn of(header: &Header, coding: Coding) -> Result<Self> {
        let number = |key: &str| match header.get(key) {
            Some(value) => text::number::<i64>(header.path(), key, value),
            None => Ok(0),
        };
        let lines = u64::try_from(number("line skip")?)
            .map_err(|_| header.bad("line skip: must not be negative"))?;
        let bytes = match number("byte skip")? {
            -1 if coding == Coding::Raw => None,
            bytes => Some(u64::try_from(bytes).map_err(|_| {
                header.bad(&format!(
                    "byte skip: {bytes} is not valid; a number from 0 is, and -1 with encoding raw"
                ))
            })?),
        };
        Ok(Self { lines, bytes })
    }

    /// Skips lines of a file, which has so many bytes of voxels; gives back the bytes to be skipped of the decoded data.
    fn apply(self, source: &mut Source, voxel_bytes: u64) -> Result<u64> {
        let lines = self.lines;
        for skipped in 0..lines {
            if !source.skip_line()? {
                return Err(source.bad(format!(
                    "line skip: {lines} lines are to be skipped, the file has {skipped}"
                )));
            }
        }
        match self.bytes {
            Some(bytes) => Ok(bytes),
            None => source.remaining().checked_sub(voxel_bytes).ok_or_else(|| {
                source.bad(format!(
                    "byte skip -1: the file has {} bytes left, the voxels need {voxel_bytes}",
                    source.remaining()
                ))
            }),
        }
    }
}
