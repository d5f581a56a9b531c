//! Cubic filters reproduce linear fields.

use super::check::{Check, Worst};
use super::synthetic::{Subject, difference, placed, point, sampled};
use crate::error::Result;
use crate::headless::Headless;
use crate::scene::{Classification, Interpolation};

const ROUNDING: f64 = 1e-5;

/// Pictures of a field that is linear along x, clear within two voxels of its ends, where filters find the border repeated.
pub(super) fn checks(device: &Headless) -> Result<Vec<Check>> {
    let placement = placed([1.0, 0.7, 1.6], [1.0, 0.0, 1.0], 35.0, [0.0; 3]);
    let volume = sampled([31, 24, 20], placement, |ix| ix.x / 30.0)?;
    let color = [0.9, 0.6, 0.3];
    let points = vec![
        point(0.0, color, 0.0),
        point(0.1, color, 0.0),
        point(0.5, [0.2, 0.8, 0.5], 0.4),
        point(0.9, color, 0.0),
    ];
    let linear = Subject::new(volume, [32, 28], 4.0, points);
    let check = |name, what, interpolation| -> Result<Check> {
        let mut worst = Worst::default();
        for classification in [Classification::Post, Classification::Preintegrated] {
            let linear = linear.with(|s| s.march.classification = Some(classification));
            let cubic = linear.with(|s| s.march.interpolation = interpolation);
            worst.add(difference(
                &linear.picture(device)?,
                &cubic.picture(device)?,
            ));
        }
        Ok(Check::new(name, what, "linear", worst.figure(), ROUNDING))
    };
    Ok(vec![
        check(
            "cubic.bspline",
            "linear field by B-spline against trilinear",
            Interpolation::Bspline,
        )?,
        check(
            "cubic.catmull_rom",
            "linear field by Catmull-Rom against trilinear",
            Interpolation::CatmullRom,
        )?,
    ])
}
