//! The text of an NRRD header.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
use crate::io::source::{self, Source};
use crate::volume::{Content, Metadata};

/// What every header starts with; four digits of the version follow.
pub(super) const MAGIC: &[u8] = b"NRRD00";

const VERSIONS: &[&str] = &[
    "NRRD00.01",
    "NRRD0001",
    "NRRD0002",
    "NRRD0003",
    "NRRD0004",
    "NRRD0005",
];

/// Most axes that the format's own library handles.
const MAX_DIMENSION: usize = 16;

/// Every field of the definition, in its main spelling.
const FIELDS: &[&str] = &[
    "dimension",
    "type",
    "block size",
    "encoding",
    "endian",
    "content",
    "min",
    "max",
    "old min",
    "old max",
    "data file",
    "line skip",
    "byte skip",
    "number",
    "sample units",
    "sizes",
    "spacings",
    "thicknesses",
    "axis mins",
    "axis maxs",
    "centers",
    "labels",
    "units",
    "kinds",
    "space",
    "space dimension",
    "space units",
    "space origin",
    "space directions",
    "measurement frame",
];

/// Spellings that mean one of [`FIELDS`].
const SYNONYMS: &[(&str, &str)] = &[
    ("blocksize", "block size"),
    ("oldmin", "old min"),
    ("oldmax", "old max"),
    ("datafile", "data file"),
    ("lineskip", "line skip"),
    ("byteskip", "byte skip"),
    ("sampleunits", "sample units"),
    ("axismins", "axis mins"),
    ("axismaxs", "axis maxs"),
    ("centerings", "centers"),
];

/// Ends of the keys by which 3D Slicer lists the segments of a label map: `Segment0_LabelValue:=1`.
const SEGMENT_KEYS: [&str; 2] = ["_LabelValue", "_Name"];
/// Longest name of a segment that is kept.
const MAX_NAME_CHARS: usize = 80;

/// Fields by name. Comments and key/value pairs say nothing about the grid and are left out.
pub(super) struct Header {
    path: PathBuf,
    fields: BTreeMap<&'static str, String>,
    dimension: usize,
    /// Key/value pairs of 3D Slicer's segments.
    segments: BTreeMap<String, String>,
}

impl Header {
    /// Reads up to the empty line before attached data, or to the end of a detached header.
    pub(super) fn read(source: &mut Source, max_bytes: u64) -> Result<Self> {
        let mut header = Self {
            path: source.path().to_path_buf(),
            fields: BTreeMap::new(),
            dimension: 0,
            segments: BTreeMap::new(),
        };
        let mut budget = max_bytes;
        let magic = source.line(&mut budget)?.unwrap_or_default();
        if !VERSIONS.contains(&magic.as_str()) {
            return Err(header.bad(&format!(
                "the first line {magic:?} is not the magic of a version that is read: {}",
                VERSIONS.join(", ")
            )));
        }
        while let Some(line) = source.line(&mut budget)? {
            if line.is_empty() {
                break;
            }
            header.take(&line)?;
            if header
                .get("data file")
                .is_some_and(|files| files.starts_with("LIST"))
            {
                // Names of files follow, not fields.
                break;
            }
        }
        let dimension = header.required("dimension")?;
        header.dimension = dimension
            .parse()
            .ok()
            .filter(|n| (1..=MAX_DIMENSION).contains(n))
            .ok_or_else(|| {
                header.bad(&format!(
                    "dimension: {dimension:?} is not a number of axes from 1 to {MAX_DIMENSION}"
                ))
            })?;
        Ok(header)
    }

    /// One line: a comment, a key/value pair or a field.
    fn take(&mut self, line: &str) -> Result<()> {
        if line.starts_with('#') {
            return Ok(());
        }
        let field = line.split_once(": ").or_else(|| line.split_once(':'));
        let pair = line.find(":=");
        let Some((name, value)) = field else {
            return Err(self.bad(&format!(
                "line {line:?} is neither a field nor a key/value pair"
            )));
        };
        if let Some(at) = pair.filter(|&at| at <= name.len()) {
            let (key, value) = line.split_at(at);
            if SEGMENT_KEYS.iter().any(|end| key.ends_with(end)) && key.starts_with("Segment") {
                let value = value.strip_prefix(":=").unwrap_or_default();
                self.segments.insert(key.to_owned(), value.to_owned());
            }
            return Ok(());
        }
        let name = name.trim().to_ascii_lowercase();
        let name = SYNONYMS
            .iter()
            .find(|(other, _)| *other == name)
            .map_or(name.as_str(), |(_, main)| main);
        let Some(&name) = FIELDS.iter().find(|&&known| known == name) else {
            return Err(self.bad(&format!(
                "unknown field {name:?}; valid are {}",
                FIELDS.join(", ")
            )));
        };
        if self.fields.insert(name, value.trim().to_owned()).is_some() {
            return Err(self.bad(&format!("field {name:?} is given twice")));
        }
        Ok(())
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    pub(super) fn get(&self, name: &str) -> Option<&str> {
        self.fields.get(name).map(String::as_str)
    }

    pub(super) fn required(&self, name: &str) -> Result<&str> {
        self.get(name)
            .ok_or_else(|| self.bad(&format!("field {name:?} is missing")))
    }

    /// Labels where segments are listed; axes of a patient where `space` is anatomical.
    pub(super) fn metadata(&self) -> Metadata {
        let anatomical = ["superior", "RAS", "LAS", "LPS"];
        let space = self.get("space").unwrap_or_default();
        let [value_end, name_end] = SEGMENT_KEYS;
        let mut labels = self.segments.iter().filter_map(|(key, value)| {
            let segment = key.strip_suffix(value_end)?;
            Some((key, segment, value.trim().parse().ok()?))
        });
        let names = labels.clone().filter_map(|(_, segment, label)| {
            let name = self.segments.get(&format!("{segment}{name_end}"))?;
            Some((label, name.trim().chars().take(MAX_NAME_CHARS).collect()))
        });
        Metadata {
            label_names: names.collect(),
            content: labels
                .next()
                .map(|(key, ..)| (Content::Labels, format!("NRRD key {key}"))),
            patient_axes: anatomical.iter().any(|name| space.contains(name)),
        }
    }

    /// Checks that a field has one value for each axis.
    pub(super) fn per_axis<T>(&self, name: &str, values: Vec<T>) -> Result<Vec<T>> {
        if values.len() == self.dimension {
            return Ok(values);
        }
        Err(self.bad(&format!(
            "{name}: has {} values; dimension {} needs as many",
            values.len(),
            self.dimension
        )))
    }

    pub(super) fn bad(&self, message: &str) -> Error {
        source::bad(&self.path, message.into())
    }
}
