//! Sampling.

use glam::{DAffine3, DVec3};
use umbravox::reference::Field;
use umbravox::scene::Interpolation::{Linear, Nearest};
use umbravox::volume::{Rescale, Volume, Voxels};

use crate::fixtures::{assert_close, volume_of};

#[test]
fn trilinear_polynomials_are_reproduced() {
    let f = |p: DVec3| {
        3.0 - 2.0 * p.x + 5.0 * p.y + p.z + 4.0 * p.x * p.y - 3.0 * p.y * p.z + 2.0 * p.z * p.x
            - p.element_product()
    };
    let volume = volume_of([5, 3, 4], DAffine3::IDENTITY, |v| {
        f(DVec3::from_array(v.map(f64::from)))
    });
    let field = Field::new(&volume);
    for p in [
        DVec3::new(0.0, 0.0, 0.0),
        DVec3::new(4.0, 2.0, 3.0),
        DVec3::new(1.3, 0.8, 2.9),
        DVec3::new(3.999, 1.001, 0.5),
        DVec3::new(4.0, 0.25, 1.75),
    ] {
        assert_close(field.sample(p, Linear).unwrap(), f(p), 1e-12);
    }
}

#[test]
fn the_field_ends_at_the_outer_voxel_centres() {
    let volume = volume_of([5, 3, 4], DAffine3::IDENTITY, |_| 1.0);
    let field = Field::new(&volume);
    let middle = DVec3::new(2.0, 1.0, 1.5);
    for axis in 0..3 {
        for (at, inside) in [
            (0.0, true),
            (-1e-12, false),
            (field.last_ix()[axis], true),
            (field.last_ix()[axis] + 1e-12, false),
        ] {
            let mut p = middle;
            p[axis] = at;
            assert_eq!(field.sample(p, Linear).is_some(), inside, "{p}");
            assert_eq!(field.sample(p, Nearest).is_some(), inside, "{p}");
        }
    }
}

#[test]
fn the_nearest_voxel_of_a_half_is_the_upper_one() {
    let volume = volume_of([4, 4, 4], DAffine3::IDENTITY, |[i, j, k]| {
        f64::from(i + 10 * j + 100 * k)
    });
    let field = Field::new(&volume);
    for (p, expected) in [
        ([0.5, 1.49, 2.5], 311.0),
        ([0.49, 1.5, 2.51], 320.0),
        ([3.0, 2.5, 0.0], 33.0),
    ] {
        assert_eq!(field.sample(DVec3::from_array(p), Nearest), Some(expected));
    }
}

#[test]
fn values_are_the_files_own() {
    let rescale = Rescale {
        slope: -0.5,
        intercept: 40.0,
    };
    let voxels = Voxels::I8(vec![-100, 100, -100, 100, -100, 100, -100, 100]);
    let volume = Volume::new(voxels, [2; 3], DAffine3::IDENTITY, rescale).unwrap();
    let field = Field::new(&volume);
    let at = |x| field.sample(DVec3::new(x, 0.5, 0.5), Linear).unwrap();
    assert_close(at(0.0), 90.0, 1e-12);
    assert_close(at(0.25), 65.0, 1e-12);
    assert_close(at(1.0), -10.0, 1e-12);
}
