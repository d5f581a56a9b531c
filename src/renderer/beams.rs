//! Beams of a picture: whether there are any, and what they are kept in.

use std::sync::Arc;

use glam::DVec3;

use super::RayBasis;
use super::loaded::{Loaded, NAME};
use super::settings::Settings;
use crate::error::{Error, Result};
use crate::gpu::Context;
use crate::pass::Rectangle;
use crate::pass::beams::{BEAM_PX, BeamCounts, BeamLengths, Beams};
use crate::scene::Shading;
use crate::volume::cells::SKIP_CELLS;

/// Words of bits for a beam, at most, where a bit stands for a run of segments: with the shortest runs they are enough for rays of a
/// thousand segments.
const MOST_WORDS: u32 = 8;

/// Bits for each of the shortest runs where cells between voxels are looked up, one for every segment of it.
const SINGLE_BITS: u32 = 4;

// An entry of a list of beams has 4 bits for where such words begin and end, in fours (glsl/include/beams.glsl).
const _: () = assert!(SINGLE_BITS == 4 && 2 * MOST_WORDS <= 1 << 4);

/// Voxels from a pixel to the next, in the middle of the volume, up to which beams pay: the boxes around rays that are farther apart meet
/// too many cells that no ray does. Of 256³ voxels, 512 × 512 pixels have 0.6 (time 0.64 to 0.91), 192 × 192 have 1.6 (0.83 to 1.02),
/// 96 × 96 have 3.2 (0.94 to 2.29).
const WIDEST_PIXEL: f64 = 2.0;

/// The same up to which beams look cells between voxels up: larger boxes meet too many of them.
const WIDEST_FOR_CELLS: f64 = 1.0;

/// Share of the cells between voxels, of those in skip cells that show something, that do so, up to which looking them up costs less than
/// the samples that it saves; where samples are shaded, lit, looked up among labels or integrated they cost more.
const MOST_SHOWN: f64 = 0.65;
const MOST_SHOWN_OF_DEAR: f64 = 0.9;

/// Segments of the shortest runs, as a power of two. A skip cell is as many voxels long.
const SHORTEST_SHIFT: u32 = 2;

/// Bits for rays of so many segments. `singly`: one for each segment, of rays of up to 2048.
fn lengths(segments: f64, singly: bool) -> BeamLengths {
    let words = |shift: u32| (segments / f64::from(32 << shift)).ceil().max(1.0);
    let shift = (SHORTEST_SHIFT..SHORTEST_SHIFT + 16)
        .find(|&shift| words(shift) <= f64::from(MOST_WORDS))
        .unwrap_or(SHORTEST_SHIFT + 16);
    let singly = singly && words(SHORTEST_SHIFT) <= f64::from(2 * MOST_WORDS);
    if singly {
        return BeamLengths {
            shift: 0,
            words: SINGLE_BITS * words(SHORTEST_SHIFT) as u32,
            singly,
        };
    }
    BeamLengths {
        shift,
        words: words(shift).min(f64::from(MOST_WORDS)) as u32,
        singly,
    }
}

/// Up to which share of cells between voxels beams look them up; `None` where there are no beams.
pub(super) fn most_shown(context: &Context, settings: &Settings) -> Option<f64> {
    let dear = settings.lighting.shading == Shading::Diffuse
        || settings.is_preintegrated()
        || settings.ambient_occlusion.is_some()
        || settings.labels.is_some();
    let most = if dear { MOST_SHOWN_OF_DEAR } else { MOST_SHOWN };
    (context.capabilities().casts_beams && casts(settings)).then_some(most)
}

