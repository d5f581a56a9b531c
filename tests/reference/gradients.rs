//! Gradient estimators.

use glam::{DAffine3, DMat3, DVec3};
use umbravox::reference::Field;
use umbravox::scene::Gradient;
use umbravox::scene::Interpolation::{self, Linear};
use umbravox::volume::Volume;

use crate::fixtures::{assert_close, volume_of};

const ESTIMATORS: [Gradient; 6] = [
    Gradient::CentralDifferences,
    Gradient::FourPoint,
    Gradient::Regression,
    Gradient::Sobel,
    Gradient::Bspline,
    Gradient::CatmullRom,
];

/// Samples a function of the index position.
fn sampled(size: [u32; 3], f: impl Fn(DVec3) -> f64) -> Volume {
    volume_of(size, DAffine3::IDENTITY, |v| {
        f(DVec3::from_array(v.map(f64::from)))
    })
}

#[test]
fn gradients_end_where_the_field_does() {
    let volume = sampled([5, 3, 4], |p| p.x);
    let field = Field::new(&volume);
    for estimator in ESTIMATORS {
        for (x, inside) in [
            (0.0, true),
            (-1e-12, false),
            (4.0, true),
            (4.0 + 1e-12, false),
        ] {
            let g = field.gradient_ws(DVec3::new(x, 1.0, 1.5), estimator);
            assert_eq!(g.is_some(), inside, "{estimator:?} at {x}");
        }
    }
}

/// At voxels, of what degree a polynomial's derivative is exact: 2 by symmetry, and 4 for the four taps.
#[test]
fn derivatives_of_polynomials_are_exact_to_each_estimators_degree() {
    let at = DVec3::new(5.0, 4.0, 6.0);
    for (estimator, highest) in ESTIMATORS.map(|e| match e {
        Gradient::FourPoint => (e, 4),
        _ => (e, 2),
    }) {
        for degree in 1..=highest + 1 {
            let u = |p: DVec3| (p - at).x + 0.5;
            let volume = sampled([11; 3], |p| u(p).powi(degree) + 2.0 * p.y - p.z);
            let field = Field::new(&volume);
            let g = field.gradient_ws(at, estimator).unwrap();
            assert_close(g.y, 2.0, 1e-12);
            assert_close(g.z, -1.0, 1e-12);
            let error = (g.x - f64::from(degree) * 0.5f64.powi(degree - 1)).abs();
            if degree <= highest {
                assert!(error < 1e-12, "{estimator:?} {degree}: {error:e}");
            } else {
                assert!(error > 0.1, "{estimator:?} {degree}: {error:e}");
            }
        }
    }
}

/// Between voxels too: the derivative of the cubic field itself, against its differences.
#[test]
fn derivatives_of_cubic_fields_are_those_of_the_field() {
    let volume = sampled([7, 6, 8], |p| {
        (0.9 * p.x).sin() * (1.3 * p.y).cos() + (0.7 * p.z * p.x).sin()
    });
    let field = Field::new(&volume);
    let h = 1e-5;
    for (estimator, interpolation) in [
        (Gradient::Bspline, Interpolation::Bspline),
        (Gradient::CatmullRom, Interpolation::CatmullRom),
    ] {
        for p in [
            [2.3, 1.7, 4.4],
            [0.2, 4.9, 6.8],
            [3.5, 2.5, 0.5],
            [5.1, 0.3, 3.9],
        ] {
            let p = DVec3::from_array(p);
            let g = field.gradient_ws(p, estimator).unwrap();
            for axis in 0..3 {
                let offset = DVec3::AXES[axis] * h;
                let difference = field.sample(p + offset, interpolation).unwrap()
                    - field.sample(p - offset, interpolation).unwrap();
                assert_close(g[axis], difference / (2.0 * h), 1e-8);
            }
        }
    }
}

