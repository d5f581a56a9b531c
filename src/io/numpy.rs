//! NumPy arrays: .npy, and .npz with one array.
//!
//! Format: NumPy, *NEP 1: A simple file format for NumPy arrays*. The last index is x: `array[z, y, x]`, or
//! `array[t, z, y, x]`, whichever way it lies in memory. Arrays do not say how far voxels are apart; 1 mm is taken.

use std::io::Read;
use std::path::Path;

use glam::DVec3;

use super::bundle::{Bundle, Member};
use super::components::Components;
use super::element::{Element, NUMPY_ORDERS, NUMPY_TYPES};
use super::formats::{BundleReader, FileReader};
use super::grid::{self, Grid};
use super::payload::{Coding, Payload};
use super::reorder::from_first_fastest;
use super::source::{Source, read_error};
use super::{Format, ReadOptions, text};
use crate::error::Result;
use crate::scene::Endian;
use crate::volume::{Rescale, Volume};

pub(super) const FORMAT: Format = Format {
    name: "NumPy",
    extensions: &["npy", "npz"],
    reads: "one array of 3 or 4 axes, C or Fortran order; integers and floats",
    file: Some(FileReader {
        recognise: |head, _| head.starts_with(MAGIC),
        read: |path, options| read(Source::open(path)?, options),
    }),
    bundle: Some(BundleReader {
        recognise: |bundle| bundle.members().iter().any(is_array),
        read: read_bundle,
    }),
};

const MAGIC: &[u8] = b"\x93NUMPY";

fn is_array(member: &Member) -> bool {
    member.head(MAGIC.len()) == MAGIC
}

fn read_bundle(bundle: &Bundle, options: &ReadOptions<'_>) -> Result<Volume> {
    let arrays: Vec<&Member> = bundle.members().iter().filter(|m| is_array(m)).collect();
    match arrays.as_slice() {
        &[one] => {
            let bytes = one.bytes(&options.limits)?.into_owned();
            read(Source::from_bytes(&bundle.path_of(one), bytes), options)
        }
        several => {
            let names: Vec<&str> = several.iter().take(8).map(|m| m.name()).collect();
            Err(super::source::bad(
                bundle.path(),
                format!(
                    "{} arrays ({}, …); one is needed",
                    several.len(),
                    names.join(", ")
                ),
            ))
        }
    }
}

struct Header {
    element: Element,
    endian: Endian,
    fortran_order: bool,
    /// Slowest first.
    shape: Vec<u64>,
}

fn read(mut source: Source, options: &ReadOptions<'_>) -> Result<Volume> {
    let path = source.path().to_path_buf();
    let header = header(&mut source, &path, options.limits.max_header_bytes)?;
    let reordered = header.fortran_order;
    let mut axes = header.shape;
    // Sizes in file order, fastest first; in C order that is the last index.
    if !reordered {
        axes.reverse();
    } else if axes.len() != 3 {
        return Err(source.bad(format!("shape {axes:?} in Fortran order: 3 axes are read")));
    }
    // Bytes of which the last index counts three or four are colours, as imaging libraries keep them.
    let components = match axes.as_slice() {
        &[count @ (3 | 4), _, _, _, ..] if !reordered && header.element == Element::U8 => {
            axes.remove(0);
            Components::of(&path, count, header.element, true, options)?
        }
        _ => Components::ONE,
    };
    let file_grid = Grid::new(&path, "shape", &axes, header.element, options)?;
    let payload = Payload {
        grid: file_grid,
        element: header.element,
        endian: header.endian,
        coding: Coding::Raw,
        skip: 0,
        components,
    };
    let mut decoded = payload.decode(source, options)?;
    let mut grid = file_grid;
    if reordered {
        decoded = from_first_fastest(decoded, file_grid.size)?;
        grid.size.reverse();
    }
    let world_from_ix = grid::placement(&path, "spacing", DVec3::AXES, DVec3::ZERO)?;
    grid::volume(&path, decoded, grid, world_from_ix, Rescale::default())
}

fn header(source: &mut Source, path: &Path, max_bytes: u64) -> Result<Header> {
    let mut start = [0; 8];
    source
        .read_exact(&mut start)
        .map_err(|e| read_error(path, e))?;
    let [.., major, _] = start;
    let mut length = [0; 4];
    let length_bytes = if major == 1 { 2 } else { 4 };
    let field = length.get_mut(..length_bytes).unwrap_or_default();
    source.read_exact(field).map_err(|e| read_error(path, e))?;
    let length = u64::from(u32::from_le_bytes(length));
    if length > max_bytes || length > source.remaining() {
        return Err(source.bad(format!(
            "the header claims {length} bytes, more than are there or allowed"
        )));
    }
    let mut dictionary = String::new();
    source
        .by_ref()
        .take(length)
        .read_to_string(&mut dictionary)
        .map_err(|e| read_error(path, e))?;
    let field = |key: &str| {
        value_of(&dictionary, key)
            .ok_or_else(|| source.bad(format!("{key} is missing in the header {dictionary:?}")))
    };
    let descr = field("descr")?.trim_matches(['\'', '"']);
    let (order, name) = descr.split_at_checked(1).unwrap_or(("", descr));
    let endian = text::one_of(path, "descr: byte order", order, &NUMPY_ORDERS)?;
    let shape = field("shape")?.trim_matches(['(', ')']);
    Ok(Header {
        element: text::one_of(path, "descr", name, &NUMPY_TYPES)?,
        endian,
        fortran_order: text::one_of(
            path,
            "fortran_order",
            field("fortran_order")?,
            &[("True", true), ("False", false)],
        )?,
        shape: text::sizes(path, "shape", &shape.replace(',', " "))?,
    })
}

/// The text of a value in a Python dictionary of plain values.
fn value_of<'a>(dictionary: &'a str, key: &str) -> Option<&'a str> {
    let (_, after) = dictionary.split_once(&format!("'{key}':"))?;
    let after = after.trim_start();
    let end = if after.starts_with('(') {
        after.find(')')? + 1
    } else {
        after.find([',', '}'])?
    };
    after.get(..end).map(str::trim)
}
