//! Colours for voxels that have none: files leave those of alpha 0 black, or whatever it was.
//!
//! Colours are mixed between voxels apart from opacity, so that black beside what is seen would stain its border. A voxel of
//! alpha 0 takes the mean colour of the voxels beside it that have one, ring after ring, as textures of cut-outs are padded.

use rayon::prelude::*;

/// How far colours spread, voxels: samples of coarse levels look as far.
const RINGS: usize = 16;

/// Fills in red, green and blue where alpha is 0. `size` are the voxels on x, y, z; colours of any other number stay.
pub(super) fn fill(colors: &mut [[u8; 4]], size: [u32; 3]) {
    let size = size.map(|n| n as usize);
    if size.iter().product::<usize>() != colors.len() {
        return;
    }
    let state_of = |&[.., alpha]: &[u8; 4]| if alpha > 0 { State::Known } else { State::Open };
    let mut states: Vec<State> = colors.par_iter().map(state_of).collect();
    let mut ring: Vec<usize> = (0..states.len())
        .into_par_iter()
        .filter(|&at| states.get(at) == Some(&State::Open))
        .filter(|&at| beside(at, size).any(|other| states.get(other) == Some(&State::Known)))
        .collect();
    for _ in 0..RINGS {
        let means: Vec<[u8; 4]> = ring
            .par_iter()
            .map(|&at| {
                let known = beside(at, size).filter(|&o| states.get(o) == Some(&State::Known));
                mean(known.filter_map(|other| colors.get(other).copied()))
            })
            .collect();
        let mut next = Vec::new();
        for (&at, mean) in ring.iter().zip(means) {
            if let (Some(color), Some(state)) = (colors.get_mut(at), states.get_mut(at)) {
                (*color, *state) = (mean, State::Known);
            }
        }
        for other in ring.iter().flat_map(|&at| beside(at, size)) {
            if let Some(state @ State::Open) = states.get_mut(other) {
                *state = State::Next;
                next.push(other);
            }
        }
        ring = next;
    }
}

/// Of a voxel's colour.
#[derive(Clone, Copy, PartialEq, Eq)]
enum State {
    /// The file's own, or filled in.
    Known,
    /// In the ring that is filled in next.
    Next,
    Open,
}

/// The voxel and those around it, 27 or fewer, in order.
fn beside(at: usize, [x, y, z]: [usize; 3]) -> impl Iterator<Item = usize> {
    let around = |i: usize, n: usize| i.saturating_sub(1)..(i + 2).min(n);
    let [i, j, k] = [at % x, at / x % y, at / (x * y)];
    around(k, z).flat_map(move |k| {
        around(j, y).flat_map(move |j| around(i, x).map(move |i| i + x * (j + y * k)))
    })
}

/// Of colours weighted by their alpha, which is 0 of those that were filled in: these count least.
fn mean(colors: impl Iterator<Item = [u8; 4]>) -> [u8; 4] {
    let mut sums = [0u32; 3];
    let mut weights = 0;
    for [r, g, b, alpha] in colors {
        let weight = u32::from(alpha.max(1));
        weights += weight;
        for (sum, channel) in sums.iter_mut().zip([r, g, b]) {
            *sum += weight * u32::from(channel);
        }
    }
    let [r, g, b] = sums.map(|sum| ((sum + weights / 2) / weights.max(1)) as u8);
    [r, g, b, 0]
}
