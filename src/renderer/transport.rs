//! Optical models beyond emission and absorption: the medium, its lights, and the light volumes that hold until one of them
//! changes.

use std::f64::consts::PI;
use std::sync::Arc;

use glam::{DAffine3, DVec3};

use super::scattered::Scattered;
use super::settings::Settings;
use crate::atlas::{
    LightGrid, Majorants, MediumExtents, MediumImages, MediumTexels, Residency, Store,
    TransferTable,
};
use crate::error::Result;
use crate::gpu::{Context, Recorder};
use crate::pass::picture::{Shadowing, TransportVariant};
use crate::pass::shadow::Sweep;
use crate::scene::{Light, OpticalModel, PhaseFunction, ShadowMethod};
use crate::shader::structs::MediumParams;
use crate::volume::Volume;

/// The medium of a volume and what lights it, on the device.
pub(super) struct Transport {
    pub(super) images: MediumImages,
    shadow: Option<LightGrid>,
    /// Sweeps that the shadow volume still lacks.
    pub(super) sweeps: Vec<Sweep>,
    /// Of null-collision tracking.
    majorants: Option<Majorants>,
    /// What is scattered besides light that comes straight from the lights.
    pub(super) scattered: Option<Scattered>,
    settings: Settings,
    volume: Arc<Volume>,
}

impl Transport {
    /// `None` where the march of emission and absorption serves.
    pub(super) fn new(
        context: &Arc<Context>,
        name: &str,
        store: &Store,
        residency: &Residency,
        table: &TransferTable,
        settings: &Settings,
    ) -> Result<Option<Self>> {
        if !settings.transports() {
            return Ok(None);
        }
        let volume = &store.volume;
        let traced = settings.traces_paths();
        let majorants = traced.then(|| {
            let sample_mm = settings.march.step * volume.min_spacing();
            Majorants::new(residency, settings.march.interpolation, table, sample_mm)
        });
        let scattered = Scattered::new(
            context,
            name,
            lengths_mm(volume),
            is_sheared(volume),
            settings,
        )?;
        let solved = settings.lighting.model == OpticalModel::MultipleScattering && !traced;
        // Solvers take what comes straight from the lights from the sweep, whatever the march does.
        let swept = solved || (shadowing(settings) == Shadowing::Swept && !traced);
        let shadow = (swept && !settings.lighting.lights.is_empty()).then(|| {
            let spacing = settings.lighting.shadows.spacing * volume.min_spacing();
            LightGrid::spaced(lengths_mm(volume), spacing)
        });
        let lights = settings.lighting.lights.len() as u32;
        let images = MediumImages::new(
            context,
            name,
            &MediumExtents {
                shadow: shadow.map(|grid| (grid, lights)),
                scattered: scattered.as_ref().map(Scattered::grid),
                majorant: traced.then(|| residency.cells.counts()),
                environment: settings.environment.as_ref().map(|map| map.size()),
            },
        )?;
        let mut transport = Self {
            images,
            shadow,
            sweeps: Vec::new(),
            majorants,
            scattered,
            settings: settings.clone(),
            volume: volume.clone(),
        };
        transport.restart();
        Ok(Some(transport))
    }

    /// True when `settings` leave everything as it is.
    pub(super) fn serves(&self, settings: &Settings) -> bool {
        let old = &self.settings;
        settings.curve == old.curve
            && settings.lighting == old.lighting
            && settings.environment == old.environment
            && settings.labels == old.labels
            && settings.march == old.march
            && settings.storage == old.storage
    }

    /// The light volumes are computed anew.
    pub(super) fn restart(&mut self) {
        let ix_from_world = self.volume.world_from_ix().inverse();
        let field = DVec3::from(self.volume.size().map(|n| f64::from(n - 1)));
        self.sweeps = match self.shadow {
            None => Vec::new(),
            Some(_) => (self.settings.lighting.lights.iter().zip(0..))
                .map(|(light, index)| sweep_of(light, index, ix_from_world, field))
                .collect(),
        };
    }

    /// See [`crate::gpu::Image::forget`].
    pub(super) fn forget(&mut self) {
        self.images.forget();
        self.scattered.iter_mut().for_each(Scattered::forget);
        self.restart();
    }

    pub(super) fn shadow_grid(&self) -> Option<LightGrid> {
        self.shadow
    }

    /// Uploads what the images lack.
    pub(super) fn record_images(
        &mut self,
        context: &Arc<Context>,
        recorder: &mut Recorder<'_>,
    ) -> Result<()> {
        let texels = MediumTexels {
            environment: self.settings.environment.as_deref(),
            phase: &self.settings.lighting.phase,
            majorants: self.majorants.as_ref().map_or(&[], |m| &m.cells),
        };
        self.images.record(context, recorder, &texels)
    }

    /// True when every sample of the march sends rays to the lights.
    pub(super) fn casts_shadow_rays(&self) -> bool {
        !self.settings.traces_paths() && shadowing(&self.settings) == Shadowing::Rays
    }

