//! Beams: where along the rays of a few neighbouring pixels something may show.
//!
//! Reads   skip, bits of cells between voxels (SampledGeneral)
//! Writes  bits of every beam, for each tile and run of its dispatch a list of the beams that show something, and its length (Storage);
//!         the target and the depths of pixels of the others (Storage), unless the target holds there what it should
//! Grid    one invocation for 4x2 pixels, one dispatch a tile; where the target holds what it should, of the pixels that may show something
//! Method  a box around the rays moves along them and leaps by the same cubes as rays do; beam optimization as of Laine and Karras,
//!         "Efficient sparse voxel octrees", 2010, with bits for all of the ray instead of where it begins; segments that are left
//!         are looked up among cells between voxels, where few of those show something
//! Limits  tiles of 8192 x 8192 pixels, 64 words of bits a beam: an entry of a list has 32 bits
//! Twin    none: pictures with and without are compared bit by bit (tests/properties/beams.rs)

use std::sync::Arc;

use ash::vk;

use super::{Constants, Rectangle, Variants};
use crate::error::Result;
use crate::gpu::{Access, Bound, Buffer, Context, MemoryLocation, Recorder};
use crate::shader::PassInterface;
use crate::shader::generated::{BINDING_BEAM_LIST, BINDING_BEAM_RUNS, BINDING_BEAM_TILES};
use crate::shader::structs::MarchPush;

/// Pixels of a beam, as in `glsl/include/beams.glsl`.
pub(crate) const BEAM_PX: [u32; 2] = [4, 2];

/// How rays are cut into runs of segments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct BeamLengths {
    /// A bit stands for `1 << shift` segments.
    pub(crate) shift: u32,
    /// Words of bits for each beam.
    pub(crate) words: u32,
    /// A bit stands for one segment, and cells between voxels are looked up.
    pub(crate) singly: bool,
}

/// How many there are in a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct BeamCounts {
    tiles: u64,
    beams: u64,
    /// Entries of all lists.
    listed: u64,
    runs: u32,
}

impl BeamCounts {
    /// `runs`: of a dispatch (`Capabilities::dispatch_runs`).
    pub(crate) fn of(size_px: [u32; 2], tile: u32, runs: u32) -> Self {
        let none = Self {
            tiles: 0,
            beams: 0,
            listed: 0,
            runs,
        };
        let tiles = Rectangle::of_size(size_px).tiles(tile);
        tiles.fold(none, |sum, tile| Self {
            tiles: sum.tiles + 1,
            beams: sum.beams + beams_of(tile),
            listed: sum.listed + u64::from(runs) * u64::from(listed_by_run(tile, runs)),
            runs,
        })
    }

    pub(crate) fn tile_bytes(self) -> u64 {
        tile_bytes(self.runs) * self.tiles
    }

    pub(crate) fn list_bytes(self) -> u64 {
        4 * self.listed
    }

    pub(crate) fn run_bytes(self, words: u32) -> u64 {
        4 * u64::from(words) * self.beams
    }

    /// Of the largest of the three.
    pub(crate) fn most_bytes(self, words: u32) -> u64 {
        let others = self.tile_bytes().max(self.list_bytes());
        others.max(self.run_bytes(words))
    }
}

/// What the beams of a frame leave for the march; frames of a queue share it.
pub(crate) struct Beams {
    /// Of every tile the march's workgroups, and how many beams each run has listed.
    pub(super) tiles: Buffer,
    /// Where listed beams lie in their tile, and which of their words have bits.
    list: Buffer,
    /// Bits of all beams.
    runs: Buffer,
}

impl Beams {
    /// Room for so many.
    pub(crate) fn new(
        context: &Arc<Context>,
        name: &str,
        counts: BeamCounts,
        words: u32,
    ) -> Result<Self> {
        let buffer = |part: &str, bytes: u64, usage: vk::BufferUsageFlags| {
            Buffer::new(
                context,
                &format!("{name}.beams.{part}"),
                bytes,
                vk::BufferUsageFlags::STORAGE_BUFFER | usage,
                MemoryLocation::Device,
            )
        };
        let none = vk::BufferUsageFlags::empty();
        let counters = vk::BufferUsageFlags::INDIRECT_BUFFER | vk::BufferUsageFlags::TRANSFER_DST;
        Ok(Self {
            tiles: buffer("tiles", counts.tile_bytes(), counters)?,
            list: buffer("list", counts.list_bytes(), none)?,
            runs: buffer("runs", counts.run_bytes(words), none)?,
        })
    }

