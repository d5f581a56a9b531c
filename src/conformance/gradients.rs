//! Every estimate of the gradient is exact for linear fields, whatever the spacing: seen through diffuse shading.

use glam::DVec3;

use super::check::{Check, Worst};
use super::synthetic::{Subject, last_ix, placed, point, sampled};
use crate::error::Result;
use crate::headless::Headless;
use crate::scene::{Gradient, Isosurface, RayProjection, Shading};

const ROUNDING: f64 = 1e-5;
/// Stored gradients are off by 2^-11 of each component, and light by less.
const HALVES: f64 = 4e-4;
/// Voxels from the border within which estimates find the border repeated.
const REACH: f64 = 3.0;
/// Steepest way up, world space, unit length.
const NORMAL: DVec3 = DVec3::new(0.48, -0.6, 0.64);
/// Towards the light.
const LIGHT: DVec3 = DVec3::new(0.0, -0.8, 0.6);

const ESTIMATORS: [(&str, &str, Gradient); 6] = [
    (
        "gradient.central_differences",
        "shading of a plane by central differences",
        Gradient::CentralDifferences,
    ),
    (
        "gradient.four_point",
        "by four points an axis",
        Gradient::FourPoint,
    ),
    (
        "gradient.regression",
        "by linear regression",
        Gradient::Regression,
    ),
    ("gradient.sobel", "by Sobel's operator", Gradient::Sobel),
    (
        "gradient.bspline",
        "by the B-spline's derivative",
        Gradient::Bspline,
    ),
    (
        "gradient.catmull_rom",
        "by Catmull-Rom's derivative",
        Gradient::CatmullRom,
    ),
];

pub(super) fn checks(device: &Headless) -> Result<Vec<Check>> {
    let placement = placed([0.7, 1.0, 1.9], [1.0, 2.0, 2.0], 50.0, [3.0, -4.0, 5.0]);
    let size = [34, 30, 24];
    let middle = placement.transform_point3(0.5 * (DVec3::from_array(size.map(f64::from)) - 1.0));
    let height = |p_ws: DVec3| (p_ws - middle).dot(NORMAL);
    let volume = sampled(size, placement, |ix| height(placement.transform_point3(ix)))?;
    let ix_from_world = placement.inverse();
    let inside = last_ix(&volume) - REACH;
    let mut subject = Subject::new(volume, [32, 28], 1.0, vec![point(0.0, [1.0; 3], 1.0)]);
    subject.scene.march.projection = RayProjection::Isosurface;
    subject.scene.march.isosurfaces = vec![Isosurface {
        value: 0.0,
        color: Some([1.0; 3]),
        opacity: 1.0,
    }];
    let lighting = &mut subject.scene.lighting;
    lighting.shading = Shading::Diffuse;
    lighting.direction = Some(LIGHT.to_array());
    let expected = lighting.ambient + lighting.diffuse * NORMAL.dot(LIGHT).abs();
    let off_by = |estimator: Gradient, stored: bool, worst: &mut Worst| {
        let subject = subject.with(|scene| {
            scene.lighting.gradient = estimator;
            scene.lighting.stored_gradients = stored;
        });
        subject.each_picture(device, &[0.5], |_, picture, rays| {
            for (pixel, (origin, direction)) in picture.rgba.iter().zip(rays) {
                let distance = -height(*origin) / direction.dot(NORMAL);
                let ix = ix_from_world.transform_point3(*origin + *direction * distance);
                if (ix.cmpgt(DVec3::splat(REACH)) & ix.cmplt(inside)).all() {
                    worst.add(f64::from(pixel[0]) - expected);
                }
            }
        })
    };
    let mut checks = Vec::new();
    for (name, what, estimator) in ESTIMATORS {
        let mut worst = Worst::default();
        off_by(estimator, false, &mut worst)?;
        checks.push(Check::new(name, what, "linear", worst.figure(), ROUNDING));
    }
    let mut worst = Worst::default();
    for (_, _, estimator) in ESTIMATORS.iter().filter(|(_, _, e)| !e.is_cubic()) {
        off_by(*estimator, true, &mut worst)?;
    }
    let what = "by estimates that were stored";
    checks.push(Check::new(
        "gradient.stored",
        what,
        "linear",
        worst.figure(),
        HALVES,
    ));
    Ok(checks)
}
