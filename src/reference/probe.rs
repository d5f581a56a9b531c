//! Values and light along one ray.

use glam::DVec3;

use super::{Field, Ray, Segment, Setup, Span};
use crate::scene::{LabelStyle, Lighting, Shading};

/// A ray through the field of a setup. Distances are along the ray from its origin, mm.
pub(super) struct Probe<'a> {
    pub(super) setup: &'a Setup<'a>,
    pub(super) field: Field<'a>,
    ray: Ray,
    /// Where opaque geometry ends the ray.
    end: f64,
}

impl<'a> Probe<'a> {
    pub(super) fn new(setup: &'a Setup<'a>, ray: Ray, end: f64) -> Self {
        Self {
            setup,
            field: Field::new(setup.volume),
            ray,
            end,
        }
    }

    /// The ray's segments in the field; the first is shortened by `shift` steps.
    pub(super) fn segments(&self, shift: f64) -> impl Iterator<Item = Segment> {
        let step = self.setup.march.step * self.setup.volume.min_spacing();
        self.ray
            .span(self.field.ix_from_world(), self.field.last_ix())
            .filter(|span| span.enter <= self.end)
            .into_iter()
            .flat_map(move |span| {
                let exit = span.exit.min(self.end);
                Span { exit, ..span }.segments(step, shift)
            })
    }

    /// Index position. The ray's span is inside the field; rounding must not say otherwise.
    pub(super) fn ix(&self, distance: f64) -> DVec3 {
        self.field
            .ix_from_world()
            .transform_point3(self.ray.origin + self.ray.direction * distance)
            .clamp(DVec3::ZERO, self.field.last_ix())
    }

    /// The field's value.
    pub(super) fn value(&self, distance: f64) -> f64 {
        self.field
            .sample_clamped(self.ix(distance), self.setup.march.interpolation)
    }

    /// The data's own colour, linear, where it is drawn.
    pub(super) fn data_color(&self, distance: f64) -> Option<DVec3> {
        let management = self.setup.data_color?;
        let interpolation = self.setup.march.interpolation;
        self.field
            .color(self.ix(distance), interpolation, management)
    }

    /// What the label nearest to a place says.
    pub(super) fn label(&self, distance: f64) -> LabelStyle {
        self.setup.labels.map_or(LabelStyle::PLAIN, |labels| {
            let map_ix = labels.map().ix_from(self.setup.volume);
            labels.style_at(map_ix.transform_point3(self.ix(distance)))
        })
    }

    /// The factor on reflected light: ambient light `I` times surface shading `D`.
    pub(super) fn light(&self, distance: f64) -> DVec3 {
        let ix = self.ix(distance);
        let ambient_light = self
            .setup
            .light
            .and_then(|grid| grid.sample(ix))
            .unwrap_or(DVec3::ONE);
        ambient_light * self.surface_shading(ix, self.setup.lighting)
    }

    /// 1 without shading or where the gradient is zero, else `ambient + diffuse |n . l|`. Without a direction
    /// the light is at the eye.
    fn surface_shading(&self, ix: DVec3, lighting: &Lighting) -> f64 {
        match lighting.shading {
            Shading::None => 1.0,
            Shading::Diffuse => {
                let to_light = lighting
                    .direction
                    .map_or(-self.ray.direction, |l| DVec3::from_array(l).normalize());
                self.field
                    .gradient_ws(ix, lighting.gradient)
                    .and_then(DVec3::try_normalize)
                    .map_or(1.0, |normal| {
                        lighting.ambient + lighting.diffuse * normal.dot(to_light).abs()
                    })
            }
        }
    }
}
