//! Unevenly spaced slices, interpolated onto an even grid.

use std::path::Path;

use rayon::prelude::*;

use super::super::Limits;
use super::super::decoded::Decoded;
use super::super::payload::reserve;
use super::super::source::bad;
use super::Grid;
use crate::error::Result;
use crate::volume::Voxels;

/// Interpolates linearly between neighbouring slices. `positions` are where the slices of `voxels` lie, in units of
/// the new step, ascending from 0. Gives back how many slices there are now.
pub(super) fn onto_even_slices(
    path: &Path,
    decoded: Decoded,
    grid: Grid,
    positions: &[f64],
    limits: &Limits,
) -> Result<(Decoded, u64)> {
    // Rounding puts the last slice half a step away at most; the end is kept inside what was measured.
    let last = positions.last().copied().unwrap_or_default();
    let slices = (last + 1e-6).floor() + 1.0;
    let [x, y, _] = grid.size;
    let plane = x as usize * y as usize;
    if slices * plane as f64 > limits.max_voxels as f64 {
        return Err(bad(
            path,
            format!("{slices} slices would be needed for an even spacing, more than the limit"),
        ));
    }
    let even = Even {
        positions,
        plane,
        slices: slices as usize,
    };
    let slices = slices as u64;
    let voxels = match decoded {
        Decoded::Numbers(voxels) => voxels,
        Decoded::Colors(v) => return Ok((Decoded::Colors(even.interpolate(&v, mixed)?), slices)),
    };
    let voxels = match voxels {
        Voxels::U8(v) => {
            Voxels::U8(even.interpolate(&v, |a, b, share| between(a, b, share).round() as u8)?)
        }
        Voxels::I8(v) => {
            Voxels::I8(even.interpolate(&v, |a, b, share| between(a, b, share).round() as i8)?)
        }
        Voxels::U16(v) => {
            Voxels::U16(even.interpolate(&v, |a, b, share| between(a, b, share).round() as u16)?)
        }
        Voxels::I16(v) => {
            Voxels::I16(even.interpolate(&v, |a, b, share| between(a, b, share).round() as i16)?)
        }
        Voxels::F32(v) => Voxels::F32(even.interpolate(&v, between)?),
    };
    Ok((voxels.into(), slices))
}

fn between<T: Into<f32>>(a: T, b: T, share: f32) -> f32 {
    let (a, b): (f32, f32) = (a.into(), b.into());
    a + (b - a) * share
}

fn mixed([r, g, b, a]: [u8; 4], [r2, g2, b2, a2]: [u8; 4], share: f32) -> [u8; 4] {
    [(r, r2), (g, g2), (b, b2), (a, a2)].map(|(a, b)| between(a, b, share).round() as u8)
}

struct Even<'a> {
    positions: &'a [f64],
    plane: usize,
    slices: usize,
}

impl Even<'_> {
    fn interpolate<T: Copy + Default + Send + Sync>(
        &self,
        voxels: &[T],
        mix: impl Fn(T, T, f32) -> T + Sync,
    ) -> Result<Vec<T>> {
        let mut out = reserve(self.plane * self.slices)?;
        out.resize(self.plane * self.slices, T::default());
        out.par_chunks_mut(self.plane)
            .enumerate()
            .for_each(|(k, out)| {
                let (below, share) = self.neighbours(k as f64);
                let plane = |slice: usize| {
                    let start = slice * self.plane;
                    voxels.get(start..start + self.plane).unwrap_or_default()
                };
                let above = (below + 1).min(self.positions.len().saturating_sub(1));
                for ((out, &a), &b) in out.iter_mut().zip(plane(below)).zip(plane(above)) {
                    *out = mix(a, b, share);
                }
            });
        Ok(out)
    }

    /// The slice at or before a position, and the share of the one after it.
    fn neighbours(&self, position: f64) -> (usize, f32) {
        let below = self
            .positions
            .partition_point(|&p| p <= position)
            .saturating_sub(1);
        let at = self.positions.get(below).copied().unwrap_or_default();
        let share = match self.positions.get(below + 1) {
            Some(next) => (position - at) / (next - at),
            None => 0.0,
        };
        (below, share.clamp(0.0, 1.0) as f32)
    }
}
