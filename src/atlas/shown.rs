//! What of the values a picture depends on: which levels are worth keeping, and which cells can be skipped.

use super::TransferTable;
use crate::scene::{March, RayProjection, Surface};
use crate::volume::select::Classify;

/// A transfer function as a projection looks at it.
#[derive(Clone, Copy)]
pub(crate) struct Shown<'a> {
    table: &'a TransferTable,
    by: By<'a>,
}

#[derive(Clone, Copy)]
enum By<'a> {
    /// What the transfer function makes visible.
    Opacity,
    /// Every value: the largest may be anywhere.
    Value,
    /// Where surfaces are; with light, what occludes them too.
    Surfaces {
        surfaces: &'a [Surface],
        occluders: bool,
    },
}

impl<'a> Shown<'a> {
    /// `lit`: there is light, which follows the transfer function whatever the projection.
    pub(crate) fn new(
        table: &'a TransferTable,
        march: &March,
        surfaces: &'a [Surface],
        lit: bool,
    ) -> Self {
        let by = match march.projection {
            RayProjection::Composite | RayProjection::Xray => By::Opacity,
            RayProjection::Maximum | RayProjection::Minimum | RayProjection::Mean => By::Value,
            RayProjection::Isosurface => By::Surfaces {
                surfaces,
                occluders: lit,
            },
        };
        Self { table, by }
    }
}

impl Classify for Shown<'_> {
    fn premultiplied(&self, value: f64) -> [f32; 7] {
        match self.by {
            By::Opacity | By::Value => self.table.premultiplied(value),
            // A step at each surface: levels matter where values change sides.
            By::Surfaces { surfaces, .. } => {
                let below = surfaces.iter().filter(|s| s.value <= value).count();
                [below as f32 / surfaces.len().max(1) as f32; 7]
            }
        }
    }

    fn visible(&self, range: [f64; 2]) -> bool {
        match self.by {
            By::Opacity => self.table.visible(range),
            By::Value => true,
            By::Surfaces {
                surfaces,
                occluders,
            } => {
                // The device computes values in 32 bits.
                let margin = 1e-6 * range[0].abs().max(range[1].abs());
                let met =
                    |s: &Surface| range[0] - margin <= s.value && s.value <= range[1] + margin;
                surfaces.iter().any(met) || (occluders && self.table.visible(range))
            }
        }
    }
}
