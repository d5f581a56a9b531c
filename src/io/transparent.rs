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
    let mut known: Vec<bool> = colors.par_iter().map(|&[.., alpha]| alpha > 0).collect();
    let all = 0..known.len();
    let is_open = |known: &[bool], at: usize| known.get(at) == Some(&false);
    let mut ring: Vec<usize> = all
        .into_par_iter()
        .filter(|&at| is_open(&known, at) && beside(at, size).any(|other| !is_open(&known, other)))
        .collect();
    for _ in 0..RINGS {
        let means: Vec<[u8; 4]> = ring
            .par_iter()
            .map(|&at| {
                let others = beside(at, size).filter(|&other| !is_open(&known, other));
                mean(others.filter_map(|other| colors.get(other).copied()))
            })
            .collect();
        for (&at, mean) in ring.iter().zip(means) {
            if let (Some(color), Some(known)) = (colors.get_mut(at), known.get_mut(at)) {
                (*color, *known) = (mean, true);
            }
        }
        let next = ring
            .par_iter()
            .flat_map_iter(|&at| beside(at, size).filter(|&other| is_open(&known, other)));
        let mut next: Vec<usize> = next.collect();
        next.par_sort_unstable();
        next.dedup();
        ring = next;
    }
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
