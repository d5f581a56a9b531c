//! Beams of a picture: whether there are any, and what they are kept in.

use std::sync::Arc;

use glam::DVec3;

use super::RayBasis;
use super::loaded::{Loaded, NAME};
use crate::error::{Error, Result};
use crate::gpu::Context;
use crate::pass::beams::{BeamCounts, BeamLengths, Beams};

/// Words of bits for a beam, at most: with the shortest runs of segments they are enough for rays of a thousand segments.
const MOST_WORDS: u32 = 8;

/// Voxels from a pixel to the next, in the middle of the volume, up to which beams pay: the boxes around rays that are farther apart meet
/// too many cells that no ray does. Of 256³ voxels, 512 × 512 pixels have 0.6 (time 0.64 to 0.91), 192 × 192 have 1.6 (0.83 to 1.02),
/// 96 × 96 have 3.2 (0.94 to 2.29).
const WIDEST_PIXEL: f64 = 2.0;

/// Segments of the shortest runs, as a power of two. A skip cell is as many voxels long.
const SHORTEST_SHIFT: u32 = 2;

/// Bits for rays of so many segments.
fn lengths(segments: f64) -> BeamLengths {
    let words = |shift: u32| (segments / f64::from(32 << shift)).ceil().max(1.0);
    let shift = (SHORTEST_SHIFT..SHORTEST_SHIFT + 16)
        .find(|&shift| words(shift) <= f64::from(MOST_WORDS))
        .unwrap_or(SHORTEST_SHIFT + 16);
    BeamLengths {
        shift,
        words: words(shift).min(f64::from(MOST_WORDS)) as u32,
    }
}

impl Loaded {
    /// Room for the beams of a picture, and how its rays are cut into runs; `None` where beams do not pay or memory has no room for them,
    /// as pictures can do without.
    pub(super) fn take_beams(
        &mut self,
        context: &Arc<Context>,
        rays: &RayBasis,
        size_px: [u32; 2],
    ) -> Result<Option<(Beams, BeamLengths)>> {
        let kept = self.beams.take();
        let march = &self.settings.march;
        let capabilities = context.capabilities();
        let skips = march.beams && march.empty_space_skipping && self.is_uniform_grid();
        let serves = capabilities.casts_beams && skips && self.settings.composites();
        if !serves || !self.has_narrow_pixels(rays, size_px) {
            return Ok(None);
        }
        // Those of the longest way, the one that a jittered start adds, and one for rounding.
        let lengths = lengths(self.longest_mm() / self.step_mm() + 2.0);
        let counts = BeamCounts::of(size_px, self.march_tile());
        if counts.run_bytes(lengths.words) > capabilities.max_storage_bytes {
            return Ok(None);
        }
        if let Some(beams) = kept.filter(|beams| beams.serve(counts, lengths.words)) {
            return Ok(Some((beams, lengths)));
        }
        match Beams::new(context, NAME, counts, lengths.words) {
            Err(Error::OutOfMemory { .. }) => Ok(None),
            made => Ok(Some((made?, lengths))),
        }
    }

    /// True where pixels are at most [`WIDEST_PIXEL`] apart in the middle of the volume.
    fn has_narrow_pixels(&self, rays: &RayBasis, [width, height]: [u32; 2]) -> bool {
        let volume = &self.store.volume;
        let world_from_ix = volume.world_from_ix();
        let last = DVec3::from_array(volume.size().map(|n| f64::from(n - 1)));
        let middle = world_from_ix.transform_point3(0.5 * last);
        let [x, y] = [width, height].map(|n| 0.5 * f64::from(n));
        let origin = rays.origin + x * rays.origin_dx + y * rays.origin_dy;
        let direction = rays.direction + x * rays.direction_dx + y * rays.direction_dy;
        let lengths = origin.distance(middle) / direction.length();
        let ix_from_world = world_from_ix.matrix3.inverse();
        let is_narrow = |origin: DVec3, direction: DVec3| {
            (ix_from_world * (origin + lengths * direction)).length() <= WIDEST_PIXEL
        };
        is_narrow(rays.origin_dx, rays.direction_dx) && is_narrow(rays.origin_dy, rays.direction_dy)
    }

    /// Bytes that they take.
    pub(crate) fn beams_bytes(&self) -> u64 {
        self.beams.as_ref().map_or(0, Beams::bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_reach_to_the_end_of_the_longest_ray() {
        for segments in [1.0, 128.0, 129.0, 443.4, 1024.0, 1025.0, 8e3, 60e3] {
            let BeamLengths { shift, words } = lengths(segments);
            let reach = f64::from((32 * words) << shift);
            assert!(reach >= segments, "{segments} of {reach}");
            assert!(words <= MOST_WORDS);
            assert!(
                shift == SHORTEST_SHIFT || segments > f64::from((32 * MOST_WORDS) << (shift - 1))
            );
        }
    }
}
