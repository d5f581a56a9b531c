//! Projections of a linear field, whose samples are known.

use super::check::{Check, Worst};
use super::closed_forms::{ramp_along, ramp_depth, ramp_subject};
use crate::error::Result;
use crate::headless::Headless;
use crate::scene::RayProjection;

const STEPS: [f64; 3] = [0.13, 0.5, 2.0];
const ROUNDING: f64 = 1e-5;
/// A remainder of a step that is shorter is no segment of its own.
const SHORTEST_SEGMENT: f64 = 1e-4;
/// Remainders so near to that may go either way in 32 bits.
const UNDECIDED: f64 = 1e-3;

/// Smallest, largest and mean sample of a ray whose values run linearly between `ends` over `steps` steps. `None` where rounding
/// decides how many samples there are.
fn samples([first, last]: [f64; 2], steps: f64) -> Option<[f64; 3]> {
    let remainder = steps - SHORTEST_SEGMENT;
    if (remainder - remainder.round()).abs() < UNDECIDED {
        return None;
    }
    let count = remainder.ceil();
    let at = |middle: f64| first + (last - first) * middle / steps;
    let low = at(if count > 1.0 { 0.5 } else { 0.5 * steps });
    let high = at(0.5 * (count - 1.0 + steps));
    Some([low.min(high), low.max(high), 0.5 * (first + last)])
}

pub(super) fn checks(device: &Headless) -> Result<Vec<Check>> {
    let subject = ramp_subject(1.0)?;
    let voxel = subject.volume.min_spacing();
    let figure = |projection, exact: &dyn Fn([f64; 2], f64, f64) -> Option<f64>| -> Result<f64> {
        // Of an optical depth, what is seen is the transparency.
        let scale = |measure: f64| match projection {
            RayProjection::Xray => (-measure).exp(),
            _ => measure,
        };
        let mut worst = Worst::default();
        let subject = subject.with(|scene| scene.march.projection = projection);
        subject.each_picture(device, &STEPS, |step, picture, rays| {
            for (&measure, &ray) in picture.measure.iter().zip(rays) {
                let along = ramp_along(&subject.volume, ray);
                let exact = along.and_then(|(ends, length)| exact(ends, length, step));
                if let Some(exact) = exact {
                    worst.add(scale(f64::from(measure)) - scale(exact));
                }
            }
        })?;
        Ok(worst.figure())
    };
    let sample = |which: usize| {
        move |ends, length: f64, step: f64| samples(ends, length / step).map(|s| s[which])
    };
    let depth = |ends, length: f64, _| Some(ramp_depth(ends, length, voxel));
    let of = |name, what, unit, figure| Check::new(name, what, unit, figure, ROUNDING);
    Ok(vec![
        of(
            "projection.minimum",
            "smallest sample of a ramp",
            "of the range",
            figure(RayProjection::Minimum, &sample(0))?,
        ),
        of(
            "projection.maximum",
            "largest sample",
            "of the range",
            figure(RayProjection::Maximum, &sample(1))?,
        ),
        of(
            "projection.mean",
            "mean sample",
            "of the range",
            figure(RayProjection::Mean, &sample(2))?,
        ),
        of(
            "projection.xray",
            "transparency of a ramp by X-rays",
            "linear",
            figure(RayProjection::Xray, &depth)?,
        ),
    ])
}
