//! Ranges of everything in a scene that does not need the volume.

mod lighting;
mod march;

use std::fmt::Debug;
use std::ops::RangeInclusive;

use lighting::check_lighting;
pub(crate) use lighting::check_together;
use march::check_march;

use super::{
    AmbientOcclusion, Image, Lighting, March, RawDescription, RaySampling, Scene, Storage,
    TransferFunction, VolumeColor, check_data_color,
};
use crate::error::{Error, Result};

/// Largest width or height of a picture, pixels.
pub const MAX_IMAGE_SIZE: u32 = 16_384;
/// Largest exposure, stops, either way.
pub const MAX_EXPOSURE: f64 = 64.0;
/// Shortest march or ambient occlusion step, voxels.
pub const MIN_STEP: f64 = 0.001;
/// Most directions of ambient occlusion.
pub const MAX_RAYS: u32 = 65_536;
/// Most samples on one ambient occlusion ray.
pub const MAX_SAMPLES_PER_RAY: u32 = 65_536;
/// How much longer each distance between samples on an ambient occlusion ray may be than the one before, parts.
const GROWTHS: RangeInclusive<f64> = 0.05..=1.0;
/// Most isosurfaces of a picture.
pub const MAX_ISOSURFACES: usize = 8;
/// Largest emission of a scene file, display value. Decoded it is 16320: half floats, which hold the light, end at 65504.
pub const MAX_EMISSION: f64 = 60.0;
/// Largest linear emission.
const MAX_LINEAR_EMISSION: f64 = 30_000.0;

impl Scene {
    /// Checks every range. What parses from a scene file has passed; call it on a scene that code has put together.
    ///
    /// # Errors
    /// [`Error::Invalid`] naming the first key that is out of range, its value and what would be valid.
    pub fn validate(&self) -> Result<()> {
        self.volume.validate()?;
        if let Some(raw) = &self.volume.raw {
            check_raw(raw)?;
        }
        if let Some(labels) = &self.volume.labels {
            labels.validate()?;
        }
        if self.volume.color == Some(VolumeColor::Data) {
            check_data_color(&self.march, &self.lighting, false)?;
            if self.volume.channel.is_some() {
                return Err(Error::invalid(
                    "volume.color",
                    "\"data\" draws all channels as colours, volume.channel reads one of them; give one of the two",
                ));
            }
        }
        self.camera.validate()?;
        check_image(&self.image)?;
        self.transfer_function.validate()?;
        check_march(&self.march)?;
        check_lighting(&self.lighting)?;
        check_together(&self.march, &self.lighting, self.ambient_occlusion.as_ref())?;
        if let Some(occlusion) = &self.ambient_occlusion {
            check_occlusion(occlusion)?;
        }
        check_storage(&self.storage)
    }
}

/// An error naming `value` and what is wanted unless `valid`.
pub(in crate::scene) fn require(
    valid: bool,
    at: &str,
    value: impl Debug,
    wanted: &str,
) -> Result<()> {
    if valid {
        return Ok(());
    }
    let message = format!("{value:?} is not valid; give {wanted}");
    Err(Error::invalid(at, message))
}

/// Finite in the single precision of the device.
pub(in crate::scene) fn finite(value: f64) -> bool {
    value.abs() <= f64::from(f32::MAX)
}

pub(in crate::scene) fn all_finite(values: [f64; 3]) -> bool {
    values.into_iter().all(finite)
}

/// Positive, and neither infinite nor zero in the single precision of the device.
pub(in crate::scene) fn positive(value: f64) -> bool {
    finite(value) && value >= f64::from(f32::MIN_POSITIVE)
}

pub(in crate::scene) fn is_share(value: f64) -> bool {
    (0.0..=1.0).contains(&value)
}

fn positive_share(value: f64) -> bool {
    value > 0.0 && value <= 1.0
}

pub(in crate::scene) fn not_negative(value: f64) -> bool {
    finite(value) && value >= 0.0
}

/// A step length in voxels.
fn check_step(at: &str, step: f64) -> Result<()> {
    require(positive(step), at, Number(step), "a number > 0 (voxels)")?;
    let wanted = format!("a number >= {MIN_STEP} (voxels)");
    require(step >= MIN_STEP, at, Number(step), &wanted)
}

/// Prints as JSON would: `0`, not `0.0`.
pub(in crate::scene) struct Number(pub(in crate::scene) f64);

impl Debug for Number {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(f, "{}", self.0)
    }
}

/// Prints as JSON would: `[0, 0.5, 1]`.
pub(in crate::scene) fn numbers(values: [f64; 3]) -> [Number; 3] {
    values.map(Number)
}

