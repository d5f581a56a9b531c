//! The tree of a grid: a root of nodes of 32³ slots, each of which is a tile or a node of 16³ slots, each of which is
//! a tile or a leaf of 8³ voxels.

use std::collections::BTreeSet;

use flate2::read::ZlibDecoder;
use glam::I64Vec3;
use half::f16;

use super::archive::Packing;
use super::bytes::{Bytes, from_little_endian};
use crate::error::Result;
use crate::io::blosc;
use crate::io::element::Stored;
use crate::io::source::read_error;

/// Slots on an edge of the nodes below the root, and of a leaf, as powers of two.
const UPPER_LOG2: u32 = 5;
const LOWER_LOG2: u32 = 4;
pub(super) const LEAF_LOG2: u32 = 3;
/// Voxels on an edge of what a slot of each covers.
const UPPER_SLOT_LOG2: u32 = LOWER_LOG2 + LEAF_LOG2;
const ROOT_SLOT_LOG2: u32 = UPPER_LOG2 + UPPER_SLOT_LOG2;

/// A leaf's voxels, and the bytes of a bit for each.
pub(super) const LEAF_VOXELS: usize = 1 << (3 * LEAF_LOG2);
const LEAF_MASK_BYTES: usize = LEAF_VOXELS / 8;

/// A type of voxels.
pub(super) trait Value: Stored + PartialEq {
    fn negative(self) -> Self;
    /// From what floats are saved as to save space.
    fn from_half(half: f16) -> Self;
}

macro_rules! value {
    ($($t:ty: $negative:expr, $from_half:expr;)*) => {$(
        impl Value for $t {
            fn negative(self) -> Self {
                $negative(self)
            }

            fn from_half(half: f16) -> Self {
                $from_half(half)
            }
        }
    )*};
}
value! {
    f32: |v: f32| -v, |h: f16| h.to_f32();
    f64: |v: f64| -v, |h: f16| h.to_f64();
    f16: |v: f16| -v, |h: f16| h;
    i32: |v: i32| v.wrapping_neg(), |h: f16| h.to_f32() as i32;
    i64: |v: i64| v.wrapping_neg(), |h: f16| h.to_f32() as i64;
}

/// One piece of what a tree covers, from its smallest voxel index on.
pub(super) enum Part<'a, T> {
    /// A cube of one value with `1 << log2` voxels on an edge.
    Tile { log2: u32, value: T, active: bool },
    /// Voxels whose values are in the file's blocks; a bit for each says whether it is active.
    Leaf { active: &'a [u8] },
}

/// The tree of one grid in a file.
#[derive(Clone, Copy)]
pub(super) struct Tree<'a, T> {
    /// From the first tile of the root on.
    nodes: Bytes<'a>,
    blocks: Bytes<'a>,
    packing: Packing,
    pub(super) background: T,
}

impl<'a, T: Value> Tree<'a, T> {
    /// Reads the head of a tree whose topology begins at `bytes`.
    pub(super) fn open(mut bytes: Bytes<'a>, blocks: Bytes<'a>, packing: Packing) -> Result<Self> {
        let buffers = bytes.number::<u32>()?;
        if buffers != 1 {
            return Err(bytes.bad(format!("{buffers} buffers for each voxel; 1 is read")));
        }
        let background = bytes.number()?;
        Ok(Self {
            nodes: bytes,
            blocks,
            packing,
            background,
        })
    }

    /// Visits every tile and leaf, in the order of the file. No two cover the same voxel.
    pub(super) fn visit(
        &self,
        visit: &mut dyn FnMut(I64Vec3, Part<'_, T>) -> Result<()>,
    ) -> Result<()> {
        let mut bytes = self.nodes;
        let [tiles, children] = [bytes.number::<u32>()?, bytes.number::<u32>()?];
        let mut seen = BTreeSet::new();
        let mut origin = |bytes: &mut Bytes<'_>| {
            let origin = bytes.coordinates()?;
            let low_bits = (1 << ROOT_SLOT_LOG2) - 1;
            let aligned = origin.to_array().iter().all(|x| x & low_bits == 0);
            if !aligned || !seen.insert(origin.to_array()) {
                return Err(bytes.bad(format!(
                    "a node at {origin}, which is no place of one or has one already"
                )));
            }
            Ok(origin)
        };
        for _ in 0..tiles {
            let origin = origin(&mut bytes)?;
            let (value, active) = (bytes.number()?, bytes.number::<u8>()? != 0);
            let log2 = ROOT_SLOT_LOG2;
            visit(
                origin,
                Part::Tile {
                    log2,
                    value,
                    active,
                },
            )?;
        }
        for _ in 0..children {
            let origin = origin(&mut bytes)?;
            self.node(&mut bytes, origin, UPPER_LOG2, UPPER_SLOT_LOG2, visit)?;
        }
        Ok(())
    }

