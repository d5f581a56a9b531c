//! Local ambient occlusion (Hernell, Ljung, Ynnerman 2007) of media that have a closed form.

use super::check::{Check, Worst};
use super::synthetic::{Subject, placed, point, sampled};
use crate::error::Result;
use crate::headless::{Headless, LightVolume};
use crate::scene::AmbientOcclusion;

/// Light is kept in 16-bit floats, of 11 significant bits: two roundings of numbers below 1.
const HALF_PRECISION: f64 = 1e-3;
const SIZE: u32 = 34;
/// Voxels.
const RADIUS: u32 = 8;
/// Opacities over a voxel of the two halves.
const OPACITIES: [f64; 2] = [0.02, 0.5];
/// The lower half ends at this voxel on x; the field rises to the upper half within one voxel.
const BORDER: u32 = 16;

pub(super) fn checks(device: &Headless) -> Result<Vec<Check>> {
    Ok(vec![
        homogeneous(
            device,
            "light.clear",
            "light in an all but clear volume",
            1e-6,
        )?,
        homogeneous(
            device,
            "light.homogeneous",
            "light in a homogeneous medium",
            0.1,
        )?,
        half_space(device)?,
    ])
}

fn settings() -> AmbientOcclusion {
    AmbientOcclusion {
        rays: 32,
        radius: f64::from(RADIUS),
        offset: 1.0,
        step: 1.0,
        ..Default::default()
    }
}

/// A sample that what comes before lets through: `1, t, t^2, ...` for `t = 1 - a`; their mean is `(1 - t^M) / (M a)`.
fn homogeneous(
    device: &Headless,
    name: &'static str,
    what: &'static str,
    opacity: f64,
) -> Result<Check> {
    let placement = placed([1.0; 3], [0.0, 0.0, 1.0], 0.0, [0.0; 3]);
    let volume = sampled([SIZE; 3], placement, |_| 1.0)?;
    let points = vec![point(1.0, [1.0; 3], opacity)];
    let subject = Subject::new(volume, [8, 8], 1.0, points)
        .with(|scene| scene.ambient_occlusion = Some(settings()));
    let samples = f64::from(settings().samples_per_ray());
    let exact = -(samples * (-opacity).ln_1p()).exp_m1() / (samples * opacity);
    let light = subject.session(device)?.light_volume()?;
    Ok(check(name, what, &light, |_| exact))
}

/// Light along x alone, to both sides of the border between two media.
fn half_space(device: &Headless) -> Result<Check> {
    let placement = placed([1.0; 3], [0.0, 0.0, 1.0], 0.0, [0.0; 3]);
    let volume = sampled([SIZE; 3], placement, |ix| {
        f64::from(u32::from(ix.x > f64::from(BORDER)))
    })?;
    let points = vec![
        point(0.0, [1.0; 3], OPACITIES[0]),
        point(1.0, [1.0; 3], OPACITIES[1]),
    ];
    let subject = Subject::new(volume, [8, 8], 1.0, points).with(|scene| {
        scene.ambient_occlusion = Some(AmbientOcclusion {
            explicit_directions: Some(vec![[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]]),
            ..settings()
        });
    });
    let opacity = |x: f64| {
        let upper = (x - f64::from(BORDER)).clamp(0.0, 1.0);
        OPACITIES[0] + (OPACITIES[1] - OPACITIES[0]) * upper
    };
    let samples = settings().samples_per_ray();
    let along = |x: f64, side: f64| {
        let (mut sum, mut transparency) = (0.0, 1.0);
        for sample in 0..samples {
            sum += transparency;
            transparency *= 1.0 - opacity(x + side * (1.5 + f64::from(sample)));
        }
        sum / f64::from(samples)
    };
    let light = subject.session(device)?.light_volume()?;
    let exact = |x: u32| 0.5 * (along(x.into(), 1.0) + along(x.into(), -1.0));
    let what = "light along the normal of a half-space";
    Ok(check("light.half_space", what, &light, exact))
}

/// Voxels farther from the border of the volume than rays are long.
fn check(
    name: &'static str,
    what: &'static str,
    light: &LightVolume,
    exact: impl Fn(u32) -> f64,
) -> Check {
    let mut worst = Worst::default();
    let inside = RADIUS..SIZE - RADIUS;
    for (at, &[r, g, b, computed]) in light.rgba.iter().enumerate() {
        let at = at as u32;
        let [x, y, z] = [at % SIZE, at / SIZE % SIZE, at / (SIZE * SIZE)];
        if [x, y, z].iter().all(|x| inside.contains(x)) {
            for channel in [r, g, b] {
                worst.add(f64::from(channel) - exact(x));
            }
            worst.add(f64::from(computed) - 1.0);
        }
    }
    Check::new(name, what, "linear", worst.figure(), HALF_PRECISION)
}
