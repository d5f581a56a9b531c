//! Which axes of an NRRD array are those of space, and what lies along the others.

use super::header::Header;
use crate::error::Result;
use crate::io::ReadOptions;
use crate::io::components::{Components, Pick};
use crate::io::element::Element;
use crate::io::grid::Grid;
use crate::io::text;

/// What lies along an axis (section 5, `kinds`).
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    /// Voxels side by side.
    Space,
    /// One volume after the other, or nothing.
    Volumes,
    /// The numbers of one value.
    Components,
    Colour,
}

const KINDS: &[(&str, Kind)] = &[
    ("domain", Kind::Space),
    ("space", Kind::Space),
    ("none", Kind::Space),
    ("???", Kind::Space),
    ("time", Kind::Volumes),
    ("scalar", Kind::Volumes),
    ("stub", Kind::Volumes),
    ("list", Kind::Components),
    ("point", Kind::Components),
    ("vector", Kind::Components),
    ("covariant-vector", Kind::Components),
    ("normal", Kind::Components),
    ("complex", Kind::Components),
    ("2-vector", Kind::Components),
    ("3-color", Kind::Colour),
    ("RGB-color", Kind::Colour),
    ("HSV-color", Kind::Components),
    ("XYZ-color", Kind::Components),
    ("4-color", Kind::Colour),
    ("RGBA-color", Kind::Colour),
    ("3-vector", Kind::Components),
    ("3-gradient", Kind::Components),
    ("3-normal", Kind::Components),
    ("4-vector", Kind::Components),
    ("quaternion", Kind::Components),
    ("2D-symmetric-matrix", Kind::Components),
    ("2D-masked-symmetric-matrix", Kind::Components),
    ("2D-matrix", Kind::Components),
    ("2D-masked-matrix", Kind::Components),
    ("3D-symmetric-matrix", Kind::Components),
    ("3D-masked-symmetric-matrix", Kind::Components),
    ("3D-matrix", Kind::Components),
    ("3D-masked-matrix", Kind::Components),
];

/// The volume that is read.
pub(super) struct Layout {
    /// First axis of space.
    pub(super) first: usize,
    pub(super) grid: Grid,
    pub(super) components: Components,
}

impl Layout {
    /// Components are on the first axis, so that those of a voxel lie side by side, or after the axes of space.
    pub(super) fn of(
        header: &Header,
        sizes: &[u64],
        element: Element,
        options: &ReadOptions<'_>,
    ) -> Result<Self> {
        let path = header.path();
        let kinds: Vec<Kind> = match header.get("kinds") {
            Some(kinds) => header
                .per_axis("kinds", kinds.split_whitespace().collect())?
                .into_iter()
                .map(|kind| text::one_of(path, "kinds", kind, KINDS))
                .collect::<Result<_>>()?,
            None => without_kinds(header, sizes.len()),
        };
        let kind = |axis: usize| kinds.get(axis).copied().unwrap_or(Kind::Space);
        let is_component = |kind| matches!(kind, Kind::Components | Kind::Colour);
        let first = usize::from(sizes.len() > 3 && is_component(kind(0)));
        let (inner, outer) = sizes.split_at_checked(first).unwrap_or((&[], sizes));
        let inside =
            (first..first + 3).find(|&axis| kind(axis) != Kind::Space && sizes.len() > axis);
        // A time, a scalar or nothing may be all there is along an axis of a plain volume.
        if let Some(axis) = inside.filter(|&axis| is_component(kind(axis))) {
            return Err(header.bad(&format!(
                "kinds: {:?} of sizes {sizes:?}: axis {axis} is none of space; components are read on the first axis \
                 of four or more, and after three axes of space",
                header.get("kinds").unwrap_or_default()
            )));
        }
        let components = match inner {
            &[count] => Components::of(path, count, element, kind(0) == Kind::Colour, options)?,
            _ => Components::ONE,
        };
        let planes = first + 3;
        let apart = sizes.len() == planes + 1 && is_component(kind(planes));
        if !apart {
            let grid = Grid::new(path, "sizes", outer, element, options)?;
            return Ok(Self {
                first,
                grid,
                components,
            });
        }
        // Whole volumes of one component after the other.
        let count = sizes.last().copied().unwrap_or(1) as usize;
        let Pick::Component(channel) = Pick::of(path, count, false, element, options)? else {
            return Err(header.bad("kinds: colours that lie apart have no luminance"));
        };
        let options = ReadOptions {
            timestep: Some(channel as u32),
            limits: options.limits,
            ..ReadOptions::default()
        };
        Ok(Self {
            first,
            grid: Grid::new(path, "sizes", outer, element, &options)?,
            components,
        })
    }
}

/// Without kinds, an axis that has no direction in space is one of components.
fn without_kinds(header: &Header, count: usize) -> Vec<Kind> {
    let directions = header.get("space directions").unwrap_or_default();
    let starts_with_none = count > 3 && directions.trim_start().starts_with("none");
    let first = if starts_with_none {
        Kind::Components
    } else {
        Kind::Space
    };
    let mut kinds = vec![Kind::Space; count];
    if let Some(kind) = kinds.first_mut() {
        *kind = first;
    }
    kinds
}
