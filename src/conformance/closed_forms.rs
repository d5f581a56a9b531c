//! Media whose rendering integral (Max 1995) has a closed form, for steps of 0.05 to 2 voxels and voxels of 1e-6 to 1e6 mm.

use glam::DVec3;

use super::check::{Check, Worst};
use super::synthetic::{Subject, last_ix, placed, point, sampled, span};
use crate::analytic::{emission_absorption, mean_extinction, slab_opacity, sphere_chord};
use crate::error::Result;
use crate::headless::Headless;
use crate::scene::{RayProjection, linear_from_srgb, srgb_from_linear};
use crate::volume::Volume;

const STEPS: [f64; 5] = [0.05, 0.13, 0.5, 1.0, 2.0];
const SPACINGS: [f64; 5] = [1e-6, 1e-3, 1.0, 1e3, 1e6];
const SIZE: [u32; 2] = [24, 20];
/// What 32-bit floats may add up to.
const ROUNDING: f64 = 1e-5;
const BACKGROUND: [f64; 3] = [0.2, 0.35, 0.5];

pub(super) fn checks(device: &Headless) -> Result<Vec<Check>> {
    let mut checks = homogeneous(device)?;
    checks.push(absorption(device)?);
    checks.push(ramp(device)?);
    checks.push(sphere(device)?);
    Ok(checks)
}

fn length_in(volume: &Volume, ray: (DVec3, DVec3)) -> f64 {
    span(volume, ray).map_or(0.0, |[enter, exit]| exit - enter)
}

/// Absorbs and emits alike everywhere.
fn slab(spacing: f64) -> Result<Subject> {
    let spacings = [spacing, 1.3 * spacing, 0.8 * spacing];
    let placement = placed(spacings, [1.0, 2.0, 3.0], 40.0, [2.0 * spacing; 3]);
    let volume = sampled([19, 17, 34], placement, |_| 0.5)?;
    let mut medium = point(0.5, COLOR, OPACITY);
    medium.emission = EMISSION;
    Ok(Subject::new(volume, SIZE, spacing, vec![medium]))
}

const COLOR: [f64; 3] = [0.9, 0.4, 0.1];
const EMISSION: [f64; 3] = [0.0, 0.2, 0.3];
const OPACITY: f64 = 0.08;

/// `A = 1 - exp(-tau L)`, `C = (c + e) A`, and `I = C + (1 - A) I0` over a background.
fn homogeneous(device: &Headless) -> Result<Vec<Check>> {
    let [mut opacity, mut radiance, mut over, mut display] = [Worst::default(); 4];
    let background = BACKGROUND.map(linear_from_srgb);
    let source: [f64; 3] =
        std::array::from_fn(|i| linear_from_srgb(COLOR[i]) + linear_from_srgb(EMISSION[i]));
    for spacing in SPACINGS {
        let subject = slab(spacing)?;
        subject.each_picture(device, &STEPS, |_, picture, rays| {
            let pixels = picture.rgba.iter().zip(picture.over(background)).zip(rays);
            for ((pixel, shown), &ray) in pixels {
                let exact = slab_opacity(OPACITY, spacing, length_in(&subject.volume, ray));
                opacity.add(f64::from(pixel[3]) - exact);
                for i in 0..3 {
                    radiance.add(f64::from(pixel[i]) - source[i] * exact);
                    let expected = emission_absorption(source[i], background[i], 1.0 - exact);
                    over.add(shown[i] - expected);
                    display.add(srgb_from_linear(shown[i]) - srgb_from_linear(expected));
                }
            }
        })?;
    }
    let of = |name, what, worst: Worst| Check::new(name, what, "linear", worst.figure(), ROUNDING);
    Ok(vec![
        of(
            "homogeneous.opacity",
            "homogeneous slab, 1 - exp(-tau L)",
            opacity,
        ),
        of(
            "homogeneous.radiance",
            "homogeneous slab, emission and colour",
            radiance,
        ),
        of(
            "homogeneous.over_background",
            "homogeneous slab over a background",
            over,
        ),
        Check::new(
            "homogeneous.display",
            "the same in 8-bit display steps",
            "1/255",
            255.0 * display.figure(),
            0.5,
        ),
    ])
}

/// Absorption alone: transparency `exp(-tau L)` from the optical depth that X-rays measure.
fn absorption(device: &Headless) -> Result<Check> {
    let mut worst = Worst::default();
    for spacing in SPACINGS {
        let subject = slab(spacing)?.with(|scene| scene.march.projection = RayProjection::Xray);
        subject.each_picture(device, &STEPS, |_, picture, rays| {
            for (&depth, &ray) in picture.measure.iter().zip(rays) {
                let exact = slab_opacity(OPACITY, spacing, length_in(&subject.volume, ray));
                worst.add((-f64::from(depth)).exp() - (1.0 - exact));
            }
        })?;
    }
    Ok(Check::new(
        "absorption.transparency",
        "exp(-optical depth) of a homogeneous slab",
        "linear",
        worst.figure(),
        ROUNDING,
    ))
}