fn check_raw(raw: &RawDescription) -> Result<()> {
    require(
        raw.size.iter().all(|&n| n >= crate::volume::MIN_SIZE),
        "volume.raw.size",
        raw.size,
        "three whole numbers >= 2 (voxels on x, y, z)",
    )?;
    require(
        raw.spacing.into_iter().all(positive),
        "volume.raw.spacing",
        numbers(raw.spacing),
        "three numbers > 0 (mm)",
    )
}

fn check_image(image: &Image) -> Result<()> {
    require(
        image.size.iter().all(|n| (1..=MAX_IMAGE_SIZE).contains(n)),
        "image.size",
        image.size,
        &format!("width and height from 1 to {MAX_IMAGE_SIZE} (pixels)"),
    )?;
    require(
        image.background.into_iter().all(is_share),
        "image.background",
        numbers(image.background),
        "three numbers from 0 to 1",
    )?;
    require(
        image.exposure.abs() <= MAX_EXPOSURE,
        "image.exposure",
        Number(image.exposure),
        &format!("a number from -{MAX_EXPOSURE} to {MAX_EXPOSURE} (stops)"),
    )?;
    require(
        matches!(image.png_bits, 8 | 16),
        "image.png_bits",
        image.png_bits,
        "8 or 16",
    )?;
    require(
        positive_share(image.depth_threshold),
        "image.depth_threshold",
        Number(image.depth_threshold),
        "a number > 0 and <= 1",
    )
}

pub(in crate::scene) fn check_direction(at: &str, direction: [f64; 3]) -> Result<()> {
    require(
        all_finite(direction) && direction.into_iter().any(|x| positive(x.abs())),
        at,
        numbers(direction),
        "three finite numbers, not all 0 (towards the light)",
    )
}

fn check_occlusion(ao: &AmbientOcclusion) -> Result<()> {
    let at = |key: &str| format!("ambient_occlusion.{key}");
    require(
        (1..=MAX_RAYS).contains(&ao.rays),
        &at("rays"),
        ao.rays,
        &format!("a whole number from 1 to {MAX_RAYS}"),
    )?;
    require(
        not_negative(ao.offset),
        &at("offset"),
        Number(ao.offset),
        "a number >= 0 (voxels)",
    )?;
    require(
        finite(ao.radius) && ao.radius > ao.offset,
        &at("radius"),
        Number(ao.radius),
        &format!("a number > offset, {} (voxels)", ao.offset),
    )?;
    check_step(&at("step"), ao.step)?;
    require(
        ao.samples_per_ray() <= MAX_SAMPLES_PER_RAY,
        &at("step"),
        Number(ao.step),
        &format!(
            "a number >= {} (voxels): a ray takes {MAX_SAMPLES_PER_RAY} samples at most",
            (ao.radius - ao.offset) / f64::from(MAX_SAMPLES_PER_RAY)
        ),
    )?;
    if let Some(growth) = ao.growth {
        require(
            GROWTHS.contains(&growth),
            &at("growth"),
            Number(growth),
            &format!(
                "a number from {} to {} (parts of a ray), or null",
                GROWTHS.start(),
                GROWTHS.end()
            ),
        )?;
        if ao.sampling == RaySampling::Uniform {
            return Err(Error::invalid(
                at("growth"),
                "distances do not grow in uniform sampling; give null, or \"distance\" as ambient_occlusion.sampling",
            ));
        }
    }
    require(
        not_negative(ao.gamma),
        &at("gamma"),
        Number(ao.gamma),
        "a number >= 0",
    )?;
    require(
        not_negative(ao.bias),
        &at("bias"),
        Number(ao.bias),
        "a number >= 0",
    )?;
    if let Some(directions) = &ao.explicit_directions {
        require(
            (1..=MAX_RAYS as usize).contains(&directions.len()),
            &at("explicit_directions"),
            format_args!("a list of {}", directions.len()),
            &format!("1 to {MAX_RAYS} directions"),
        )?;
        for (i, &direction) in directions.iter().enumerate() {
            check_direction(&at(&format!("explicit_directions.{i}")), direction)?;
        }
    }
    let Some(weights) = &ao.weights else {
        return Ok(());
    };
    for (i, &weight) in weights.iter().enumerate() {
        let at = at(&format!("weights.{i}"));
        require(
            is_share(weight),
            &at,
            Number(weight),
            "a number from 0 to 1",
        )?;
    }
    let count = ao.weighted_directions().len();
    require(
        weights.len() == count,
        &at("weights"),
        format_args!("a list of {}", weights.len()),
        &format!("{count} numbers, one for each direction, or null"),
    )
}

