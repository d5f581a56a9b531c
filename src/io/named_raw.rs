//! Headerless files whose name says what they hold: `engine_256x256x128_uint8.raw`.
//!
//! The convention of the Open SciVis Datasets, <https://klacansky.com/open-scivis-datasets>: words between `_`, of which
//! one is the size and one the type. Byte order may be one more; it is little otherwise. Voxels are 1 mm apart.

use std::path::Path;

use super::ReadOptions;
use super::element::Element;
use super::raw::{self, Layout};
use super::source::bad;
use crate::error::Result;
use crate::scene::Endian;
use crate::volume::Volume;

const EXTENSIONS: [&str; 4] = ["raw", "bin", "dat", "vol"];

const TYPES: &[(&str, Element)] = &[
    ("uint8", Element::U8),
    ("u8", Element::U8),
    ("int8", Element::I8),
    ("i8", Element::I8),
    ("uint16", Element::U16),
    ("u16", Element::U16),
    ("int16", Element::I16),
    ("i16", Element::I16),
    ("uint32", Element::U32),
    ("u32", Element::U32),
    ("int32", Element::I32),
    ("i32", Element::I32),
    ("float16", Element::F16),
    ("f16", Element::F16),
    ("float32", Element::F32),
    ("float", Element::F32),
    ("f32", Element::F32),
    ("float64", Element::F64),
    ("double", Element::F64),
    ("f64", Element::F64),
];

const ENDIANS: &[(&str, Endian)] = &[
    ("le", Endian::Little),
    ("little", Endian::Little),
    ("be", Endian::Big),
    ("big", Endian::Big),
];

/// What a name says.
pub(super) struct Name {
    size: [u32; 3],
    element: Element,
    endian: Endian,
}

impl Name {
    /// Of a file whose name says size and type.
    pub(super) fn of(path: &Path) -> Option<Self> {
        let name = path.file_name()?.to_string_lossy().to_lowercase();
        let name = name.strip_suffix(".gz").unwrap_or(&name);
        let (stem, extension) = name.rsplit_once('.')?;
        if !EXTENSIONS.contains(&extension) {
            return None;
        }
        let words = || stem.split(['_', '-', '.', ' ']);
        let known = |word: &str| TYPES.iter().find(|(name, _)| *name == word);
        Some(Self {
            size: words().find_map(size)?,
            element: words().find_map(known)?.1,
            endian: words()
                .find_map(|word| ENDIANS.iter().find(|(name, _)| *name == word))
                .map_or(Endian::Little, |&(_, endian)| endian),
        })
    }
}

/// Three numbers with `x` between them.
fn size(word: &str) -> Option<[u32; 3]> {
    let numbers: Option<Vec<u32>> = word.split('x').map(|n| n.parse().ok()).collect();
    numbers?.try_into().ok()
}

pub(super) fn read(path: &Path, name: &Name, options: &ReadOptions<'_>) -> Result<Volume> {
    if options.strict {
        return Err(bad(
            path,
            "the name says size and type, but no spacing, and volume.strict refuses to guess; volume.raw describes it"
                .into(),
        ));
    }
    let layout = Layout {
        element: name.element,
        size: name.size,
        spacing: [1.0; 3],
        endian: name.endian,
        offset: 0,
    };
    tracing::info!(
        "size and type are taken from the name, 1 mm between voxels; volume.raw says otherwise"
    );
    raw::read_as(path, &layout, "the file name", options)
}
