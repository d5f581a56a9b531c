//! Display colours of voxels, and one kind of their light at a time, as bricks hold it.

use std::sync::LazyLock;

use bytemuck::{Pod, Zeroable};

use super::texel::Voxel;

/// Red (0), green (1) or blue (2) of a voxel's display colour; `DECODED`: as linear light, else as it is.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(transparent)]
pub(crate) struct ColorChannel<const KIND: usize, const DECODED: bool>([u8; 4]);

/// Linear light of display values (IEC 61966-2-1), by byte.
static LINEAR: LazyLock<[f32; 256]> =
    LazyLock::new(|| std::array::from_fn(|byte| linear_from_srgb(byte as f64 / 255.0) as f32));

/// Light half-way between one display value and the next: where rounding goes up.
static HALFWAY: LazyLock<[f64; 255]> =
    LazyLock::new(|| std::array::from_fn(|byte| linear_from_srgb((byte as f64 + 0.5) / 255.0)));

/// IEC 61966-2-1 decoding of one channel. Values above 1 follow the same curve.
pub fn linear_from_srgb(display: f64) -> f64 {
    if display <= 0.04045 {
        display / 12.92
    } else {
        ((display + 0.055) / 1.055).powf(2.4)
    }
}

impl<const KIND: usize, const DECODED: bool> Voxel for ColorChannel<KIND, DECODED> {
    type Texel = u8;

    fn to_f32(self) -> f32 {
        Self::stored(self.texel())
    }

    fn texel(self) -> u8 {
        self.0[KIND]
    }

    fn nearest_texel(stored: f64) -> u8 {
        if DECODED {
            HALFWAY.partition_point(|&halfway| halfway <= stored) as u8
        } else {
            (stored + 0.5) as u8
        }
    }

    fn stored(texel: u8) -> f32 {
        if DECODED {
            LINEAR[usize::from(texel)]
        } else {
            texel.into()
        }
    }

    fn write_row(row: &[Self], to: &mut [u8]) {
        for (voxel, byte) in row.iter().zip(to) {
            *byte = voxel.texel();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{ColorChannel, Voxel};

    #[test]
    fn every_byte_is_its_own_nearest() {
        for byte in 0..=u8::MAX {
            let light = f64::from(ColorChannel::<0, true>::stored(byte));
            assert_eq!(ColorChannel::<0, true>::nearest_texel(light), byte);
        }
    }
}