fn casts(settings: &Settings) -> bool {
    let march = &settings.march;
    march.beams && march.empty_space_skipping && settings.composites()
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
        let capabilities = context.capabilities();
        let serves = capabilities.casts_beams && casts(&self.settings);
        if !serves || !self.has_narrow_pixels(rays, size_px, WIDEST_PIXEL) {
            return Ok(None);
        }
        // Cells between voxels are those of the finest level.
        let look_up = self.images.shown_cells.is_some()
            && self.is_uniform_grid()
            && self.has_narrow_pixels(rays, size_px, WIDEST_FOR_CELLS);
        // Those of the longest way, the one that a jittered start adds, and one for rounding.
        let segments = self.longest_mm() / self.step_mm() + 2.0;
        let counts = BeamCounts::of(size_px, self.march_tile(), capabilities.dispatch_runs);
        let mut kept = kept;
        // Fewer bits where single ones are too many.
        for singly in [true, false] {
            let lengths = lengths(segments, singly && look_up);
            if counts.most_bytes(lengths.words) > capabilities.max_storage_bytes {
                continue;
            }
            kept = kept.filter(|beams| beams.serve(counts, lengths.words));
            if let Some(beams) = kept {
                return Ok(Some((beams, lengths)));
            }
            match Beams::new(context, NAME, counts, lengths.words) {
                Err(Error::OutOfMemory { .. }) => {}
                made => return Ok(Some((made?, lengths))),
            }
        }
        Ok(None)
    }

    /// The pixels whose rays may meet something that shows, and some around them, from where a beam begins: which rays share one does not
    /// depend on it.
    pub(super) fn shown_pixels(&self, rays: &RayBasis, size_px: [u32; 2]) -> Rectangle {
        let nowhere = Rectangle::of_size([0; 2]);
        let Some([first, last]) = self.visibility.bounds() else {
            return nowhere;
        };
        let volume = &self.store.volume;
        let world_from_ix = volume.world_from_ix();
        // The device rounds places along rays that may come from afar.
        let far_ix = world_from_ix.inverse().transform_point3(rays.origin);
        let mut margin = DVec3::splat(0.02 + 1e-6 * far_ix.abs().max_element());
        if self.settings.is_preintegrated() && !self.is_uniform_grid() {
            // Where only one end of a segment lies in a brick, the other is read at the nearest place of that, beside the ray
            // (march_ends.glsl).
            let axes_ix = world_from_ix.matrix3.inverse().transpose();
            margin += self.step_mm()
                * DVec3::from_array([0, 1, 2].map(|axis| axes_ix.col(axis).length()));
        }
        let margin = margin.to_array();
        let corners: [DVec3; 8] = std::array::from_fn(|corner| {
            let ix = [0, 1, 2].map(|axis| {
                if corner >> axis & 1 == 0 {
                    f64::from(SKIP_CELLS * first[axis]) - margin[axis]
                } else {
                    f64::from(SKIP_CELLS * (last[axis] + 1)) + margin[axis]
                }
            });
            world_from_ix.transform_point3(DVec3::from_array(ix))
        });
        let Some(seen) = rays.rectangle_of(&corners) else {
            return Rectangle::of_size(size_px);
        };
        // Pixels are rounded as well.
        let [low, high] = [seen[0] - 1.0, seen[1] + 1.0].map(|pixel| pixel.to_array());
        let pixel = |axis: usize, pixel: f64| pixel.clamp(0.0, size_px[axis].into()) as u32;
        let area = Rectangle {
            first: [0, 1].map(|axis| pixel(axis, low[axis]) / BEAM_PX[axis] * BEAM_PX[axis]),
            end: [0, 1].map(|axis| pixel(axis, high[axis].ceil())),
        };
        let is_empty = (0..2).any(|axis| area.first[axis] >= area.end[axis]);
        if is_empty { nowhere } else { area }
    }

    /// True where pixels are at most so many voxels apart in the middle of the volume.
    fn has_narrow_pixels(&self, rays: &RayBasis, [width, height]: [u32; 2], most: f64) -> bool {
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
            (ix_from_world * (origin + lengths * direction)).length() <= most
        };
        is_narrow(rays.origin_dx, rays.direction_dx) && is_narrow(rays.origin_dy, rays.direction_dy)
    }

    /// Bytes that they take, with the cells that they look up.
    pub(crate) fn beams_bytes(&self) -> u64 {
        let cells = self.images.shown_cells.as_ref();
        self.beams.as_ref().map_or(0, Beams::bytes) + cells.map_or(0, |c| c.buffer().bytes())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_reach_to_the_end_of_the_longest_ray() {
        for segments in [1.0, 128.0, 129.0, 443.4, 1024.0, 1025.0, 2049.0, 8e3, 60e3] {
            for wanted in [false, true] {
                let lengths = lengths(segments, wanted);
                let BeamLengths {
                    shift,
                    words,
                    singly,
                } = lengths;
                let reach = f64::from((32 * words) << shift);
                assert!(reach >= segments, "{segments} of {reach}");
                assert_eq!(singly, wanted && segments <= 2048.0);
                if singly {
                    assert_eq!(shift, 0);
                    assert!(words.is_multiple_of(SINGLE_BITS), "{words}");
                    continue;
                }
                assert!(words <= MOST_WORDS);
                assert!(
                    shift == SHORTEST_SHIFT
                        || segments > f64::from((32 * MOST_WORDS) << (shift - 1))
                );
            }
        }
    }
}
