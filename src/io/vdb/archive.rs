//! The outside of a file: its header and the list of its grids.

use std::path::Path;

use super::bytes::Bytes;
use crate::error::Result;
use crate::io::source::bad;

/// First bytes of every file.
pub(super) const MAGIC: &[u8] = b" BDV\0\0\0\0";
/// Files with a compression flag for each grid, up to those with grids of half floats.
const VERSIONS: std::ops::RangeInclusive<u32> = 222..=225;
/// Bytes of the UUID, as text.
const UUID_BYTES: usize = 36;
/// Ends a name that others have too; a number follows.
const NAME_END: char = '\u{1e}';
/// Ends the type of a grid whose floats are saved as halves.
const HALF_SUFFIX: &str = "_HalfFloat";

const ZIP: u32 = 1;
const ACTIVE_MASK: u32 = 2;
const BLOSC: u32 = 4;

/// How the values of a grid are packed.
#[derive(Clone, Copy)]
pub(super) struct Packing {
    pub(super) zip: bool,
    pub(super) blosc: bool,
    /// Only values of active voxels are there.
    pub(super) active_mask: bool,
    pub(super) half: bool,
}

/// One grid of the file.
pub(super) struct Descriptor {
    pub(super) name: String,
    /// Without what says that floats are saved as halves.
    pub(super) kind: String,
    half: bool,
    instance_of: String,
    grid_position: i64,
    pub(super) block_position: i64,
}

/// All grids, in the order of the file.
pub(super) fn descriptors(bytes: &mut Bytes<'_>) -> Result<Vec<Descriptor>> {
    bytes.take(MAGIC.len())?;
    let version = bytes.number::<u32>()?;
    if !VERSIONS.contains(&version) {
        return Err(bytes.bad(format!(
            "file version {version} is not read; valid are {} to {} (save it again with OpenVDB 3 or later)",
            VERSIONS.start(),
            VERSIONS.end()
        )));
    }
    let [_major, _minor] = [bytes.number::<u32>()?, bytes.number::<u32>()?];
    if bytes.number::<u8>()? == 0 {
        return Err(bytes.bad("the file has no grid offsets: it was written as a stream".into()));
    }
    bytes.take(UUID_BYTES)?;
    skip_metadata(bytes)?;
    let count = bytes.number::<u32>()?;
    let mut all = Vec::new();
    for _ in 0..count {
        let name = bytes.text()?;
        let kind = bytes.text()?;
        let instance_of = bytes.text()?;
        let [grid_position, block_position, end] = [
            bytes.number::<i64>()?,
            bytes.number::<i64>()?,
            bytes.number::<i64>()?,
        ];
        let half = kind.ends_with(HALF_SUFFIX);
        all.push(Descriptor {
            name: name.split(NAME_END).next().unwrap_or_default().to_owned(),
            kind: kind.trim_end_matches(HALF_SUFFIX).to_owned(),
            half,
            instance_of,
            grid_position,
            block_position,
        });
        // Grids lie between their descriptors. Going back would let few bytes claim very many grids.
        let next = bytes.from(end)?;
        if next.position() < bytes.position() {
            return Err(bytes.bad(format!("the grid ends at byte {end}, before it begins")));
        }
        *bytes = next;
    }
    Ok(all)
}

impl Descriptor {
    /// How values are packed, the class of the grid, and the bytes from the transform on.
    pub(super) fn open<'a>(&self, file: &Bytes<'a>) -> Result<(Packing, &'a [u8], Bytes<'a>)> {
        if !self.instance_of.is_empty() {
            return Err(bad(
                file.path(),
                format!(
                    "grid {:?} is an instance of {:?}, which is not read",
                    self.name, self.instance_of
                ),
            ));
        }
        let mut bytes = file.from(self.grid_position)?;
        let flags = bytes.number::<u32>()?;
        if flags & !(ZIP | ACTIVE_MASK | BLOSC) != 0 {
            return Err(bytes.bad(format!("compression flags {flags:#x} are not known")));
        }
        let has = |flag| flags & flag != 0;
        let class = class_of(&mut bytes)?;
        let packing = Packing {
            zip: has(ZIP),
            blosc: has(BLOSC),
            active_mask: has(ACTIVE_MASK),
            half: self.half,
        };
        Ok((packing, class, bytes))
    }
}

fn skip_metadata(bytes: &mut Bytes<'_>) -> Result<()> {
    class_of(bytes).map(|_| ())
}

/// Passes over metadata: name, type, size and value of each entry. Gives back the value of `class`; empty without one.
fn class_of<'a>(bytes: &mut Bytes<'a>) -> Result<&'a [u8]> {
    let mut class = &[][..];
    for _ in 0..bytes.number::<u32>()? {
        let name = bytes.text()?;
        bytes.text()?;
        let size = bytes.number::<u32>()?;
        let value = bytes.take(size as usize)?;
        if name == "class" {
            class = value;
        }
    }
    Ok(class)
}

/// The grid asked for: by name (`volume.series`) or place (`volume.channel`), else the first that `is_read`.
pub(super) fn choose(
    path: &Path,
    mut all: Vec<Descriptor>,
    (name, place): (Option<&str>, Option<u32>),
    is_read: impl Fn(&Descriptor) -> bool,
) -> Result<Descriptor> {
    let list: Vec<String> = all
        .iter()
        .enumerate()
        .take(16)
        .map(|(i, grid)| format!("{i} {:?} ({})", grid.name, grid.kind))
        .collect();
    let list = list.join(", ");
    let (asked, found) = match (name, place) {
        (Some(name), _) => (
            format!("volume.series {name:?}"),
            all.iter().position(|grid| grid.name == name),
        ),
        (None, Some(place)) => {
            let place = place as usize;
            (
                format!("volume.channel {place}"),
                (place < all.len()).then_some(place),
            )
        }
        (None, None) => ("a scalar grid".to_owned(), all.iter().position(&is_read)),
    };
    let Some(found) = found else {
        return Err(bad(
            path,
            format!("{asked} is not in the file; its grids are {list}"),
        ));
    };
    if all.len() > 1 && name.is_none() && place.is_none() {
        tracing::info!(
            "several grids: {list}; {found} is read, volume.series (its name) or volume.channel picks another"
        );
    }
    Ok(all.swap_remove(found))
}