/// Opacity that rises linearly along x.
pub(super) fn ramp_subject(spacing: f64) -> Result<Subject> {
    let spacings = [spacing, 1.3 * spacing, 0.8 * spacing];
    let placement = placed(spacings, [2.0, 1.0, 3.0], 25.0, [-spacing; 3]);
    let volume = sampled([33, 20, 24], placement, |ix| ix.x / 32.0)?;
    let white = [1.0; 3];
    let points = vec![point(0.0, white, RAMP[0]), point(1.0, white, RAMP[1])];
    Ok(Subject::new(volume, SIZE, RAMP_UNIT * spacing, points))
}

const RAMP: [f64; 2] = [0.05, 0.85];
/// Voxels that opacities refer to.
const RAMP_UNIT: f64 = 8.0;

/// Values of the ramp where a ray enters and leaves it, and its length in voxels; `None` where it misses.
pub(super) fn ramp_along(volume: &Volume, ray: (DVec3, DVec3)) -> Option<([f64; 2], f64)> {
    let [enter, exit] = span(volume, ray)?;
    let ix_from_world = volume.world_from_ix().inverse();
    let value = |distance: f64| {
        let ix = ix_from_world.transform_point3(ray.0 + ray.1 * distance);
        ix.x / last_ix(volume).x
    };
    let length = (exit - enter) / volume.min_spacing();
    Some(([value(enter), value(exit)], length))
}

/// Optical depth of a ray through the ramp.
pub(super) fn ramp_depth([first, last]: [f64; 2], length: f64, voxel: f64) -> f64 {
    let opacity = |value: f64| RAMP[0] + (RAMP[1] - RAMP[0]) * value.clamp(0.0, 1.0);
    mean_extinction(opacity(first), opacity(last)) * length * voxel / RAMP_UNIT
}

fn ramp(device: &Headless) -> Result<Check> {
    let mut worst = Worst::default();
    for spacing in SPACINGS {
        let subject = ramp_subject(spacing)?;
        let voxel = subject.volume.min_spacing() / spacing;
        subject.each_picture(device, &STEPS, |_, picture, rays| {
            for (pixel, &ray) in picture.rgba.iter().zip(rays) {
                let exact = ramp_along(&subject.volume, ray).map_or(0.0, |(ends, length)| {
                    1.0 - (-ramp_depth(ends, length, voxel)).exp()
                });
                worst.add(f64::from(pixel[3]) - exact);
            }
        })?;
    }
    let what = "opacity that rises along the way";
    Ok(Check::new(
        "ramp.opacity",
        what,
        "linear",
        worst.figure(),
        ROUNDING,
    ))
}

/// A ball of constant opacity. Its surface is where the transfer function jumps, so a chord is right but for what linear
/// interpolation of the distance does to the radius: `1 / (4 r)` voxels between voxels and `h^2 / (8 r)` between samples.
fn sphere(device: &Headless) -> Result<Check> {
    let (n, radius, opacity) = (33u32, 12.0, 0.06);
    let middle = DVec3::splat(0.5 * f64::from(n - 1));
    let mut worst = Worst::default();
    for spacing in SPACINGS {
        let placement = placed([spacing; 3], [0.0, 0.0, 1.0], 0.0, [0.0; 3]);
        let volume = sampled([n; 3], placement, |ix| ix.distance(middle))?;
        let white = [1.0; 3];
        let points = vec![
            point(0.0, white, opacity),
            point(radius, white, opacity),
            point(radius, white, 0.0),
        ];
        let subject = Subject::new(volume, SIZE, spacing, points);
        subject.each_picture(device, &STEPS, |step, picture, rays| {
            for (pixel, &(origin, direction)) in picture.rgba.iter().zip(rays) {
                let center = middle * spacing;
                let closest = origin + direction * (center - origin).dot(direction);
                let distance = closest.distance(center) / spacing;
                let shift = 1.0 / (4.0 * radius) + step * step / (8.0 * radius);
                let opacity_of =
                    |radius: f64| slab_opacity(opacity, 1.0, sphere_chord(radius, distance));
                let range = [opacity_of(radius - shift), opacity_of(radius + shift)];
                worst.add_beyond(f64::from(pixel[3]), range);
            }
        })?;
    }
    Ok(Check::new(
        "sphere.chord",
        "ball of constant opacity, beyond the bounds of its chord",
        "linear",
        worst.figure(),
        ROUNDING,
    ))
}
