//! The light volume on the full grid.

use half::f16;

use crate::atlas::{GROUP, LightWork};
use crate::error::{Error, Result};
use crate::renderer::Loaded;
use crate::volume::blocks::BLOCK_CELLS;

/// Light at every voxel, x fastest.
#[derive(Clone, Debug, PartialEq)]
pub struct LightVolume {
    /// Voxels on x, y, z.
    pub size: [u32; 3],
    /// Linear RGB light, the bias included; alpha is 1 where light was computed and 0 (with no light) elsewhere.
    pub rgba: Vec<[f32; 4]>,
}

/// Reads the light of every voxel out of the packed volume (four f16 bits a texel).
///
/// # Errors
/// [`Error::OutOfMemory`] when the host has no room for 16 bytes a voxel.
pub(super) fn unpack(loaded: &Loaded, texels: &[[u16; 4]]) -> Result<LightVolume> {
    let volume = &loaded.store().volume;
    let size = volume.size();
    let bias = loaded.light_bias();
    let count = size.iter().map(|&n| n as usize).product();
    let mut rgba = Vec::new();
    rgba.try_reserve_exact(count)
        .map_err(|e| Error::OutOfMemory {
            heap: "host",
            what: "light volume".into(),
            bytes: 16 * count as u64,
            detail: e.to_string(),
        })?;
    rgba.resize(count, [0.0; 4]);
    let mut light = LightVolume { size, rgba };
    let atlas = loaded.images().light.extent();
    let grid = loaded.store().grid();
    let work = &loaded.visibility().light;
    let computed = computed_samples(work);
    for (index, (record, &block)) in work.bricks.iter().zip(&work.blocks).enumerate() {
        let brick = Brick {
            texels,
            atlas: atlas.map(|n| n as usize),
            origin: record.origin_at.map(|o| o as usize),
            intervals: grid.intervals(block, record.level as u8),
            computed: &computed[index],
        };
        let first = grid.origin_ix(block);
        let cells = grid.cells(block);
        // A block has its first voxel on each axis; the last block of an axis has its last one too.
        let count: [u32; 3] = std::array::from_fn(|a| {
            let last = first[a] + cells[a] == size[a] - 1;
            (cells[a] + u32::from(last)).min(BLOCK_CELLS + 1)
        });
        for z in 0..count[2] {
            for y in 0..count[1] {
                for x in 0..count[0] {
                    let at: [f64; 3] = std::array::from_fn(|a| {
                        f64::from([x, y, z][a]) * f64::from(brick.intervals[a])
                            / f64::from(cells[a])
                    });
                    if let Some([r, g, b]) = brick.light(at) {
                        let voxel = volume.offset(first[0] + x, first[1] + y, first[2] + z);
                        light.rgba[voxel] = [r + bias, g + bias, b + bias, 1.0];
                    }
                }
            }
        }
    }
    Ok(light)
}

/// Groups of a brick on each axis, at most.
const GROUPS: usize = (BLOCK_CELLS / GROUP + 1) as usize;

/// Of a brick: by group, x fastest, a bit for each sample that holds light.
type Samples = [u64; GROUPS.pow(3)];

/// By brick.
fn computed_samples(work: &LightWork) -> Vec<Samples> {
    let mut computed = vec![[0; GROUPS.pow(3)]; work.bricks.len()];
    for entry in work.trace.iter().chain(&work.seam) {
        let (group, samples) = LightWork::group(entry);
        computed[entry[0] as usize][place(group, GROUPS)] |= samples;
    }
    computed
}

/// Linear index into a cube of so many on each axis.
fn place(at: [u32; 3], count: usize) -> usize {
    let [x, y, z] = at.map(|n| n as usize);
    x + count * (y + count * z)
}

struct Brick<'a> {
    texels: &'a [[u16; 4]],
    atlas: [usize; 3],
    origin: [usize; 3],
    intervals: [u32; 3],
    computed: &'a Samples,
}

impl Brick<'_> {
    /// Light between the samples of the brick; `None` where one that counts was not computed.
    fn light(&self, at: [f64; 3]) -> Option<[f32; 3]> {
        let mut sum = [0.0f32; 3];
        for corner in 0..8u32 {
            let mut weight = 1.0;
            let sample: [u32; 3] = std::array::from_fn(|a| {
                let low = (at[a] as u32).min(self.intervals[a] - 1);
                let f = at[a] - f64::from(low);
                let bit = corner >> a & 1;
                weight *= if bit == 1 { f } else { 1.0 - f };
                low + bit
            });
            if weight < 1e-9 {
                continue;
            }
            let group = self.computed[place(sample.map(|s| s / GROUP), GROUPS)];
            if group >> place(sample.map(|s| s % GROUP), GROUP as usize) & 1 == 0 {
                return None;
            }
            let [x, y, z]: [usize; 3] =
                std::array::from_fn(|a| self.origin[a] + sample[a] as usize);
            let texel = self.texels[x + self.atlas[0] * (y + self.atlas[1] * z)];
            for (sum, bits) in sum.iter_mut().zip(texel) {
                *sum += weight as f32 * f16::from_bits(bits).to_f32();
            }
        }
        Some(sum)
    }
}
