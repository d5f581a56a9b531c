//! What decoders give: numbers, or colours with the number that stands for each of them.

use rayon::prelude::*;

use super::components::LUMA;
use super::payload::reserve;
use super::transparent;
use crate::error::Result;
use crate::volume::Voxels;

/// Voxels of a file.
pub(super) enum Decoded {
    Numbers(Voxels),
    /// Red, green, blue and alpha, 255 where the file has none.
    Colors(Vec<[u8; 4]>),
}

impl From<Voxels> for Decoded {
    fn from(voxels: Voxels) -> Self {
        Self::Numbers(voxels)
    }
}

impl Decoded {
    /// The numbers that a transfer function classifies, and the colours. The number of a colour is its alpha where that tells
    /// voxels apart, else its luminance. Where it is alpha, voxels of alpha 0 get colours from those beside them. `size` are the
    /// voxels on x, y, z.
    pub(super) fn into_parts(self, size: [u32; 3]) -> Result<(Voxels, Option<Vec<[u8; 4]>>)> {
        let mut colors = match self {
            Self::Numbers(voxels) => return Ok((voxels, None)),
            Self::Colors(colors) => colors,
        };
        let first = colors.first().map_or(255, |&[.., alpha]| alpha);
        let has_alpha = colors.par_iter().any(|&[.., alpha]| alpha != first);
        let number = |&[r, g, b, alpha]: &[u8; 4]| {
            if has_alpha {
                alpha
            } else {
                luminance([r, g, b])
            }
        };
        let mut numbers = reserve(colors.len())?;
        colors.par_iter().map(number).collect_into_vec(&mut numbers);
        if has_alpha {
            transparent::fill(&mut colors, size);
        }
        Ok((Voxels::U8(numbers), Some(colors)))
    }
}

/// Of the values as stored, rounded.
fn luminance(color: [u8; 3]) -> u8 {
    let shares = color.iter().zip(LUMA);
    let sum: f32 = shares.map(|(&c, share)| share * f32::from(c)).sum();
    sum.round() as u8
}