    /// What specializes the march.
    pub(super) fn variant(&self) -> TransportVariant {
        let lighting = &self.settings.lighting;
        TransportVariant {
            model: lighting.model,
            phase: phase_kind(&lighting.phase),
            glows: self.settings.curve.glows(),
            shadows: match self.shadow {
                None if shadowing(&self.settings) == Shadowing::Swept => Shadowing::None,
                _ => shadowing(&self.settings),
            },
            reflectance: lighting.reflectance,
            environment: environment_kind(&self.settings),
            chromatic: is_chromatic(&self.settings),
            scattered: self.scattered.is_some(),
            paths: (self.settings.traces_paths()).then_some(lighting.scattering.majorant),
        }
    }

    /// `sample_slope`: texture samples per unit of value; `sample_mm`: length of a whole sample.
    pub(super) fn params(&self, sample_mm: f64, samples_per_value: f64) -> MediumParams {
        let Settings {
            lighting, curve, ..
        } = &self.settings;
        let world_from_ix = self.volume.world_from_ix();
        let vector = world_from_ix.matrix3.inverse();
        let three = |v: [f64; 3]| v.map(|c| c as f32);
        let row = |r: DVec3, last: f64| r.extend(last).as_vec4().to_array();
        let ws = |axis: usize| {
            row(
                world_from_ix.matrix3.row(axis),
                world_from_ix.translation[axis],
            )
        };
        let ix = |axis: usize| row(vector.row(axis), 0.0);
        let lights = Lights::of(&lighting.lights);
        let range = match (curve.points.first(), curve.points.last()) {
            (Some(first), Some(last)) if last.value > first.value => last.value - first.value,
            _ => 1.0,
        };
        // The gradient comes in texture samples per mm.
        let strength = lighting.strength / (range * samples_per_value);
        let surface = [
            strength,
            lighting.specular,
            lighting.shininess,
            lighting.roughness,
        ];
        let (factor, up, visible) = match &lighting.environment {
            Some(e) => {
                let factor = e.radiance.unwrap_or([1.0; 3]).map(|c| c * e.scale);
                (factor, e.up, e.visible)
            }
            None => ([0.0; 3], [0.0, 0.0, 1.0], false),
        };
        let [x, y, z] = environment_axes(up);
        // Light without opacity is gathered at tentative collisions: some must happen where nothing is opaque.
        let least_majorant = if curve.glows() {
            (0.25 / self.volume.min_spacing()) as f32
        } else {
            0.0
        };
        let scattered = self.scattered.as_ref().map_or([1; 3], |s| s.grid().points);
        let shadow = self.shadow.map_or([1; 3], |grid| grid.points);
        MediumParams {
            extinction: three(lighting.extinction),
            sample_mm: sample_mm as f32,
            albedo: three(lighting.albedo),
            unit_exponent: (sample_mm / curve.unit_distance) as f32,
            phase: phase_parameters(&lighting.phase),
            surface: surface.map(|c| c as f32),
            tracking: [
                self.majorants
                    .as_ref()
                    .map_or(0.0, |m| m.global.max(least_majorant)),
                least_majorant,
                lighting.scattering.max_scatterings as f32,
                0.0,
            ],
            environment: DVec3::from(factor)
                .extend(f64::from(u8::from(visible)))
                .as_vec4()
                .to_array(),
            environment_x: row(x, 0.0),
            environment_y: row(y, 0.0),
            environment_z: row(z, 0.0),
            ws_from_ix_x: ws(0),
            ws_from_ix_y: ws(1),
            ws_from_ix_z: ws(2),
            ix_from_ws_x: ix(0),
            ix_from_ws_y: ix(1),
            ix_from_ws_z: ix(2),
            shadow_points: shadow.map(|n| n as i32),
            unit_mm: curve.unit_distance as f32,
            scatter_points: scattered.map(|n| n as i32),
            light_count: lighting.lights.len() as u32,
            light_place: lights.place,
            light_color: lights.color,
            light_axis: lights.axis,
        }
    }
}

/// How the light that reaches a sample is known.
fn shadowing(settings: &Settings) -> Shadowing {
    let lighting = &settings.lighting;
    match (lighting.model, lighting.shadows.method) {
        (OpticalModel::ShadowedScattering | OpticalModel::MultipleScattering, method) => {
            match method {
                ShadowMethod::Sweep => Shadowing::Swept,
                ShadowMethod::Rays => Shadowing::Rays,
            }
        }
        _ => Shadowing::None,
    }
}

fn is_chromatic(settings: &Settings) -> bool {
    let [r, g, b] = settings.lighting.extinction;
    r != g || g != b
}

/// The shaders' `ENVIRONMENT`.
pub(super) fn environment_kind(settings: &Settings) -> u32 {
    match (&settings.lighting.environment, &settings.environment) {
        (None, _) => 0,
        (Some(_), None) => 1,
        (Some(_), Some(_)) => 2,
    }
}

