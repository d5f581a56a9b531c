//! Isosurfaces lie where the trilinear field has its root.

use glam::DVec3;

use super::check::{Check, Worst};
use super::synthetic::{Subject, placed, point, sampled};
use crate::error::Result;
use crate::field::Field;
use crate::headless::Headless;
use crate::scene::{Interpolation, Isosurface, RayProjection};

const RADIUS: f64 = 11.0;
/// Voxels inside the radius: rays that pass farther out may go in and out within a step.
const GRAZING: f64 = 0.5;
/// Voxels.
const BOUND: f64 = 0.01;

pub(super) fn checks(device: &Headless) -> Result<Vec<Check>> {
    let spacing = 1.5;
    let placement = placed([spacing; 3], [1.0, 2.0, 3.0], 20.0, [7.0, -5.0, 3.0]);
    let middle = DVec3::splat(15.0);
    let volume = sampled([31; 3], placement, |ix| ix.distance(middle))?;
    let mut subject = Subject::new(volume, [32, 28], 1.0, vec![point(0.0, [1.0; 3], 1.0)]);
    subject.scene.march.projection = RayProjection::Isosurface;
    subject.scene.march.isosurfaces = vec![Isosurface {
        value: RADIUS,
        color: None,
        opacity: 1.0,
    }];
    let field = Field::new(&subject.volume);
    let center = placement.transform_point3(middle);
    let mut worst = Worst::default();
    subject.each_picture(device, &[0.5, 1.0], |_, picture, rays| {
        for (&depth, &(origin, direction)) in picture.depth.iter().zip(rays) {
            let closest = (center - origin).dot(direction);
            let distance = (origin + closest * direction).distance(center) / spacing;
            if distance > RADIUS - GRAZING {
                continue;
            }
            let half_chord = spacing * (RADIUS * RADIUS - distance * distance).sqrt();
            // The trilinear field's surface is less than half a voxel from the sphere.
            let margin = (GRAZING * spacing).min(half_chord);
            let near = closest - half_chord;
            let beyond = |t: f64| {
                let ix = field
                    .ix_from_world()
                    .transform_point3(origin + t * direction);
                field
                    .sample(ix, Interpolation::Linear)
                    .is_none_or(|value| value >= RADIUS)
            };
            let root = bisect(beyond, near - margin, near + margin);
            worst.add((f64::from(depth) - root) / spacing);
        }
    })?;
    Ok(vec![Check::new(
        "isosurface.depth",
        "depth of a sphere against the trilinear field's root",
        "voxels",
        worst.figure(),
        BOUND,
    )])
}

/// Where `holds` stops holding, between `low`, where it does, and `high`, where it does not.
fn bisect(holds: impl Fn(f64) -> bool, mut low: f64, mut high: f64) -> f64 {
    const HALVINGS: u32 = 40;
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if holds(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}
