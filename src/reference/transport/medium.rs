//! Optical properties at every place of a volume.

use glam::DVec3;

use crate::analytic::extinction;
use crate::error::{Error, Result};
use crate::field::Field;
use crate::reference::{Ray, Span};
use crate::scene::{Curve, Interpolation, Lighting};
use crate::volume::Volume;

/// A volume, and what its values mean.
pub struct Medium<'a> {
    field: Field<'a>,
    curve: &'a Curve,
    extinction_factors: DVec3,
    albedo_factors: DVec3,
    emission: bool,
    majorant: f64,
}

/// What holds at a place, by channel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Optics {
    /// `tau`, 1/mm.
    pub extinction: DVec3,
    /// The transfer function's colour: `C` of the particle model.
    pub color: DVec3,
    /// Share of the extinction that scatters.
    pub albedo: DVec3,
    /// Radiance added per mm whatever is there to scatter: the transfer function's `source`, and its emission times
    /// `tau`.
    pub glow: DVec3,
}

impl<'a> Medium<'a> {
    /// The medium of a scene; its field is trilinear.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a transfer function that is opaque somewhere: its extinction is infinite.
    pub fn new(volume: &'a Volume, curve: &'a Curve, lighting: &Lighting) -> Result<Self> {
        let largest = curve.points.iter().map(|p| p.optical.opacity);
        let largest = largest.fold(0.0, f64::max);
        let majorant = extinction(largest, curve.unit_distance)
            * lighting.extinction.into_iter().fold(0.0, f64::max);
        if !majorant.is_finite() {
            return Err(Error::invalid(
                "transfer_function",
                "is opaque at some value; light transport needs opacities below 1",
            ));
        }
        Ok(Self {
            field: Field::new(volume),
            curve,
            extinction_factors: DVec3::from_array(lighting.extinction),
            albedo_factors: DVec3::from_array(lighting.albedo),
            emission: lighting.emission,
            majorant,
        })
    }

    /// Properties at a place, world space (mm); nothing outside the field.
    pub fn at(&self, place: DVec3) -> Optics {
        let ix = self.field.ix_from_world().transform_point3(place);
        self.field
            .sample(ix, Interpolation::Linear)
            .map_or(Optics::default(), |value| self.of_value(value))
    }

    fn of_value(&self, value: f64) -> Optics {
        let optical = self.curve.evaluate(value);
        let unit = self.curve.unit_distance;
        let extinction = extinction(optical.opacity, unit) * self.extinction_factors;
        let color = DVec3::from_array(optical.color);
        let emission = if self.emission {
            DVec3::from_array(optical.emission)
        } else {
            DVec3::ZERO
        };
        Optics {
            extinction,
            color,
            albedo: color * self.albedo_factors,
            glow: emission * extinction + DVec3::from_array(optical.source) / unit,
        }
    }

    /// The part of a ray in the field.
    pub fn span(&self, ray: Ray) -> Option<Span> {
        ray.span(self.field.ix_from_world(), self.field.last_ix())
    }

    /// What no channel's extinction exceeds anywhere, 1/mm.
    pub fn majorant(&self) -> f64 {
        self.majorant
    }
}
