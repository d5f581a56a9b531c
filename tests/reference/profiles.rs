//! Fields that vary along the ray: errors of the quadrature, and their order.

use glam::{DAffine3, DVec3};
use umbravox::reference::analytic::{
    color_ramp, extinction, ramp_opacity, slab_opacity, sphere_chord,
};
use umbravox::volume::Volume;

use crate::fixtures::{Tracer, assert_close, curve, medium, volume_of};

/// Value = x index.
fn ramp_along_x() -> Volume {
    volume_of([17, 3, 3], DAffine3::IDENTITY, |[i, _, _]| f64::from(i))
}

/// Asserts that halving the step divides the error by four, within 3 %.
#[track_caller]
fn assert_second_order(error: impl Fn(f64) -> f64) {
    for step in [1.0, 0.5, 0.25, 0.125] {
        let ratio = error(step) / error(0.5 * step);
        assert!((ratio - 4.0).abs() < 0.12, "ratio {ratio} at step {step}");
    }
}

#[test]
fn closed_forms_of_a_ramp_agree_with_each_other_and_with_quadrature() {
    assert_close(
        ramp_opacity(0.3, 0.3, 2.0, 5.0),
        slab_opacity(0.3, 2.0, 5.0),
        1e-14,
    );
    let [near, far] = [
        ramp_opacity(0.3, 0.3 + 9e-6, 1.0, 1.0),
        ramp_opacity(0.3, 0.3 + 1.1e-5, 1.0, 1.0),
    ];
    let middle = |rise: f64| slab_opacity(0.3 + 0.5 * rise, 1.0, 1.0);
    assert_close(near, middle(9e-6), 1e-10);
    assert_close(far, middle(1.1e-5), 1e-10);
    // Midpoint rule with so many parts that its own error is below 1e-9.
    let parts = 200_000;
    let depth: f64 = (0..parts)
        .map(|i| {
            let a = 0.1 + 0.6 * (f64::from(i) + 0.5) / f64::from(parts);
            extinction(a, 2.0) * 5.0 / f64::from(parts)
        })
        .sum();
    assert_close(ramp_opacity(0.1, 0.7, 2.0, 5.0), 1.0 - (-depth).exp(), 1e-9);
    // All the way to opaque the optical depth is still finite: L/u.
    assert_close(
        ramp_opacity(0.0, 1.0, 2.0, 5.0),
        1.0 - (-2.5f64).exp(),
        1e-15,
    );
}

#[test]
fn a_ramp_of_opacity_converges_with_the_square_of_the_step() {
    let white = [1.0; 3];
    let ramp = curve(
        8.0,
        &[(0.0, white, 0.05, [0.0; 3]), (16.0, white, 0.85, [0.0; 3])],
    );
    let exact = ramp_opacity(0.05, 0.85, 8.0, 16.0);
    let opacity = |step| {
        let tracer = Tracer::new(ramp_along_x(), ramp.clone(), step);
        tracer.ray(DVec3::new(-4.0, 1.2, 0.8), DVec3::X).rgba[3]
    };
    assert_second_order(|step| (opacity(step) - exact).abs());
    assert_close(opacity(0.05), exact, 2e-6);
}

/// The order along the ray shows: the near end weighs more, from either side.
#[test]
fn a_ramp_of_color_converges_with_the_square_of_the_step() {
    let ends = [[0.1, 0.0, 0.5], [0.9, 1.0, 0.0]];
    let ramp = curve(
        4.0,
        &[
            (0.0, ends[0], 0.3, [0.0; 3]),
            (16.0, ends[1], 0.3, [0.0; 3]),
        ],
    );
    for (origin, direction, [near, far]) in [
        (-3.0, DVec3::X, [ends[0], ends[1]]),
        (20.0, DVec3::NEG_X, [ends[1], ends[0]]),
    ] {
        for channel in 0..3 {
            let exact = color_ramp(near[channel], far[channel], extinction(0.3, 4.0), 16.0);
            let color = |step| {
                let tracer = Tracer::new(ramp_along_x(), ramp.clone(), step);
                tracer.ray(DVec3::new(origin, 1.0, 1.0), direction).rgba[channel]
            };
            assert_second_order(|step| (color(step) - exact).abs());
            assert_close(color(0.05), exact, 2e-6);
        }
    }
}

/// A ball of constant opacity. Its surface is where the curve jumps, so a chord is right to one step, and to
/// what trilinear interpolation of the distance shifts the surface by: `h^2 / (4 r)` at most.
#[test]
fn profile_of_a_sphere() {
    let (n, radius, opacity) = (33, 12.0, 0.06);
    let center = DVec3::splat(16.0);
    let volume = volume_of([n; 3], DAffine3::IDENTITY, |v| {
        DVec3::from_array(v.map(f64::from)).distance(center)
    });
    let clear = ([0.0; 3], 0.0, [0.0; 3]);
    let ball = curve(
        1.0,
        &[
            (0.0, [1.0; 3], opacity, [0.0; 3]),
            (radius, [1.0; 3], opacity, [0.0; 3]),
            (radius, clear.0, clear.1, clear.2),
        ],
    );
    let step = 0.05;
    let tracer = Tracer::new(volume, ball, step);
    let direction = DVec3::new(0.8, 0.6, 0.0);
    let across = DVec3::new(-0.36, 0.48, 0.8);
    for i in 0..=10 {
        let distance = 0.09 * f64::from(i) * radius;
        let pixel = tracer.ray(center + across * distance - direction * 40.0, direction);
        let chord = sphere_chord(radius, distance);
        let shift = 1.0 / (4.0 * radius);
        let longest = sphere_chord(radius + shift, distance) + step;
        let shortest = sphere_chord(radius - shift, distance) - step;
        let [low, high] = [shortest, longest].map(|l| slab_opacity(opacity, 1.0, l));
        assert!(low < pixel.rgba[3] && pixel.rgba[3] < high, "{distance}");
        assert_close(pixel.rgba[3], slab_opacity(opacity, 1.0, chord), 0.01);
        assert_close(pixel.rgba[0], pixel.rgba[3], 1e-14);
    }
    let miss = tracer.ray(
        center + across * (radius + 0.1) - direction * 40.0,
        direction,
    );
    assert_eq!(miss.rgba, [0.0; 4]);
}

#[test]
fn chords_of_a_sphere() {
    assert_eq!(sphere_chord(5.0, 3.0), 8.0);
    assert_eq!(sphere_chord(5.0, 0.0), 10.0);
    assert_eq!(sphere_chord(5.0, 5.1), 0.0);
    // Extinction and opacity are inverse to each other.
    assert_close(slab_opacity(0.3, 2.0, 2.0), 0.3, 1e-15);
    let tracer = Tracer::new(ramp_along_x(), medium(1.0, 1.0, [1.0; 3]), 1.0);
    assert_eq!(
        tracer.ray(DVec3::new(-1.0, 1.0, 1.0), DVec3::X).rgba[3],
        1.0
    );
}