    /// True when they have room for so many.
    pub(crate) fn serve(&self, counts: BeamCounts, words: u32) -> bool {
        self.tiles.bytes() >= counts.tile_bytes()
            && self.list.bytes() >= counts.list_bytes()
            && self.runs.bytes() >= counts.run_bytes(words)
    }

    pub(crate) fn bytes(&self) -> u64 {
        let buffers = self.buffers();
        buffers.iter().map(|(_, buffer)| buffer.bytes()).sum()
    }

    /// See [`Buffer::forget`].
    pub(crate) fn forget(&mut self) {
        for buffer in [&self.tiles, &self.list, &self.runs] {
            buffer.forget();
        }
    }

    /// As shaders bind them.
    pub(super) fn bound(&self) -> [(u32, Bound<'_>); 3] {
        self.buffers()
            .map(|(binding, buffer)| (binding, Bound::Storage(buffer)))
    }

    fn buffers(&self) -> [(u32, &Buffer); 3] {
        [
            (BINDING_BEAM_TILES, &self.tiles),
            (BINDING_BEAM_LIST, &self.list),
            (BINDING_BEAM_RUNS, &self.runs),
        ]
    }
}

/// The pass.
#[derive(Default)]
pub(super) struct BeamsPass {
    variants: Variants,
}

impl BeamsPass {
    /// Casts the beams of a picture, for the march to follow. `interface`, `constants`, `bound`: those of the picture, for this pass.
    #[expect(
        clippy::too_many_arguments,
        reason = "a part of the picture's own recording"
    )]
    pub(super) fn record(
        &mut self,
        context: &Arc<Context>,
        recorder: &mut Recorder<'_>,
        interface: &'static PassInterface,
        constants: Constants,
        bound: &[(u32, Bound<'_>)],
        beams: &Beams,
        area: Rectangle,
        tile: u32,
    ) -> Result<()> {
        let pipeline = self.variants.get(context, interface, constants)?;
        recorder.fill_zero(&beams.tiles);
        for (_, buffer) in beams.buffers() {
            recorder.use_buffer(buffer, Access::Storage);
        }
        recorder.bind(pipeline, bound)?;
        let runs = context.capabilities().dispatch_runs;
        for (tile, push) in march_tiles(area, tile, runs) {
            recorder.dispatch(pipeline, &push, beam_groups(tile));
        }
        for (_, buffer) in beams.buffers() {
            recorder.use_buffer(buffer, Access::Indirect);
        }
        Ok(())
    }
}

/// Distance of a tile's counters, each in a line of a cache of its own; as in `glsl/include/beams.glsl`.
const APART_BYTES: u64 = 64;

/// Beams of a workgroup.
const GROUP_BEAMS: u32 = 64;

/// Of a tile: workgroups on three axes, beams listed by run.
pub(super) fn tile_bytes(runs: u32) -> u64 {
    APART_BYTES * (1 + u64::from(runs))
}

/// Beams that the list of a run has room for.
fn listed_by_run(tile: Rectangle, runs: u32) -> u32 {
    let [x, y, _] = beam_groups(tile);
    GROUP_BEAMS * (x * y).div_ceil(runs)
}

fn beams_on_axes(tile: Rectangle) -> [u32; 2] {
    [0, 1].map(|axis| (tile.end[axis] - tile.first[axis]).div_ceil(BEAM_PX[axis]))
}

fn beams_of(tile: Rectangle) -> u64 {
    let [x, y] = beams_on_axes(tile);
    u64::from(x) * u64::from(y)
}

/// Workgroups of 8 x 8 beams that cover a tile.
fn beam_groups(tile: Rectangle) -> [u32; 3] {
    let [x, y] = beams_on_axes(tile).map(|beams| beams.div_ceil(8));
    [x, y, 1]
}

/// The tiles of a part of a picture, with where their beams are, if any are cast.
pub(super) fn march_tiles(
    area: Rectangle,
    tile: u32,
    runs: u32,
) -> impl Iterator<Item = (Rectangle, MarchPush)> {
    let (mut first_beam, mut first_listed) = (0, 0);
    area.tiles(tile).zip(0..).map(move |(tile, beam_tile)| {
        let push = MarchPush {
            tile_px: tile.first,
            tile_end_px: tile.end,
            beam_tile,
            first_beam,
            first_listed,
            listed_by_run: listed_by_run(tile, runs),
        };
        first_beam += beams_of(tile) as u32;
        first_listed += runs * push.listed_by_run;
        (tile, push)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn beams_of_tiles_follow_each_other_without_gap() {
        for (size, tile) in [
            ([512, 512], 512),
            ([100, 37], 8),
            ([1, 1], 8192),
            ([33, 70], 32),
        ] {
            for runs in [1, 2, 3, 64] {
                let (mut next, mut next_listed) = (0, 0);
                for (piece, push) in march_tiles(Rectangle::of_size(size), tile, runs) {
                    assert_eq!([push.first_beam, push.first_listed], [next, next_listed]);
                    next += beams_of(piece) as u32;
                    next_listed += runs * push.listed_by_run;
                    assert!(next_listed >= next, "{size:?} in tiles of {tile}");
                }
                let counts = BeamCounts::of(size, tile, runs);
                assert_eq!(counts.beams, u64::from(next));
                assert_eq!(counts.listed, u64::from(next_listed));
                let covered = u64::from(size[0].div_ceil(4)) * u64::from(size[1].div_ceil(2));
                assert_eq!(counts.beams, covered, "{size:?} in tiles of {tile}");
            }
        }
    }

    #[test]
    fn a_part_of_a_picture_has_room_where_all_of_it_has() {
        for (tile, runs) in [(512, 2), (96, 2), (24, 5), (200, 64)] {
            let size = [700, 333];
            let room = BeamCounts::of(size, tile, runs);
            for (first, end) in [
                ([4, 2], size),
                ([348, 16], [699, 290]),
                ([0, 300], [8, 333]),
            ] {
                let tiles = march_tiles(Rectangle { first, end }, tile, runs);
                let (tile, last) = tiles.last().unwrap();
                assert!(u64::from(last.beam_tile) < room.tiles);
                let beams = u64::from(last.first_beam) + beams_of(tile);
                assert!(beams <= room.beams, "{first:?} {end:?}");
                let listed = last.first_listed + runs * last.listed_by_run;
                assert!(u64::from(listed) <= room.listed, "{first:?} {end:?}");
            }
        }
    }

    /// `deal` of `glsl/include/deal.glsl`, as `glsl/beams.comp` calls it: the group that each takes, and its run.
    fn dealt(groups: u32, runs: u32) -> impl Iterator<Item = (u32, u32)> {
        const AT_ONCE: u32 = 8;
        let hand = groups / (runs * AT_ONCE) * AT_ONCE;
        (0..groups).map(move |at| {
            if at >= hand * runs {
                return (at, (at - hand * runs) % runs);
            }
            let (run, within) = (at / hand, at % hand);
            let piece = (within / AT_ONCE * runs + run) * AT_ONCE + within % AT_ONCE;
            (piece, run)
        })
    }

    #[test]
    fn every_run_has_room_for_the_beams_that_it_casts() {
        for runs in [1, 2, 3, 5, 32, 64] {
            for size in [[512, 512], [8, 8], [333, 700], [32, 1000], [8192, 8192]] {
                let tile = Rectangle::of_size(size);
                let [x, y, _] = beam_groups(tile);
                let mut taken = vec![false; (x * y) as usize];
                let mut cast = vec![0; runs as usize];
                for (piece, run) in dealt(x * y, runs) {
                    assert!(!std::mem::replace(&mut taken[piece as usize], true));
                    cast[run as usize] += GROUP_BEAMS;
                }
                let room = listed_by_run(tile, runs);
                assert!(cast.iter().all(|&beams| beams <= room), "{size:?}, {runs}");
                // As many workgroups of the march as a dispatch may have, by rows of 32 with 8 beams each.
                assert!(room.div_ceil(256) * runs <= 65535, "{size:?}, {runs}");
            }
        }
    }

    #[test]
    fn entries_of_lists_have_room() {
        // `beam_listed` of `glsl/include/beams.glsl`.
        let [x, y] = beams_on_axes(Rectangle::of_size([crate::pass::LARGEST_TILE; 2]));
        assert!(x <= 1 << 11 && y <= 1 << 12);
    }
}
