//! Paths of a Monte Carlo picture: what has been summed, and for which rays.

use std::sync::Arc;

use ash::vk;

use super::RayBasis;
use crate::error::Result;
use crate::gpu::{Context, Image, ImageInfo};

/// Sums over the paths of every pixel.
pub(crate) struct Paths {
    /// Radiance.
    pub(crate) sum: Image,
    /// Its square.
    pub(crate) square: Image,
    /// What came straight through; w: field samples.
    pub(crate) through: Image,
    rays: RayBasis,
    size_px: [u32; 2],
    traced: u32,
}

impl Paths {
    pub(super) fn new(
        context: &Arc<Context>,
        name: &str,
        rays: RayBasis,
        size_px: [u32; 2],
    ) -> Result<Self> {
        let image = |part: &str| {
            Image::new(
                context,
                &ImageInfo {
                    name: &format!("{name}.paths_{part}"),
                    extent: [size_px[0], size_px[1], 1],
                    format: vk::Format::R32G32B32A32_SFLOAT,
                    three_dimensional: false,
                    usage: vk::ImageUsageFlags::STORAGE | vk::ImageUsageFlags::TRANSFER_SRC,
                },
            )
        };
        Ok(Self {
            sum: image("sum")?,
            square: image("square")?,
            through: image("through")?,
            rays,
            size_px,
            traced: 0,
        })
    }

    /// True when they are of these rays.
    pub(super) fn are_of(&self, rays: &RayBasis, size_px: [u32; 2]) -> bool {
        self.rays == *rays && self.size_px == size_px
    }

    /// Paths of every pixel.
    pub(crate) fn traced(&self) -> u32 {
        self.traced
    }

    /// Counts one more; its number.
    pub(super) fn next(&mut self) -> u32 {
        let number = self.traced;
        self.traced = self.traced.saturating_add(1);
        number
    }

    /// See [`Image::forget`].
    pub(super) fn forget(&mut self) {
        for image in [&self.sum, &self.square, &self.through] {
            image.forget();
        }
        self.traced = 0;
    }
}