/// The B-spline differentiates quadratics exactly everywhere, and shifts `x^2 + y^2 + z^2` up by 1.
#[test]
fn b_spline_derivatives_of_a_quadratic_field_are_exact() {
    let volume = sampled([9; 3], |p| p.length_squared());
    let field = Field::new(&volume);
    for p in [[4.0, 4.0, 4.0], [1.25, 3.5, 6.875], [2.7, 5.1, 3.3]] {
        let p = DVec3::from_array(p);
        let g = field.gradient_ws(p, Gradient::Bspline).unwrap();
        assert!(g.distance(2.0 * p) < 1e-12, "{g} at {p}");
        let value = field.sample(p, Interpolation::Bspline).unwrap();
        assert_close(value, p.length_squared() + 1.0, 1e-12);
    }
}

/// Between voxels, differences of the trilinear field are the trilinear mean of those at the voxels around.
#[test]
fn differences_are_trilinear_between_voxels() {
    let f = |p: DVec3| (p.x * 0.8).sin() + (p.y * p.z * 0.3).cos() * p.x;
    let volume = sampled([9; 3], f);
    let field = Field::new(&volume);
    for estimator in &ESTIMATORS[..4] {
        let at = |p| field.gradient_ws(p, *estimator).unwrap();
        for component in 0..3 {
            let grid = sampled([9; 3], |p| at(p)[component]);
            for p in [[3.25, 4.5, 4.75], [2.0, 3.875, 5.5]] {
                let p = DVec3::from_array(p);
                let mean = Field::new(&grid).sample(p, Linear).unwrap();
                // The grid of gradients is rounded to f32.
                assert_close(at(p)[component], mean, 1e-6);
            }
        }
    }
}

/// The estimators' weights, by hand, from one voxel of value 1.
#[test]
fn responses_to_one_voxel() {
    let respond = |estimator, offset: [f64; 3]| {
        let volume = sampled([7; 3], |p| f64::from(u8::from(p == DVec3::splat(3.0))));
        let at = DVec3::splat(3.0) - DVec3::from_array(offset);
        Field::new(&volume).gradient_ws(at, estimator).unwrap().x
    };
    // sum_k w_k x_k^2: 2 faces, 8 edges and 8 corners with x_k = +-1.
    let norm = 2.0 + 8.0 / 2f64.sqrt() + 8.0 / 3f64.sqrt();
    for (estimator, offset, expected) in [
        (Gradient::CentralDifferences, [1.0, 0.0, 0.0], 0.5),
        (Gradient::CentralDifferences, [1.0, 1.0, 0.0], 0.0),
        (Gradient::FourPoint, [1.0, 0.0, 0.0], 2.0 / 3.0),
        (Gradient::FourPoint, [-2.0, 0.0, 0.0], 1.0 / 12.0),
        (Gradient::Sobel, [1.0, 0.0, 0.0], 1.0 / 8.0),
        (Gradient::Sobel, [-1.0, 1.0, 0.0], -1.0 / 16.0),
        (Gradient::Sobel, [1.0, 1.0, -1.0], 1.0 / 32.0),
        (Gradient::Sobel, [0.0, 1.0, 0.0], 0.0),
        (Gradient::Regression, [1.0, 0.0, 0.0], 1.0 / norm),
        (
            Gradient::Regression,
            [-1.0, 0.0, 1.0],
            -0.5f64.sqrt() / norm,
        ),
        (
            Gradient::Regression,
            [1.0, -1.0, 1.0],
            (1.0 / 3f64).sqrt() / norm,
        ),
        (Gradient::Bspline, [1.0, 0.0, 0.0], 0.5 * 4.0 / 9.0),
        (Gradient::Bspline, [1.0, 1.0, 0.0], 0.5 / 9.0),
        (Gradient::CatmullRom, [1.0, 0.0, 0.0], 0.5),
        (Gradient::CatmullRom, [1.0, 1.0, 0.0], 0.0),
    ] {
        assert_close(respond(estimator, offset), expected, 1e-15);
    }
}

