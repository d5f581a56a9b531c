//! What a volume is, whatever file it came from.

use std::fmt::Write as _;

use sha2::{Digest, Sha256};

use super::{LabelIndices, LabelMap, Volume, Voxels};

/// Voxels that are turned into bytes at a time.
const CHUNK: usize = 1 << 16;

impl Volume {
    /// SHA-256 (FIPS 180-4) of everything that a picture can depend on, as 64 hexadecimal digits: voxel type, size,
    /// placement, rescale, voxels, and the colours and labels beside them. Two files that decode to the same volume have the same fingerprint.
    pub fn fingerprint(&self) -> String {
        let mut hash = Sha256::new();
        hash.update(self.voxels.voxel_type().name());
        // A name ends where the size begins.
        hash.update([0]);
        self.size.iter().for_each(|n| hash.update(n.to_le_bytes()));
        let numbers = self.world_from_ix.to_cols_array();
        let rescale = [self.rescale.slope, self.rescale.intercept];
        for number in numbers.into_iter().chain(rescale) {
            hash.update(number.to_le_bytes());
        }
        match &self.voxels {
            Voxels::U8(v) => hash.update(v),
            Voxels::I8(v) => update(&mut hash, v, i8::to_le_bytes),
            Voxels::U16(v) => update(&mut hash, v, u16::to_le_bytes),
            Voxels::I16(v) => update(&mut hash, v, i16::to_le_bytes),
            Voxels::F32(v) => update(&mut hash, v, f32::to_le_bytes),
        }
        if let Some(colors) = &self.colors {
            hash.update("colors");
            hash.update(colors.as_flattened());
        }
        if let Some(labels) = &self.labels {
            update_with_labels(&mut hash, labels);
        }
        hexadecimal(hash)
    }
}

/// 64 digits.
pub(crate) fn hexadecimal(hash: Sha256) -> String {
    let digits = |mut text: String, byte: &u8| {
        // Writing to a string does not fail.
        let _ = write!(text, "{byte:02x}");
        text
    };
    hash.finalize().iter().fold(String::new(), digits)
}

fn update_with_labels(hash: &mut Sha256, map: &LabelMap) {
    map.size().iter().for_each(|n| hash.update(n.to_le_bytes()));
    let placement = map.world_from_ix().to_cols_array();
    update(hash, &placement, f64::to_le_bytes);
    update(hash, map.labels(), i32::to_le_bytes);
    match map.indices() {
        LabelIndices::U8(v) => hash.update(v),
        LabelIndices::U16(v) => update(hash, v, u16::to_le_bytes),
    }
}

/// Adds numbers, least significant byte first.
fn update<T: Copy, const N: usize>(
    hash: &mut Sha256,
    numbers: &[T],
    bytes_of: impl Fn(T) -> [u8; N],
) {
    let mut bytes = Vec::with_capacity(CHUNK * N);
    for chunk in numbers.chunks(CHUNK) {
        bytes.clear();
        bytes.extend(chunk.iter().flat_map(|&number| bytes_of(number)));
        hash.update(&bytes);
    }
}
