//! Chunks, decoded and put in their places.

use rayon::prelude::*;

use super::codecs::Codecs;
use super::metadata::{Array, volume_of};
use super::store::Store;
use crate::error::Result;
use crate::io::element::Stored;
use crate::io::payload::reserve;
use crate::io::source::{bad, read_error};
use crate::scene::Endian;

/// An index entry of a shard's chunk that is not there.
const ABSENT: u64 = u64::MAX;

/// What of an array is read: a volume of it.
pub(super) struct Selection {
    /// For each axis of the array, the one index that is read; of the axes of space, 0.
    pub(super) fixed: Vec<u64>,
    /// The axes that are x, y and z.
    pub(super) space: [usize; 3],
    /// Voxels on x, y, z.
    pub(super) size: [u32; 3],
}

/// An array below its key in a store.
pub(super) struct Chunks<'a> {
    pub(super) store: &'a Store<'a>,
    /// Path of the array.
    pub(super) path: &'a str,
    pub(super) array: &'a Array,
    pub(super) selection: &'a Selection,
}

/// Told bytes done and in all.
type Progress<'a> = Option<&'a dyn Fn(u64, u64)>;

/// Slices from `first_z` on, x fastest.
struct Slab<'a, T> {
    first_z: u64,
    voxels: &'a mut [T],
}

/// A chunk, or a part of one: where it begins in the array, and how large it is.
struct Block<'a> {
    origin: &'a [u64],
    shape: &'a [u64],
}

fn of<T: Copy + Default>(numbers: &[T], axis: usize) -> T {
    numbers.get(axis).copied().unwrap_or_default()
}

