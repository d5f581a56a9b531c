//! MetaImage: header with the data attached (.mha) or beside it (.mhd).
//!
//! Format: Kitware, *MetaIO*, <https://itk.org/Wiki/ITK/MetaIO/Documentation>, as ITK reads it: world space is
//! LPS, and each row of numbers in `TransformMatrix` is the direction of one index axis.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use glam::{DAffine3, DVec3};

use super::components::Components;
use super::element::Element;
use super::formats::FileReader;
use super::grid::{self, Grid};
use super::payload::{Coding, Payload};
use super::source::{self, Source};
use super::{Format, ReadOptions, detached, parts, text};
use crate::error::{Error, Result};
use crate::scene::Endian;
use crate::volume::{Content, Metadata, Rescale, Volume};

pub(super) const FORMAT: Format = Format {
    name: "MetaImage",
    extensions: &["mha", "mhd"],
    reads: "3-D or 4-D, attached, detached or in several files, raw, zlib or text; channels",
    file: Some(FileReader { recognise, read }),
    bundle: None,
};

const TYPES: &[(&str, Element)] = &[
    ("MET_UCHAR", Element::U8),
    ("MET_CHAR", Element::I8),
    ("MET_USHORT", Element::U16),
    ("MET_SHORT", Element::I16),
    ("MET_UINT", Element::U32),
    ("MET_INT", Element::I32),
    ("MET_ULONG", Element::U32),
    ("MET_LONG", Element::I32),
    ("MET_ULONG_LONG", Element::U64),
    ("MET_LONG_LONG", Element::I64),
    ("MET_FLOAT", Element::F32),
    ("MET_DOUBLE", Element::F64),
];

const MODALITIES: &[(&str, Content)] = &[
    ("MET_MOD_CT", Content::Ct),
    ("MET_MOD_MR", Content::Mr),
    ("MET_MOD_NM", Content::Nuclear),
    ("MET_MOD_US", Content::Ultrasound),
];

const BOOLEANS: &[(&str, bool)] = &[
    ("True", true),
    ("False", false),
    ("T", true),
    ("F", false),
    ("Yes", true),
    ("No", false),
    ("1", true),
    ("0", false),
];

/// Keys that are other names of one value; the first that is there counts.
const DIRECTION_KEYS: &[&str] = &["TransformMatrix", "Rotation", "Orientation"];
const ORIGIN_KEYS: &[&str] = &["Offset", "Position", "Origin"];
const SPACING_KEYS: &[&str] = &["ElementSpacing", "ElementSize"];
const ORDER_KEYS: &[&str] = &["BinaryDataByteOrderMSB", "ElementByteOrderMSB"];
/// The last key of a header.
const DATA_FILE: &str = "ElementDataFile";

/// Text of `key = value` lines that has a number of dimensions.
fn recognise(head: &[u8], _: &Path) -> bool {
    let text = String::from_utf8_lossy(head);
    let mut keys = text
        .lines()
        .map_while(|line| line.split_once('=').map(|(key, _)| key.trim()));
    keys.any(|key| key == "NDims")
}

struct Header {
    path: PathBuf,
    values: BTreeMap<String, String>,
    dimension: usize,
}

impl Header {
    /// Reads up to and with the line that names the data file.
    fn read(source: &mut Source, max_bytes: u64) -> Result<Self> {
        let mut header = Self {
            path: source.path().to_path_buf(),
            values: BTreeMap::new(),
            dimension: 0,
        };
        let mut budget = max_bytes;
        while !header.values.contains_key(DATA_FILE) {
            let Some(line) = source.line(&mut budget)? else {
                return Err(header.bad(format!("{DATA_FILE} is missing; it ends the header")));
            };
            let Some((key, value)) = line.split_once('=') else {
                return Err(header.bad(format!("line {line:?} is not of the form key = value")));
            };
            let (key, value) = (key.trim().to_owned(), value.trim().to_owned());
            if let Some(earlier) = header.values.insert(key.clone(), value) {
                return Err(header.bad(format!("{key} is given twice, first as {earlier:?}")));
            }
        }
        let dimension = header.required("NDims")?;
        header.dimension = dimension
            .parse()
            .ok()
            .filter(|n| (1..=10).contains(n))
            .ok_or_else(|| {
                header.bad(format!(
                    "NDims {dimension:?}: a number of axes from 1 to 10 is valid"
                ))
            })?;
        Ok(header)
    }

