//! Beams of a picture: whether there are any, and what they are kept in.

use std::sync::Arc;

use super::loaded::{Loaded, NAME};
use crate::error::{Error, Result};
use crate::gpu::Context;
use crate::pass::beams::{BeamCounts, BeamLengths, Beams};

/// Words of bits for a beam, at most: with the shortest runs of segments they are enough for rays of a thousand segments.
const MOST_WORDS: u32 = 8;

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
    /// How the rays of a picture are cut into runs, where beams find out which of those show something.
    pub(super) fn beam_lengths(&self, context: &Context, size_px: [u32; 2]) -> Option<BeamLengths> {
        let march = &self.settings.march;
        let skips = march.beams && march.empty_space_skipping && self.is_uniform_grid();
        let composites = self.settings.composites();
        if !(context.capabilities().casts_beams && skips && composites) {
            return None;
        }
        // Those of the longest way, the one that a jittered start adds, and one for rounding.
        let lengths = lengths(self.longest_mm() / self.step_mm() + 2.0);
        let bytes = BeamCounts::of(size_px, self.march_tile()).run_bytes(lengths.words);
        (bytes <= context.capabilities().max_storage_bytes).then_some(lengths)
    }

    /// Bytes that they take.
    pub(crate) fn beams_bytes(&self) -> u64 {
        self.beams.as_ref().map_or(0, Beams::bytes)
    }

    /// Room for the beams of a picture; `None` where memory has none, as pictures can do without.
    pub(super) fn take_beams(
        &mut self,
        context: &Arc<Context>,
        size_px: [u32; 2],
        lengths: BeamLengths,
    ) -> Result<Option<Beams>> {
        let counts = BeamCounts::of(size_px, self.march_tile());
        let kept = self.beams.take();
        if let Some(beams) = kept.filter(|beams| beams.serve(counts, lengths.words)) {
            return Ok(Some(beams));
        }
        match Beams::new(context, NAME, counts, lengths.words) {
            Err(Error::OutOfMemory { .. }) => Ok(None),
            made => made.map(Some),
        }
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