impl Chunks<'_> {
    /// All voxels, x fastest.
    pub(super) fn read<T: Stored + Send>(&self, progress: Progress<'_>) -> Result<Vec<T>> {
        let [x, y, z] = self.selection.size.map(|n| n as usize);
        let fill =
            bytemuck::try_pod_read_unaligned(&self.array.fill).unwrap_or_else(|_| T::zeroed());
        let mut voxels = reserve(x * y * z)?;
        voxels.resize(x * y * z, fill);
        let [_, _, z_axis] = self.selection.space;
        let depth = of(&self.array.chunk, z_axis).max(1).min(z as u64) as usize;
        let all = size_of_val(voxels.as_slice()) as u64;
        // Progress is told by the calling thread alone, between pieces of work.
        let layers = rayon::current_num_threads().max(1);
        let mut done = 0;
        for (i, part) in voxels.chunks_mut(x * y * depth * layers).enumerate() {
            part.par_chunks_mut(x * y * depth)
                .enumerate()
                .try_for_each(|(j, voxels)| {
                    let first_z = (depth * (i * layers + j)) as u64;
                    self.slab(&mut Slab { first_z, voxels })
                })?;
            done += size_of_val(&*part) as u64;
            if let Some(progress) = progress {
                progress(done, all);
            }
        }
        Ok(voxels)
    }

    /// Every chunk that slices of one layer of chunks need.
    fn slab<T: Stored>(&self, slab: &mut Slab<'_, T>) -> Result<()> {
        let [x_axis, y_axis, z_axis] = self.selection.space;
        let sizes = &self.array.chunk;
        let chunk_of = |index: u64, axis: usize| index / of(sizes, axis).max(1);
        let [nx, ny, _] = self.selection.size.map(u64::from);
        let mut chunk: Vec<u64> = self
            .selection
            .fixed
            .iter()
            .enumerate()
            .map(|(axis, &i)| chunk_of(i, axis))
            .collect();
        let set = |axis: usize, to: u64, chunk: &mut [u64]| {
            if let Some(number) = chunk.get_mut(axis) {
                *number = to;
            }
        };
        set(z_axis, chunk_of(slab.first_z, z_axis), &mut chunk);
        for j in 0..=chunk_of(ny.saturating_sub(1), y_axis) {
            set(y_axis, j, &mut chunk);
            for i in 0..=chunk_of(nx.saturating_sub(1), x_axis) {
                set(x_axis, i, &mut chunk);
                let key = format!("{}{}", self.folder(), self.array.chunk_key(&chunk));
                let Some(bytes) = self.store.bytes(&key)? else {
                    continue;
                };
                let origin: Vec<u64> = chunk.iter().zip(sizes).map(|(n, size)| n * size).collect();
                let block = Block {
                    origin: &origin,
                    shape: sizes,
                };
                self.block(&key, &bytes, &self.array.codecs, &block, slab)?;
            }
        }
        Ok(())
    }

    fn folder(&self) -> String {
        match self.path {
            "" => String::new(),
            path => format!("{path}/"),
        }
    }

    fn block<T: Stored>(
        &self,
        key: &str,
        bytes: &[u8],
        codecs: &Codecs,
        block: &Block<'_>,
        slab: &mut Slab<'_, T>,
    ) -> Result<()> {
        if codecs.shard.is_some() {
            return self.shard(key, bytes, codecs, block, slab);
        }
        let elements = volume_of(block.shape).unwrap_or(0) as usize;
        let bytes = codecs
            .unpack(bytes, elements.saturating_mul(size_of::<T>()))
            .map_err(|e| read_error(&self.store.path(key), e))?;
        self.place(&bytes, codecs, block, slab);
        Ok(())
    }

    /// The chunks inside of a shard.
    fn shard<T: Stored>(
        &self,
        key: &str,
        bytes: &[u8],
        codecs: &Codecs,
        block: &Block<'_>,
        slab: &mut Slab<'_, T>,
    ) -> Result<()> {
        let path = self.store.path(key);
        let damaged = |what: &str| bad(&path, format!("this shard {what}"));
        let Some(shard) = &codecs.shard else {
            return Ok(());
        };
        let divides = |(&outer, &inner): (&u64, &u64)| inner > 0 && outer.is_multiple_of(inner);
        if shard.chunk.len() != block.shape.len()
            || !block.shape.iter().zip(&shard.chunk).all(divides)
        {
            return Err(damaged("is not a whole number of its chunks on each axis"));
        }
        let counts: Vec<u64> = block
            .shape
            .iter()
            .zip(&shard.chunk)
            .map(|(outer, inner)| outer / inner)
            .collect();
        let count = volume_of(&counts).unwrap_or(u64::MAX) as usize;
        let index_bytes = shard.index_bytes(count).filter(|&n| n <= bytes.len());
        let index_bytes = index_bytes.ok_or_else(|| damaged("is shorter than its index"))?;
        let start = if shard.index_at_start {
            0
        } else {
            bytes.len() - index_bytes
        };
        let index = bytes.get(start..start + index_bytes).unwrap_or_default();
        let index = shard
            .index
            .unpack(index, 16 * count)
            .map_err(|e| read_error(&path, e))?;
        let entry = |bytes: &[u8]| -> u64 {
            let word = bytes.first_chunk().copied().unwrap_or_default();
            match shard.index.endian {
                Endian::Little => u64::from_le_bytes(word),
                Endian::Big => u64::from_be_bytes(word),
            }
        };
        for (n, place) in index.chunks_exact(16).enumerate() {
            let (offset, len) = place.split_at(8);
            let (offset, len) = (entry(offset), entry(len));
            if offset == ABSENT && len == ABSENT {
                continue;
            }
            let mut rest = n as u64;
            let mut origin = block.origin.to_vec();
            for (axis, origin) in origin.iter_mut().enumerate().rev() {
                *origin += rest % of(&counts, axis).max(1) * of(&shard.chunk, axis);
                rest /= of(&counts, axis).max(1);
            }
            let inner = Block {
                origin: &origin,
                shape: &shard.chunk,
            };
            if !self.is_read(&inner, slab) {
                continue;
            }
            let end = offset
                .checked_add(len)
                .filter(|&end| end <= bytes.len() as u64);
            let end = end.ok_or_else(|| damaged("has a chunk that ends after it"))?;
            let packed = bytes.get(offset as usize..end as usize).unwrap_or_default();
            self.block(key, packed, &shard.codecs, &inner, slab)?;
        }
        Ok(())
    }

    /// Where, from a block's origin, the one index of an axis that is no axis of space lies.
    fn is_read<T>(&self, block: &Block<'_>, slab: &Slab<'_, T>) -> bool {
        let space = self.selection.space;
        let inside = |axis: usize, first: u64, count: u64| {
            let (origin, size) = (of(block.origin, axis), of(block.shape, axis));
            origin < first + count && first < origin + size
        };
        let [nx, ny, _] = self.selection.size.map(u64::from);
        let [x, y, z] = space;
        let slices = slab.voxels.len() as u64 / (nx * ny).max(1);
        let others = (0..block.origin.len()).filter(|axis| !space.contains(axis));
        inside(x, 0, nx)
            && inside(y, 0, ny)
            && inside(z, slab.first_z, slices)
            && others
                .into_iter()
                .all(|axis| inside(axis, of(&self.selection.fixed, axis), 1))
    }

    /// Copies what of a decoded block is wanted.
    fn place<T: Stored>(
        &self,
        bytes: &[u8],
        codecs: &Codecs,
        block: &Block<'_>,
        slab: &mut Slab<'_, T>,
    ) {
        // Elements from one to the next along each axis of the array.
        let mut strides = vec![0; block.shape.len()];
        let mut stride = 1;
        for &axis in codecs.order.iter().rev() {
            if let Some(to) = strides.get_mut(axis) {
                *to = stride;
            }
            stride *= of(block.shape, axis) as usize;
        }
        let space = self.selection.space;
        let mut base = 0;
        for axis in (0..block.shape.len()).filter(|axis| !space.contains(axis)) {
            let inside = of(&self.selection.fixed, axis).saturating_sub(of(block.origin, axis));
            base += inside as usize * of(&strides, axis);
        }
        let [nx, ny, _] = self.selection.size.map(|n| n as usize);
        let [ox, oy, oz] = space.map(|axis| of(block.origin, axis) as usize);
        let [bx, by, bz] = space.map(|axis| of(block.shape, axis) as usize);
        let [sx, sy, sz] = space.map(|axis| of(&strides, axis));
        let swap = (codecs.endian == Endian::Big) != cfg!(target_endian = "big");
        let first_z = slab.first_z as usize;
        for (k, slice) in slab.voxels.chunks_mut(nx * ny).enumerate() {
            let Some(z) = (first_z + k).checked_sub(oz).filter(|&z| z < bz) else {
                continue;
            };
            for (y, row) in slice.chunks_mut(nx).skip(oy).take(by).enumerate() {
                let start = (base + z * sz + y * sy) * size_of::<T>();
                let elements = bytes
                    .get(start..)
                    .unwrap_or_default()
                    .chunks_exact(size_of::<T>());
                let row = row.get_mut(ox..nx.min(ox + bx)).unwrap_or_default();
                for (to, from) in row.iter_mut().zip(elements.step_by(sx.max(1))) {
                    let value: T = bytemuck::pod_read_unaligned(from);
                    *to = if swap { value.swapped() } else { value };
                }
            }
        }
    }
}
