//! What a pixel of a picture shows.

use glam::DVec3;
use serde::Serialize;

use super::Session;
use crate::error::{Error, Result};
use crate::field::Field;
use crate::picture::Measured;

/// What a pixel shows. Depths are distances along its ray, mm.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PixelProbe {
    /// Column and row.
    pub pixel: [u32; 2],
    /// Linear radiance from the volume alone, premultiplied.
    pub color: [f32; 3],
    /// Accumulated opacity.
    pub opacity: f32,
    /// What lies where the picture's depth is taken ([`crate::picture::Picture::depth`]); `None` where the ray never gets as
    /// opaque as `image.depth_threshold`, and for the projection "mean", which has no depth.
    pub hit: Option<Hit>,
    /// Where half the light from behind is left; `None` where more is.
    pub median_depth: Option<f32>,
    /// Mean depth of what is seen; `None` where nothing is, and for projections that measure something else.
    pub expected_depth: Option<f32>,
    /// Optical depth of the whole ray, of the projection "xray".
    #[serde(skip_serializing_if = "Option::is_none")]
    pub optical_depth: Option<f32>,
    /// The value that was projected, of the projections "maximum", "minimum" and "mean".
    #[serde(skip_serializing_if = "Option::is_none")]
    pub projected_value: Option<f32>,
}

/// A place that a pixel shows, and the field there: of the volume at full resolution, whatever is resident.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Hit {
    /// Distance along the ray, mm.
    pub depth: f32,
    /// Position, mm, LPS.
    pub world: [f64; 3],
    /// Continuous voxel index.
    pub voxel: [f64; 3],
    /// By the march's interpolation, in the file's own units.
    pub value: f64,
    /// By the lighting's estimator, world space, values per mm.
    pub gradient: [f64; 3],
    /// The segment there, of a scene with labels.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub label: Option<HitLabel>,
}

/// A segment that a pixel shows.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HitLabel {
    /// Its number; 0 of what belongs to none.
    pub label: i32,
    /// Its name, where the file says it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
}

impl Session {
    /// Renders, and tells what the middle of a pixel (column, row from the top) shows, with the light as far as it has come.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a pixel that the picture does not have; else as [`Session::frame`].
    pub fn probe_pixel(&mut self, pixel: [u32; 2]) -> Result<PixelProbe> {
        let [width, height] = self.size();
        if pixel[0] >= width || pixel[1] >= height {
            return Err(Error::invalid(
                "pixel",
                format!(
                    "{},{} is outside of the picture; give a column from 0 to {} and a row from 0 to {}",
                    pixel[0],
                    pixel[1],
                    width - 1,
                    height - 1
                ),
            ));
        }
        let picture = self.frame()?;
        let at = pixel[1] as usize * width as usize + pixel[0] as usize;
        let [r, g, b, opacity] = picture.rgba[at];
        let measure = |what| (picture.measured == what).then_some(picture.measure[at]);
        Ok(PixelProbe {
            pixel,
            color: [r, g, b],
            opacity,
            hit: finite(picture.depth[at]).and_then(|depth| self.hit(pixel, depth)),
            median_depth: finite(picture.median_depth[at]),
            expected_depth: measure(Measured::ExpectedDepth).and_then(finite),
            optical_depth: measure(Measured::OpticalDepth),
            projected_value: measure(Measured::Value).and_then(finite),
        })
    }

    fn hit(&self, pixel: [u32; 2], depth: f32) -> Option<Hit> {
        let (origin, direction) = self
            .view
            .ray(pixel.map(|p| f64::from(p) + 0.5), self.size());
        let world = origin + f64::from(depth) * direction;
        let settings = self.settings();
        let field = Field::new(&self.renderer.loaded().store().volume);
        let voxel = field.ix_from_world().transform_point3(world);
        // Depths are 32-bit: one on the border may be a little outside.
        let inside = voxel.clamp(DVec3::ZERO, field.last_ix());
        Some(Hit {
            depth,
            world: world.to_array(),
            voxel: voxel.to_array(),
            value: field.sample(inside, settings.march.interpolation)?,
            gradient: field
                .gradient_ws(inside, settings.lighting.gradient)?
                .to_array(),
            label: self.label(inside),
        })
    }

    /// At an index position of the volume.
    fn label(&self, voxel: DVec3) -> Option<HitLabel> {
        let map = self.settings().labels.as_ref()?.map();
        let volume = &self.renderer.loaded().store().volume;
        let at = map.ix_from(volume).transform_point3(voxel);
        let label = *map.labels().get(map.index_at(at))?;
        let name = map.name(label).map(str::to_owned);
        Some(HitLabel { label, name })
    }
}

fn finite(number: f32) -> Option<f32> {
    number.is_finite().then_some(number)
}
