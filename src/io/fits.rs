//! FITS images: the first image with at least three axes, of the primary array and the `IMAGE` extensions.
//!
//! Format: IAU, *Definition of the Flexible Image Transport System*, version 4.0. Axis 1 is x. World coordinates
//! are angles and velocities, not lengths: voxels are 1 mm apart. `BSCALE` and `BZERO` are applied; `BLANK` is not.

use std::collections::BTreeMap;
use std::io::Read;
use std::path::Path;

use glam::DVec3;

use super::components::Components;
use super::element::Element;
use super::formats::FileReader;
use super::grid::{self, Grid};
use super::payload::{Coding, Payload};
use super::source::{Source, read_error};
use super::{Format, ReadOptions};
use crate::error::Result;
use crate::scene::Endian;
use crate::volume::{Rescale, Volume};

pub(super) const FORMAT: Format = Format {
    name: "FITS",
    extensions: &["fits", "fit", "fts"],
    reads: "the first image of 3 or 4 axes, of the primary array or an extension",
    file: Some(FileReader {
        recognise: |head, _| head.starts_with(b"SIMPLE  = "),
        read,
    }),
    bundle: None,
};

/// Headers and data fill whole blocks (3.1).
const BLOCK: u64 = 2880;
const CARD: usize = 80;
/// Most axes (4.4.1).
const MAX_AXES: usize = 999;

const TYPES: &[(i64, Element)] = &[
    (8, Element::U8),
    (16, Element::I16),
    (32, Element::I32),
    (64, Element::I64),
    (-32, Element::F32),
    (-64, Element::F64),
];

/// Keywords and their values, as text without comments.
struct Header(BTreeMap<String, String>);

impl Header {
    fn number<T: std::str::FromStr>(&self, source: &Source, key: &str) -> Result<Option<T>> {
        let Some(text) = self.0.get(key) else {
            return Ok(None);
        };
        // Double precision may be written with a D.
        let number = text.replace('D', "E").parse();
        number
            .map(Some)
            .map_err(|_| source.bad(format!("{key} {text:?} is not a valid number")))
    }

    fn required<T: std::str::FromStr>(&self, source: &Source, key: &str) -> Result<T> {
        self.number(source, key)?
            .ok_or_else(|| source.bad(format!("{key} is missing")))
    }
}

fn read(path: &Path, options: &ReadOptions<'_>) -> Result<Volume> {
    let mut source = Source::open(path)?;
    let mut budget = options.limits.max_header_bytes;
    loop {
        let header = next_header(&mut source, &mut budget)?;
        let element = element(&source, &header)?;
        let axes = axes(&source, &header)?;
        let is_image = header.0.get("XTENSION").is_none_or(|kind| kind == "IMAGE");
        if is_image && axes.len() >= 3 {
            return volume(source, &header, element, &axes, options);
        }
        let skip = data_bytes(&source, &header, element, &axes)?;
        if skip >= source.remaining() {
            return Err(
                source.bad("no image of this file has 3 axes; a 3-D volume is needed".into())
            );
        }
        source.advance(skip, "an array that is no volume")?;
    }
}

fn volume(
    source: Source,
    header: &Header,
    element: Element,
    axes: &[u64],
    options: &ReadOptions<'_>,
) -> Result<Volume> {
    let path = source.path().to_path_buf();
    let grid = Grid::new(&path, "NAXISn", axes, element, options)?;
    let rescale = Rescale {
        slope: header.number(&source, "BSCALE")?.unwrap_or(1.0),
        intercept: header.number(&source, "BZERO")?.unwrap_or(0.0),
    };
    let payload = Payload {
        grid,
        element,
        endian: Endian::Big,
        coding: Coding::Raw,
        skip: 0,
        components: Components::ONE,
    };
    let voxels = payload.decode(source, options)?;
    let world_from_ix = grid::placement(&path, "spacing", DVec3::AXES, DVec3::ZERO)?;
    grid::volume(&path, voxels, grid, world_from_ix, rescale)
}

/// Reads cards up to `END`, and the rest of its block.
fn next_header(source: &mut Source, budget: &mut u64) -> Result<Header> {
    let mut values = BTreeMap::new();
    let mut read = 0u64;
    loop {
        let mut card = [0; CARD];
        if *budget < CARD as u64 {
            return Err(source.bad("the header does not end within the limit for headers".into()));
        }
        *budget -= CARD as u64;
        read += CARD as u64;
        let path = source.path().to_path_buf();
        source
            .read_exact(&mut card)
            .map_err(|e| read_error(&path, e))?;
        let card = String::from_utf8_lossy(&card).into_owned();
        let (key, value) = card.split_at_checked(8).unwrap_or((&card, ""));
        if key.trim_end() == "END" {
            break;
        }
        if let Some(value) = value.strip_prefix("= ") {
            values.insert(key.trim_end().to_owned(), plain_value(value));
        }
    }
    let rest = read.next_multiple_of(BLOCK) - read;
    source.advance(rest, "the end of the header")?;
    Ok(Header(values))
}

/// A value without its quotes and its comment (4.2).
fn plain_value(text: &str) -> String {
    let text = text.trim();
    let inside = match text.strip_prefix('\'') {
        Some(quoted) => quoted.split('\'').next(),
        None => text.split('/').next(),
    };
    inside.unwrap_or_default().trim().to_owned()
}

fn element(source: &Source, header: &Header) -> Result<Element> {
    let code: i64 = header.required(source, "BITPIX")?;
    let known = TYPES.iter().find(|(known, _)| *known == code);
    known.map(|&(_, element)| element).ok_or_else(|| {
        source.bad(format!(
            "BITPIX {code} is not read; valid are 8, 16, 32, 64, -32, -64"
        ))
    })
}

/// Sizes of all axes, fastest first.
fn axes(source: &Source, header: &Header) -> Result<Vec<u64>> {
    let count: usize = header.required(source, "NAXIS")?;
    if count > MAX_AXES {
        return Err(source.bad(format!("NAXIS {count}: at most {MAX_AXES} axes are valid")));
    }
    (1..=count)
        .map(|i| header.required(source, &format!("NAXIS{i}")))
        .collect()
}

/// Bytes of an array with the tables' heap (`PCOUNT`, `GCOUNT`; 4.4.1.2), to the end of its block.
fn data_bytes(source: &Source, header: &Header, element: Element, axes: &[u64]) -> Result<u64> {
    if axes.is_empty() {
        return Ok(0);
    }
    let pcount: u64 = header.number(source, "PCOUNT")?.unwrap_or(0);
    let gcount: u64 = header.number(source, "GCOUNT")?.unwrap_or(1);
    axes.iter()
        .try_fold(1u64, |n, &m| n.checked_mul(m))
        .and_then(|n| {
            n.checked_add(pcount)?
                .checked_mul(gcount)?
                .checked_mul(element.bytes())
        })
        .and_then(|bytes| bytes.checked_next_multiple_of(BLOCK))
        .ok_or_else(|| source.bad(format!("NAXISn {axes:?}: more than can be counted")))
}
