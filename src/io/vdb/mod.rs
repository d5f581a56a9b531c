//! OpenVDB: fog volumes and level sets, written out over their active voxels.
//!
//! Format: that of OpenVDB's `io/Archive.cc`, `tree/*.h` and `io/Compression.h`, <https://www.openvdb.org>, which is
//! its only description. A unit of the world is taken as a millimetre; the axes are taken as they are.

mod archive;
mod bytes;
mod dense;
mod transform;
mod tree;

use std::path::Path;

use glam::DAffine3;
use half::f16;

use self::archive::Descriptor;
use self::bytes::Bytes;
use self::tree::{Tree, Value};
use super::element::Element;
use super::formats::FileReader;
use super::narrow::narrowed;
use super::source::bad;
use super::{Format, ReadOptions, bundle, grid};
use crate::error::Result;
use crate::volume::{Content, Metadata, Rescale, Volume, Voxels};

pub(super) const FORMAT: Format = Format {
    name: "OpenVDB",
    extensions: &["vdb"],
    reads: "a grid of floats or integers by name or number, dense over its active voxels; Blosc, Zip, halves",
    file: Some(FileReader {
        recognise: |head, _| head.starts_with(archive::MAGIC),
        read,
    }),
    bundle: None,
};

const TYPES: &[(&str, Element)] = &[
    ("Tree_float_5_4_3", Element::F32),
    ("Tree_half_5_4_3", Element::F16),
    ("Tree_double_5_4_3", Element::F64),
    ("Tree_int32_5_4_3", Element::I32),
    ("Tree_int64_5_4_3", Element::I64),
];

/// What a grid says that it is (`GridBase::gridClassToString`).
const CLASSES: &[(&str, Content)] = &[
    ("level set", Content::LevelSet),
    ("fog volume", Content::Simulation),
];

fn element(grid: &Descriptor) -> Option<Element> {
    let known = TYPES.iter().find(|(name, _)| *name == grid.kind);
    known.map(|&(_, element)| element)
}

fn read(path: &Path, options: &ReadOptions<'_>) -> Result<Volume> {
    let all = bundle::whole_file(path, &options.limits)?;
    let file = Bytes::new(path, &all);
    let grids = archive::descriptors(&mut file.clone())?;
    let asked = (options.series.as_deref(), options.channel);
    let chosen = archive::choose(path, grids, asked, |grid| element(grid).is_some())?;
    let element = element(&chosen).ok_or_else(|| {
        let valid: Vec<&str> = TYPES.iter().map(|&(name, _)| name).collect();
        let (name, kind) = (&chosen.name, &chosen.kind);
        bad(
            path,
            format!("grid {name:?} is a {kind}; valid are {}", valid.join(", ")),
        )
    })?;
    let reader = Reader {
        file,
        grid: &chosen,
        element,
        options,
    };
    match element {
        Element::F16 => reader.volume::<f16>(|v| narrowed(path, element, v)),
        Element::F64 => reader.volume::<f64>(|v| narrowed(path, element, v)),
        Element::I32 => reader.volume::<i32>(|v| narrowed(path, element, v)),
        Element::I64 => reader.volume::<i64>(|v| narrowed(path, element, v)),
        _ => reader.volume::<f32>(|v| Ok(Voxels::F32(v))),
    }
}

struct Reader<'a> {
    file: Bytes<'a>,
    grid: &'a Descriptor,
    element: Element,
    options: &'a ReadOptions<'a>,
}

impl Reader<'_> {
    fn volume<T: Value>(&self, voxels: impl FnOnce(Vec<T>) -> Result<Voxels>) -> Result<Volume> {
        let path = self.file.path();
        let (packing, class, mut bytes) = self.grid.open(&self.file)?;
        let world_from_index = transform::read(&mut bytes)?;
        let blocks = self.file.from(self.grid.block_position)?;
        let tree = Tree::<T>::open(bytes, blocks, packing)?;
        let dense = dense::densify(path, &tree, self.element, self.options)?;
        let world_from_ix = world_from_index * DAffine3::from_translation(dense.min.as_dvec3());
        let axes = world_from_ix.matrix3;
        let world_from_ix = grid::placement(
            path,
            "transform",
            [axes.x_axis, axes.y_axis, axes.z_axis],
            world_from_ix.translation,
        )?;
        let voxels = voxels(dense.voxels)?;
        let volume = grid::volume(path, voxels, dense.grid, world_from_ix, Rescale::default())?;
        let class = String::from_utf8_lossy(class);
        Ok(volume.with_metadata(Metadata::stated("OpenVDB class", &class, CLASSES)))
    }
}