/// Between voxels of what holds at voxels, one-sided on the border: the square of the index tells.
#[test]
fn central_differences_go_from_voxel_to_voxel() {
    let volume = volume_of([6, 2, 2], DAffine3::IDENTITY, |[i, _, _]| f64::from(i * i));
    let field = Field::new(&volume);
    let slope = |x| {
        let g = field
            .gradient_ws(DVec3::new(x, 0.3, 0.6), Gradient::CentralDifferences)
            .unwrap();
        assert_eq!((g.y, g.z), (0.0, 0.0));
        g.x
    };
    assert_close(slope(2.0), 4.0, 1e-12);
    assert_close(slope(2.5), 5.0, 1e-12);
    // A quarter of the way from 1, which voxel 0 finds on its one side, to 2.
    assert_close(slope(0.25), 1.25, 1e-12);
    // The two taps that shaders take: 0, and 2 / (2 - 0.25), where the field is 1 + 3 / 7.
    assert_close(slope(0.25), (10.0 / 7.0) / (8.0 / 7.0), 1e-12);
    assert_close(slope(4.6), 0.4 * 8.0 + 0.6 * 9.0, 1e-12);
    assert_close(slope(0.0), 1.0, 1e-12);
    assert_close(slope(5.0), 9.0, 1e-12);
}

/// Axes and gradient are such that every voxel value is exact in f32.
#[test]
fn gradients_are_in_world_space_whatever_the_placement() {
    let gradient = DVec3::new(3.0, -5.0, 2.0);
    for matrix in [
        DMat3::from_diagonal(DVec3::new(0.5, 2.0, 4.0)),
        DMat3::from_diagonal(DVec3::new(-1.0, 0.25, -2.0)),
        DMat3::from_cols(
            DVec3::new(0.0, 2.0, 0.0),
            DVec3::new(0.5, 0.0, 0.0),
            DVec3::new(0.0, 0.0, -1.0),
        ),
        DMat3::from_cols(
            DVec3::new(1.0, 0.25, 0.0),
            DVec3::new(0.5, 2.0, -0.5),
            DVec3::new(-0.25, 0.0, 1.5),
        ),
    ] {
        let placement = DAffine3::from_mat3_translation(matrix, DVec3::new(8.0, -16.0, 4.0));
        let volume = volume_of([8, 7, 9], placement, |v| {
            placement
                .transform_point3(DVec3::from_array(v.map(f64::from)))
                .dot(gradient)
        });
        let field = Field::new(&volume);
        // Two voxels from the faces every tap is inside.
        for p in [[3.5, 2.25, 4.0], [2.0, 4.0, 6.0], [4.9, 3.0, 2.1]] {
            for estimator in ESTIMATORS {
                let g = field.gradient_ws(DVec3::from_array(p), estimator).unwrap();
                assert!(
                    g.distance(gradient) < 1e-12,
                    "{estimator:?}: {g} under {matrix}"
                );
            }
        }
        for p in [[0.0, 0.0, 0.0], [0.25, 6.0, 7.5]] {
            let g = field.gradient_ws(DVec3::from_array(p), Gradient::CentralDifferences);
            assert!(g.unwrap().distance(gradient) < 1e-12, "{matrix}");
        }
    }
}

/// Beyond the faces, values are those on them: with a slope of 1, what is left of each estimator's weights.
#[test]
fn other_taps_are_clamped_to_the_field() {
    let volume = sampled([8; 3], |p| p.x);
    let field = Field::new(&volume);
    for (estimator, at_the_face, one_inside) in [
        (Gradient::CentralDifferences, 1.0, 1.0),
        (Gradient::FourPoint, (8.0 - 2.0) / 12.0, (16.0 - 3.0) / 12.0),
        (Gradient::Sobel, 0.5, 1.0),
        (Gradient::Regression, 0.5, 1.0),
        (Gradient::Bspline, 0.5, 1.0),
        (Gradient::CatmullRom, 0.5, 1.0),
    ] {
        for (x, expected) in [
            (0.0, at_the_face),
            (1.0, one_inside),
            (6.0, one_inside),
            (7.0, at_the_face),
        ] {
            let g = field
                .gradient_ws(DVec3::new(x, 3.0, 3.5), estimator)
                .unwrap();
            assert!(
                g.distance(DVec3::X * expected) < 1e-12,
                "{estimator:?} at {x}: {g}"
            );
        }
    }
}
