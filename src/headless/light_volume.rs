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
    let computed = computed_groups(work);
    for (index, (record, &block)) in work.bricks.iter().zip(&work.blocks).enumerate() {
        let brick = Brick {
            texels,
            atlas: atlas.map(|n| n as usize),
            origin: record.origin_at.map(|o| o as usize),
            intervals: grid.intervals(block, record.level as u8),
            computed: computed[index],
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

/// By brick: bit `x + 5 (y + 5 z)` for each group that holds light.
fn computed_groups(work: &LightWork) -> Vec<u128> {
    let mut groups = vec![0; work.bricks.len()];
    for [brick, packed] in work.trace.iter().chain(&work.seam) {
        let [x, y, z] = LightWork::group(*packed);
        groups[*brick as usize] |= 1 << (x + 5 * (y + 5 * z));
    }
    groups
}

struct Brick<'a> {
    texels: &'a [[u16; 4]],
    atlas: [usize; 3],
    origin: [usize; 3],
    intervals: [u32; 3],
    computed: u128,
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
            let [x, y, z] = sample.map(|s| s / GROUP);
            if self.computed >> (x + 5 * (y + 5 * z)) & 1 == 0 {
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
