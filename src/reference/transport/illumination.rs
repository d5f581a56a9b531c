//! What light reaches a place from outside, before the volume is in its way.

use glam::DVec3;

use crate::scene::{Light, PhaseFunction};

/// Radiance from a unit direction, towards where it comes from.
pub type Surroundings<'a> = &'a (dyn Fn(DVec3) -> DVec3 + Sync);

/// The light of a scene, and how the medium scatters it.
#[derive(Clone, Copy)]
pub struct Illumination<'a> {
    /// Lights that are points or directions.
    pub lights: &'a [Light],
    /// Light from all around; `None`: dark.
    pub surroundings: Option<Surroundings<'a>>,
    /// Angular distribution of what is scattered.
    pub phase: &'a PhaseFunction,
}

/// Light of one source at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Incident {
    /// Unit vector to where it comes from.
    pub to_light: DVec3,
    /// Distance of the source, mm; infinite for directional lights.
    pub distance: f64,
    /// Power per area across the beam.
    pub irradiance: DVec3,
}

impl Illumination<'_> {
    /// What every light casts on a place, world space (mm), through nothing.
    pub fn incident(&self, place: DVec3) -> impl Iterator<Item = Incident> {
        self.lights.iter().map(move |light| incident(light, place))
    }
}

fn incident(light: &Light, place: DVec3) -> Incident {
    let from_point = |position: &[f64; 3], intensity: &[f64; 3], share: &dyn Fn(DVec3) -> f64| {
        let offset = DVec3::from_array(*position) - place;
        let to_light = offset.normalize_or_zero();
        Incident {
            to_light,
            distance: offset.length(),
            irradiance: DVec3::from_array(*intensity) * share(to_light) / offset.length_squared(),
        }
    };
    match light {
        Light::Directional {
            direction,
            irradiance,
        } => Incident {
            to_light: DVec3::from_array(*direction).normalize_or_zero(),
            distance: f64::INFINITY,
            irradiance: DVec3::from_array(*irradiance),
        },
        Light::Point {
            position,
            intensity,
        } => from_point(position, intensity, &|_| 1.0),
        Light::Spot {
            position,
            direction,
            intensity,
            beam_angle,
            cutoff_angle,
        } => {
            let beam = beam_angle.unwrap_or(0.75 * cutoff_angle);
            let axis = DVec3::from_array(*direction).normalize_or_zero();
            from_point(position, intensity, &|to_light| {
                let angle = axis.dot(-to_light).clamp(-1.0, 1.0).acos().to_degrees();
                ((cutoff_angle - angle) / (cutoff_angle - beam)).clamp(0.0, 1.0)
            })
        }
    }
}