    fn node(
        &self,
        bytes: &mut Bytes<'a>,
        origin: I64Vec3,
        log2: u32,
        slot_log2: u32,
        visit: &mut dyn FnMut(I64Vec3, Part<'_, T>) -> Result<()>,
    ) -> Result<()> {
        let slots = 1usize << (3 * log2);
        let (children, active) = (bytes.take(slots / 8)?, bytes.take(slots / 8)?);
        let values = self.values(bytes, active)?;
        let slot_origin = |slot: usize| origin + (cell(slot, log2) << slot_log2);
        for (slot, &value) in values
            .iter()
            .enumerate()
            .filter(|&(s, _)| !bit(children, s))
        {
            let tile = Part::Tile {
                log2: slot_log2,
                value,
                active: bit(active, slot),
            };
            visit(slot_origin(slot), tile)?;
        }
        for slot in (0..slots).filter(|&slot| bit(children, slot)) {
            if slot_log2 == LEAF_LOG2 {
                let active = bytes.take(LEAF_MASK_BYTES)?;
                visit(slot_origin(slot), Part::Leaf { active })?;
            } else {
                self.node(bytes, slot_origin(slot), LOWER_LOG2, LEAF_LOG2, visit)?;
            }
        }
        Ok(())
    }

    /// The values of every leaf, in the order of [`Self::visit`].
    pub(super) fn leaves(&self) -> impl Iterator<Item = Result<Vec<T>>> {
        let mut bytes = self.blocks;
        std::iter::from_fn(move || {
            let active = bytes.take(LEAF_MASK_BYTES);
            Some(active.and_then(|active| self.values(&mut bytes, active)))
        })
    }

    /// A value for each bit of `active` (`io/Compression.h` of OpenVDB, `readCompressedValues`).
    fn values(&self, bytes: &mut Bytes<'a>, active: &[u8]) -> Result<Vec<T>> {
        let count = 8 * active.len();
        let kind = bytes.number::<u8>()?;
        if kind > 6 {
            return Err(bytes.bad(format!("values of kind {kind}; valid are 0 to 6")));
        }
        let all_there = kind == 6;
        // What inactive voxels are, where the selection says no and yes.
        let mut inactive = [self.background; 2];
        if matches!(kind, 1 | 3 | 6) {
            inactive = [self.background.negative(), self.background];
        }
        if matches!(kind, 2 | 4 | 5) {
            inactive = [bytes.number()?, self.background];
        }
        if kind == 5 {
            let [first, _] = inactive;
            inactive = [first, bytes.number()?];
        }
        let selection = match kind {
            3..=5 => bytes.take(active.len())?,
            _ => &[],
        };
        if all_there || !self.packing.active_mask {
            return self.unpacked(bytes, count);
        }
        let actives = active.iter().map(|b| b.count_ones() as usize).sum();
        let mut there = self.unpacked(bytes, actives)?.into_iter();
        let [first, second] = inactive;
        let value = |i| {
            if bit(active, i) {
                there.next().unwrap_or(self.background)
            } else if bit(selection, i) {
                second
            } else {
                first
            }
        };
        Ok((0..count).map(value).collect())
    }

    /// `count` values in a row.
    fn unpacked(&self, bytes: &mut Bytes<'a>, count: usize) -> Result<Vec<T>> {
        if !self.packing.half {
            let raw = self.unpacked_bytes(bytes, count, size_of::<T>())?;
            return Ok(raw
                .chunks_exact(size_of::<T>())
                .map(from_little_endian)
                .collect());
        }
        if count == 0 {
            return Ok(Vec::new());
        }
        let raw = self.unpacked_bytes(bytes, count, size_of::<f16>())?;
        let halves = raw.chunks_exact(size_of::<f16>()).map(from_little_endian);
        Ok(halves.map(T::from_half).collect())
    }

    fn unpacked_bytes(&self, bytes: &mut Bytes<'a>, count: usize, each: usize) -> Result<Vec<u8>> {
        let len = count * each;
        if !self.packing.zip && !self.packing.blosc {
            return Ok(bytes.take(len)?.to_vec());
        }
        let packed_len = bytes.number::<i64>()?;
        let packed = bytes.take(packed_len.unsigned_abs() as usize)?;
        if packed_len <= 0 {
            if packed.len() != len {
                return Err(bytes.bad(format!(
                    "{} bytes of values where {len} are needed",
                    packed.len()
                )));
            }
            return Ok(packed.to_vec());
        }
        if count == 0 {
            return Ok(Vec::new());
        }
        let unpacked = if self.packing.blosc {
            blosc::decompress(packed, len)
        } else {
            let mut out = vec![0; len];
            std::io::Read::read_exact(&mut ZlibDecoder::new(packed), &mut out).map(|()| out)
        };
        unpacked.map_err(|e| read_error(bytes.path(), e))
    }
}

/// Bit `i` of a mask; of an empty one, 0.
pub(super) fn bit(mask: &[u8], i: usize) -> bool {
    mask.get(i / 8).is_some_and(|byte| byte >> (i % 8) & 1 == 1)
}

/// The place of a slot or voxel in a cube of `1 << log2` on an edge; z is fastest.
pub(super) fn cell(i: usize, log2: u32) -> I64Vec3 {
    let low = (1 << log2) - 1;
    let i = i as i64;
    I64Vec3::new(i >> (2 * log2), i >> log2 & low, i & low)
}