/// The shaders' `PHASE`.
pub(super) fn phase_kind(phase: &PhaseFunction) -> u32 {
    match phase {
        PhaseFunction::Isotropic => 0,
        PhaseFunction::HenyeyGreenstein { .. } => 1,
        PhaseFunction::DoubleHenyeyGreenstein { .. } => 2,
        PhaseFunction::Rayleigh => 3,
        PhaseFunction::Schlick { .. } => 4,
        PhaseFunction::LambertSphere => 5,
        PhaseFunction::Table { .. } => 6,
    }
}

fn phase_parameters(phase: &PhaseFunction) -> [f32; 4] {
    let parameters = match *phase {
        PhaseFunction::HenyeyGreenstein { g } => [g, 0.0, 0.0],
        PhaseFunction::DoubleHenyeyGreenstein { g1, g2, weight } => [g1, g2, weight],
        PhaseFunction::Schlick { k } => [k, 0.0, 0.0],
        PhaseFunction::Isotropic
        | PhaseFunction::Rayleigh
        | PhaseFunction::LambertSphere
        | PhaseFunction::Table { .. } => [0.0; 3],
    };
    let [x, y, z] = parameters.map(|p| p as f32);
    [x, y, z, 0.0]
}

/// Lights as the shaders take them.
#[derive(Default)]
struct Lights {
    place: [[f32; 4]; 8],
    color: [[f32; 4]; 8],
    axis: [[f32; 4]; 8],
}

impl Lights {
    fn of(lights: &[Light]) -> Self {
        let mut all = Self::default();
        let vec4 = |v: [f64; 3], w: f64| DVec3::from(v).extend(w).as_vec4().to_array();
        let unit = |v: [f64; 3]| DVec3::from(v).normalize_or_zero().to_array();
        for (i, light) in lights.iter().enumerate() {
            (all.place[i], all.color[i], all.axis[i]) = match *light {
                Light::Directional {
                    direction,
                    irradiance,
                } => (vec4(unit(direction), 0.0), vec4(irradiance, 0.0), [0.0; 4]),
                Light::Point {
                    position,
                    intensity,
                } => (vec4(position, 1.0), vec4(intensity, 0.0), [0.0; 4]),
                Light::Spot {
                    position,
                    direction,
                    intensity,
                    beam_angle,
                    cutoff_angle,
                } => {
                    let beam = beam_angle.unwrap_or(0.75 * cutoff_angle);
                    (
                        vec4(position, 1.0),
                        vec4(intensity, cutoff_angle * PI / 180.0),
                        vec4(unit(direction), beam * PI / 180.0),
                    )
                }
            };
        }
        all
    }
}

/// Axes of an environment map: z towards its upper edge, x towards its middle column.
fn environment_axes(up: [f64; 3]) -> [DVec3; 3] {
    let z = DVec3::from(up).normalize_or(DVec3::Z);
    // World x, or what of it is across `up`; world y where they are parallel.
    let across = DVec3::X - z * z.x;
    let x = if across.length() > 1e-6 {
        across.normalize()
    } else {
        (DVec3::Y - z * z.y).normalize_or(DVec3::Y)
    };
    [x, z.cross(x), z]
}

/// True when axes of the grid are not at right angles.
fn is_sheared(volume: &Volume) -> bool {
    let axes = volume.world_from_ix().matrix3;
    let [x, y, z] = [axes.x_axis, axes.y_axis, axes.z_axis].map(|a| a.normalize_or_zero());
    [x.dot(y), y.dot(z), z.dot(x)]
        .iter()
        .any(|c| c.abs() > 1e-4)
}

fn lengths_mm(volume: &Volume) -> [f64; 3] {
    let (size, spacing) = (volume.size(), volume.spacing());
    std::array::from_fn(|a| f64::from(size[a] - 1) * spacing[a])
}

/// The axis along which all of the volume lies on one side of the light, farthest from it.
fn sweep_of(light: &Light, index: u32, ix_from_world: DAffine3, field: DVec3) -> Sweep {
    let sweep = |axis, from_end| Sweep {
        light: index,
        axis,
        from_end,
    };
    match light {
        Light::Directional { direction, .. } => {
            let d = ix_from_world.transform_vector3(DVec3::from(*direction)) / field;
            let axis = largest(d.abs());
            sweep(axis, Some(d[axis] > 0.0))
        }
        Light::Point { position, .. } | Light::Spot { position, .. } => {
            let p = ix_from_world.transform_point3(DVec3::from(*position)) / field;
            // How far beyond the near face, in lengths of the field.
            let beyond = (p - DVec3::ONE).max(-p);
            let axis = largest(beyond);
            let outside = beyond[axis] > 1e-6;
            sweep(axis, outside.then_some(p[axis] > 1.0))
        }
    }
}

fn largest(v: DVec3) -> usize {
    let [x, y, z] = v.to_array();
    if x >= y && x >= z {
        0
    } else if y >= z {
        1
    } else {
        2
    }
}