    fn get(&self, key: &str) -> Option<&str> {
        self.values.get(key).map(String::as_str)
    }

    fn required(&self, key: &str) -> Result<&str> {
        self.get(key)
            .ok_or_else(|| self.bad(format!("{key} is missing")))
    }

    fn flag(&self, key: &str) -> Result<bool> {
        match self.get(key) {
            Some(value) => text::one_of(&self.path, key, value, BOOLEANS),
            None => Ok(false),
        }
    }

    /// The value under the first of some keys that is there, as `count` numbers.
    fn floats(&self, keys: &[&str], count: usize) -> Result<Option<Vec<f64>>> {
        let found = keys.iter().find_map(|key| Some((key, self.get(key)?)));
        found
            .map(|(key, value)| text::floats(&self.path, key, value, count))
            .transpose()
    }

    /// One number, with its default.
    fn float(&self, key: &str, default: f64) -> Result<f64> {
        let all = self.floats(&[key], 1)?;
        Ok(all.and_then(|v| v.first().copied()).unwrap_or(default))
    }

    fn bad(&self, message: String) -> Error {
        source::bad(&self.path, message)
    }
}

fn read(path: &Path, options: &ReadOptions<'_>) -> Result<Volume> {
    let mut source = Source::open(path)?;
    let header = Header::read(&mut source, options.limits.max_header_bytes)?;
    if let Some(kind) = header.get("ObjectType") {
        text::one_of(path, "ObjectType", kind, &[("Image", ())])?;
    }
    let element = text::one_of(path, "ElementType", header.required("ElementType")?, TYPES)?;
    let sizes = text::sizes(path, "DimSize", header.required("DimSize")?)?;
    if sizes.len() != header.dimension {
        return Err(header.bad(format!(
            "DimSize has {} numbers; NDims {} needs as many",
            sizes.len(),
            header.dimension
        )));
    }
    let grid = Grid::new(path, "DimSize", &sizes, element, options)?;
    let channels = match header.get("ElementNumberOfChannels") {
        Some(channels) => text::number(path, "ElementNumberOfChannels", channels)?,
        None => 1,
    };
    let colour = matches!(channels, 3 | 4);
    let components = Components::of(path, channels, element, colour, options)?;
    let world_from_ix = world_from_ix(&header)?;
    let rescale = Rescale {
        slope: header.float("ElementToIntensityFunctionSlope", 1.0)?,
        intercept: header.float("ElementToIntensityFunctionOffset", 0.0)?,
    };
    let big = ORDER_KEYS
        .iter()
        .try_fold(false, |big, key| Ok::<_, Error>(big | header.flag(key)?))?;
    let endian = if big { Endian::Big } else { Endian::Little };

    let coding = coding(&header)?;
    let payload = Payload {
        grid,
        element,
        endian,
        coding,
        skip: 0,
        components,
    };
    let skipped = header.skipped_bytes(coding)?;
    let voxels = match header.data(&mut source, options)? {
        Data::Local => {
            skip_header(skipped, &mut source, payload.bytes(grid.all_bytes))?;
            payload.decode(source, options)?
        }
        Data::File(mut source) => {
            skip_header(skipped, &mut source, payload.bytes(grid.all_bytes))?;
            payload.decode(source, options)?
        }
        Data::Files(files) => {
            let to_data =
                move |source: &mut Source, bytes| skip_header(skipped, source, bytes).map(|()| 0);
            payload.decode_files(path, files, to_data, options)?
        }
    };
    let volume = grid::volume(path, voxels, grid, world_from_ix, rescale)?;
    let modality = header.get("Modality").unwrap_or_default();
    let oriented = header.get("AnatomicalOrientation").is_some();
    let metadata = Metadata::stated("MetaImage Modality", modality, MODALITIES);
    Ok(volume.with_metadata(metadata.with_patient_axes(oriented)))
}

