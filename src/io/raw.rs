//! Headerless files, by description.

use std::path::Path;

use glam::DVec3;

use super::ReadOptions;
use super::components::Components;
use super::element::Element;
use super::grid::{self, Grid};
use super::payload::{Coding, Payload};
use super::source::{self, GZIP_MAGIC, Source};
use crate::error::{Error, Result};
use crate::scene::{Endian, RawDescription, RawType};
use crate::volume::{Rescale, Volume};

/// Reads a file that is exactly what the description says, as it is or gzip-compressed.
pub(super) fn read(
    path: &Path,
    description: &RawDescription,
    options: &ReadOptions<'_>,
) -> Result<Volume> {
    let element = match description.voxel_type {
        RawType::U8 => Element::U8,
        RawType::I8 => Element::I8,
        RawType::U16 => Element::U16,
        RawType::I16 => Element::I16,
        RawType::F32 => Element::F32,
    };
    let layout = Layout {
        element,
        size: description.size,
        spacing: description.spacing,
        endian: description.endian,
        offset: description.offset,
    };
    read_as(path, &layout, "volume.raw", options)
}

/// What a header would have said.
pub(super) struct Layout {
    pub(super) element: Element,
    pub(super) size: [u32; 3],
    pub(super) spacing: [f64; 3],
    pub(super) endian: Endian,
    pub(super) offset: u64,
}

/// Reads a file that is exactly that. `who` says it.
pub(super) fn read_as(
    path: &Path,
    layout: &Layout,
    who: &str,
    options: &ReadOptions<'_>,
) -> Result<Volume> {
    let element = layout.element;
    let axes = layout.size.map(u64::from);
    let at = |key: &str, error: Error| match error {
        Error::Volume { message, .. } => Error::invalid(format!("{who}.{key}"), message),
        other => other,
    };
    let grid = Grid::new(path, "size", &axes, element, options).map_err(|e| at("size", e))?;
    let spacing =
        grid::positive_spacing(path, "spacing", layout.spacing).map_err(|e| at("spacing", e))?;
    let [x, y, z] = DVec3::AXES;
    let world_from_ix = grid::placement(
        path,
        "spacing",
        [x * spacing.x, y * spacing.y, z * spacing.z],
        DVec3::ZERO,
    )
    .map_err(|e| at("spacing", e))?;

    let source = Source::open(path)?;
    let needed = layout.offset.saturating_add(grid.bytes);
    let fits = source.remaining() == needed;
    let gzip = source::head(path, GZIP_MAGIC.len())? == GZIP_MAGIC;
    // Voxels may start as gzip does; where the length fits too, the name decides.
    let coding = if gzip
        && (!fits
            || path
                .extension()
                .is_some_and(|e| e.eq_ignore_ascii_case("gz")))
    {
        Coding::Gzip
    } else if fits {
        Coding::Raw
    } else {
        let mismatch = format!(
            "{who} describes {needed} bytes (offset {} + {:?} voxels of type {element}), the file has {}",
            layout.offset,
            layout.size,
            source.remaining()
        );
        return Err(source.bad(mismatch));
    };
    let payload = Payload {
        grid,
        element,
        endian: layout.endian,
        coding,
        skip: layout.offset,
        components: Components::ONE,
    };
    let voxels = payload.decode(source, options)?;
    grid::volume(path, voxels, grid, world_from_ix, Rescale::default())
}