fn check_storage(storage: &Storage) -> Result<()> {
    require(
        finite(storage.data_reduction) && storage.data_reduction >= 1.0,
        "storage.data_reduction",
        Number(storage.data_reduction),
        "a number >= 1 (voxels of the volume per voxel kept)",
    )?;
    require(
        positive(storage.memory_budget_mib),
        "storage.memory_budget_mib",
        Number(storage.memory_budget_mib),
        "a number > 0 (MiB)",
    )
}

impl TransferFunction {
    /// Checks what does not need the volume.
    ///
    /// # Errors
    /// [`Error::Invalid`] naming the key that is wrong.
    pub fn validate(&self) -> Result<()> {
        if let Some(unit) = self.unit_distance {
            let at = "transfer_function.unit_distance";
            require(positive(unit), at, Number(unit), "a number > 0 (mm)")?;
        }
        let given = [
            ("points", self.points.is_some()),
            ("preset", self.preset.is_some()),
            ("file", self.file.is_some()),
        ];
        let mut given = given.iter().filter(|(_, is_given)| *is_given);
        if let (Some((one, _)), Some((other, _))) = (given.next(), given.next()) {
            return Err(Error::invalid(
                "transfer_function",
                format!(
                    "has both \"{one}\" and \"{other}\"; give one of them, or neither for an automatic one"
                ),
            ));
        }
        if let Some(name) = &self.preset {
            crate::scene::presets::find(name)?;
        }
        if let Some([low, high]) = self.range {
            let at = "transfer_function.range";
            let valid = finite(low) && finite(high) && low < high && self.file.is_some();
            let wanted = "two ascending numbers, and \"file\" beside it";
            require(valid, at, [Number(low), Number(high)], wanted)?;
        }
        let points = self.points.as_deref();
        if points.is_some_and(<[_]>::is_empty) {
            return Err(Error::invalid(
                "transfer_function.points",
                "empty; give at least one control point",
            ));
        }
        let mut previous = f64::NEG_INFINITY;
        for (i, point) in points.unwrap_or_default().iter().enumerate() {
            let at = |key: &str| format!("transfer_function.points.{i}.{key}");
            require(
                finite(point.value),
                &at("value"),
                Number(point.value),
                "a finite number",
            )?;
            require(
                point.value >= previous,
                &at("value"),
                Number(point.value),
                &format!("a number >= {previous}, the value of the point before: points ascend"),
            )?;
            previous = point.value;
            require(
                point.color.into_iter().all(is_share),
                &at("color"),
                numbers(point.color),
                "three numbers from 0 to 1",
            )?;
            require(
                is_share(point.opacity),
                &at("opacity"),
                Number(point.opacity),
                "a number from 0 to 1",
            )?;
            require(
                point
                    .emission
                    .into_iter()
                    .all(|e| not_negative(e) && e <= MAX_EMISSION),
                &at("emission"),
                numbers(point.emission),
                &format!("three numbers from 0 to {MAX_EMISSION}"),
            )?;
            require(
                point.source.into_iter().all(not_negative),
                &at("source"),
                numbers(point.source),
                "three numbers >= 0",
            )?;
        }
        Ok(())
    }
}

/// What engines build without a scene file is checked by the same rules.
macro_rules! validate_by {
    ($($part:ty => $check:ident),+ $(,)?) => {
        $(impl $part {
            /// Checks the range of every field.
            ///
            /// # Errors
            /// [`crate::error::Error::Invalid`] names the field by its scene key.
            pub fn validate(&self) -> Result<()> {
                $check(self)
            }
        })+
    };
}

validate_by! {
    March => check_march,
    Lighting => check_lighting,
    AmbientOcclusion => check_occlusion,
    Storage => check_storage,
    crate::scene::Curve => check_curve,
}

fn check_curve(curve: &crate::scene::Curve) -> Result<()> {
    let at = |key: &str| format!("transfer_function.{key}");
    require(
        positive(curve.unit_distance),
        &at("unit_distance"),
        Number(curve.unit_distance),
        "a number > 0 (mm)",
    )?;
    require(
        !curve.points.is_empty() && curve.points.windows(2).all(|p| p[0].value <= p[1].value),
        &at("points"),
        format_args!("a list of {}", curve.points.len()),
        "at least one point, by value ascending",
    )?;
    for (i, point) in curve.points.iter().enumerate() {
        let optical = &point.optical;
        let valid = finite(point.value)
            && is_share(optical.opacity)
            && optical.color.into_iter().all(not_negative)
            && optical.source.into_iter().all(not_negative)
            && optical
                .emission
                .into_iter()
                .all(|e| not_negative(e) && e <= MAX_LINEAR_EMISSION);
        require(
            valid,
            &at(&format!("points.{i}")),
            optical,
            "a finite value, opacity from 0 to 1, colours >= 0, emission within what a light volume of half floats holds",
        )?;
    }
    Ok(())
}
