//! Volumes of texels in pages of 4 KiB, each a compact part of the volume.
//!
//! In an image whose rows follow each other a ray that leaves its row finds every next texel in another page of memory, and processors
//! fetch nothing ahead of it. In pages it stays in one for a dozen voxels, whatever its direction. In a page z is fastest, then x; pages
//! follow each other along x, then y. The shaders that load texels compute their places (`glsl/include/packed_pages.glsl`,
//! `glsl/include/gradient_pages.glsl`).

/// Bytes of a page.
const PAGE_BYTES: u32 = 4096;

/// How a volume is cut into pages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Pages {
    /// On x, y, z.
    counts: [u32; 3],
}

impl Pages {
    /// Pages of `shape` texels that hold `extent` texels.
    pub(crate) fn of(extent: [u32; 3], shape: [u32; 3], texel_bytes: u32) -> Self {
        debug_assert_eq!(shape.iter().product::<u32>() * texel_bytes, PAGE_BYTES);
        Self {
            counts: [0, 1, 2].map(|axis| extent[axis].div_ceil(shape[axis])),
        }
    }

    /// On x, y, z.
    pub(crate) fn counts(self) -> [u32; 3] {
        self.counts
    }

    /// In a row, and in a layer of rows.
    pub(crate) fn strides(self) -> [u32; 2] {
        [self.counts[0], self.counts[0] * self.counts[1]]
    }

    /// Of all pages.
    pub(crate) fn bytes(self) -> u64 {
        let pages = self.counts.iter().map(|&n| u64::from(n));
        pages.product::<u64>().saturating_mul(PAGE_BYTES.into())
    }
}

#[cfg(test)]
mod tests {
    use super::Pages;

    #[test]
    fn a_volume_takes_whole_pages() {
        let pages = Pages::of([9, 4, 17], [4, 4, 16], 16);
        assert_eq!(pages.counts(), [3, 1, 2]);
        assert_eq!(pages.strides(), [3, 3]);
        assert_eq!(pages.bytes(), 6 * 4096);
    }
}