/// Where the voxels are.
enum Data {
    /// After the header.
    Local,
    File(Source),
    Files(Vec<PathBuf>),
}

impl Header {
    /// `LOCAL`, a file's name, `LIST` with the names on the lines that follow, or a pattern and three numbers.
    fn data(&self, source: &mut Source, options: &ReadOptions<'_>) -> Result<Data> {
        let value = self.required(DATA_FILE)?;
        let words: Vec<&str> = value.split_whitespace().collect();
        let limits = &options.limits;
        let names = match words.as_slice() {
            [local] if local.eq_ignore_ascii_case("LOCAL") => return Ok(Data::Local),
            ["LIST"] | ["LIST", _] => parts::listed(source, limits)?,
            [pattern, min, max, step] if pattern.contains('%') => {
                let number = |text| text::number(&self.path, DATA_FILE, text);
                let numbers = [number(min)?, number(max)?, number(step)?];
                parts::numbered(&self.path, DATA_FILE, pattern, numbers, limits)?
            }
            _ => return detached::open(&self.path, DATA_FILE, value).map(Data::File),
        };
        parts::files(&self.path, DATA_FILE, &names).map(Data::Files)
    }

    /// `HeaderSize`, which is how many bytes lie before the data; `None` where the data are the end of the file.
    fn skipped_bytes(&self, coding: Coding) -> Result<Option<u64>> {
        let Some(value) = self.get("HeaderSize") else {
            return Ok(Some(0));
        };
        match value.parse::<i64>() {
            Ok(-1) if coding == Coding::Raw => Ok(None),
            Ok(bytes @ 0..) => Ok(Some(bytes.unsigned_abs())),
            _ => Err(self.bad(format!(
                "HeaderSize {value:?}: a number of bytes from 0 is valid, and -1 for uncompressed binary data"
            ))),
        }
    }
}

/// Goes to the data of a file, which has so many bytes of them.
fn skip_header(skipped: Option<u64>, source: &mut Source, bytes: u64) -> Result<()> {
    let before = skipped.unwrap_or_else(|| source.remaining().saturating_sub(bytes));
    source.advance(before, "HeaderSize")
}

fn coding(header: &Header) -> Result<Coding> {
    let ascii = header.get("BinaryData").is_some() && !header.flag("BinaryData")?;
    match (header.flag("CompressedData")?, ascii) {
        (true, true) => Err(header.bad("CompressedData = True needs BinaryData = True".into())),
        (true, false) => Ok(Coding::Zlib),
        (false, true) => Ok(Coding::Ascii),
        (false, false) => Ok(Coding::Raw),
    }
}

/// World (mm, LPS) from voxel index.
fn world_from_ix(header: &Header) -> Result<DAffine3> {
    let n = header.dimension;
    let spacing = header
        .floats(SPACING_KEYS, n)?
        .unwrap_or_else(|| vec![1.0; n]);
    let origin = header
        .floats(ORIGIN_KEYS, n)?
        .unwrap_or_else(|| vec![0.0; n]);
    let spacing = first_three(&spacing);
    grid::positive_spacing(&header.path, "ElementSpacing", spacing)?;
    let directions = match header.floats(DIRECTION_KEYS, n * n)? {
        Some(matrix) => matrix
            .chunks(n)
            .take(3)
            .map(|d| DVec3::from(first_three(d)))
            .collect(),
        None => DVec3::AXES.to_vec(),
    };
    let mut steps = [DVec3::ZERO; 3];
    for ((step, direction), spacing) in steps.iter_mut().zip(directions).zip(spacing) {
        *step = direction * spacing;
    }
    grid::placement(
        &header.path,
        "TransformMatrix, ElementSpacing and Offset",
        steps,
        DVec3::from(first_three(&origin)),
    )
}

/// The numbers of the axes that remain; there are always three when sizes are valid.
fn first_three(numbers: &[f64]) -> [f64; 3] {
    numbers.first_chunk::<3>().copied().unwrap_or([f64::NAN; 3])
}
