//! Depth layers of a homogeneous slab.

use super::check::{Check, Worst};
use super::synthetic::{Subject, placed, point, sampled, span};
use crate::analytic::extinction;
use crate::error::Result;
use crate::headless::Headless;

/// Voxels.
const STEP: f64 = 0.1;
const OPACITY: f64 = 0.08;
/// Opacity, from which rays that end just there are left out: rounding decides for them.
const UNDECIDED: f64 = 1e-4;

/// Opacity reaches `a` at depth `-ln(1 - a) / tau`, and the mean depth of what is seen is `1/tau - L T / (1 - T)`, both from
/// where the ray enters.
pub(super) fn checks(device: &Headless) -> Result<Vec<Check>> {
    let placement = placed([1.0, 1.2, 0.9], [3.0, 2.0, 1.0], 35.0, [1.0; 3]);
    let volume = sampled([25, 22, 30], placement, |_| 1.0)?;
    let voxel = volume.min_spacing();
    let points = vec![point(1.0, [1.0; 3], OPACITY)];
    let subject = Subject::new(volume, [32, 28], voxel, points);
    let threshold = subject.scene.image.depth_threshold;
    let tau = extinction(OPACITY, voxel);
    let [mut first, mut median, mut expected] = [Worst::default(); 3];
    subject.each_picture(device, &[STEP], |_, picture, rays| {
        for (at, &ray) in rays.iter().enumerate() {
            let Some([enter, exit]) = span(&subject.volume, ray) else {
                continue;
            };
            let transparency = (-tau * (exit - enter)).exp();
            let layer = |worst: &mut Worst, opacity: f64, depth: f32| {
                let reached = 1.0 - transparency - opacity;
                if reached > UNDECIDED {
                    let exact = enter - (1.0 - opacity).ln() / tau;
                    worst.add((f64::from(depth) - exact) / voxel);
                } else if reached < -UNDECIDED {
                    worst.add(if depth.is_infinite() {
                        0.0
                    } else {
                        f64::INFINITY
                    });
                }
            };
            layer(&mut first, threshold, picture.depth[at]);
            layer(&mut median, 0.5, picture.median_depth[at]);
            if 1.0 - transparency > threshold {
                let mean = 1.0 / tau - (exit - enter) * transparency / (1.0 - transparency);
                let found = f64::from(picture.measure[at]);
                expected.add((found - enter - mean) / voxel);
            }
        }
    })?;
    let of =
        |name, what, worst: Worst, bound| Check::new(name, what, "voxels", worst.figure(), bound);
    Ok(vec![
        of(
            "depth.first",
            "where a slab's opacity reaches 0.05, in steps of 0.1",
            first,
            STEP,
        ),
        of("depth.median", "where half the light is left", median, STEP),
        of(
            "depth.expected",
            "mean depth of what is seen",
            expected,
            0.1 * STEP,
        ),
    ])
}
