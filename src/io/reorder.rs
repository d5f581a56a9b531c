//! Arrays whose first index is x, from those whose last index is.

use rayon::prelude::*;

use super::decoded::Decoded;
use super::payload::reserve;
use crate::error::Result;
use crate::volume::Voxels;

/// Turns `array[z, y, x]` with z fastest into one with x fastest. `size` counts z, y, x.
pub(super) fn from_first_fastest(decoded: Decoded, size: [u32; 3]) -> Result<Decoded> {
    let voxels = match decoded {
        Decoded::Numbers(voxels) => voxels,
        Decoded::Colors(v) => return Ok(Decoded::Colors(transpose(&v, size)?)),
    };
    Ok(Decoded::Numbers(match voxels {
        Voxels::U8(v) => Voxels::U8(transpose(&v, size)?),
        Voxels::I8(v) => Voxels::I8(transpose(&v, size)?),
        Voxels::U16(v) => Voxels::U16(transpose(&v, size)?),
        Voxels::I16(v) => Voxels::I16(transpose(&v, size)?),
        Voxels::F32(v) => Voxels::F32(transpose(&v, size)?),
    }))
}

fn transpose<T: Copy + Default + Send + Sync>(from: &[T], size: [u32; 3]) -> Result<Vec<T>> {
    let [z, y, x] = size.map(|n| n as usize);
    let mut to = reserve(from.len())?;
    to.resize(from.len(), T::default());
    to.par_chunks_mut(x * y).enumerate().for_each(|(k, plane)| {
        for (j, row) in plane.chunks_mut(x).enumerate() {
            let column = from.get(k + j * z..).unwrap_or_default().iter();
            for (to, &value) in row.iter_mut().zip(column.step_by(z * y)) {
                *to = value;
            }
        }
    });
    Ok(to)
}
