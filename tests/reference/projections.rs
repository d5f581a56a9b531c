//! Projections other than emission and absorption, and the layers of distances and values.

use glam::{DAffine3, DVec3};
use umbravox::reference::analytic::{extinction, ramp_opacity, slab_opacity, sphere_chord};
use umbravox::reference::{Field, Pixel, Ray};
use umbravox::scene::{Classification, Interpolation, RayProjection};
use umbravox::volume::Volume;

use crate::fixtures::{Tracer, assert_close, curve, homogeneous, medium, volume_of};

/// Values without symmetry, 0 to 100.
fn rugged() -> Volume {
    volume_of(
        [9, 8, 10],
        DAffine3::from_scale(DVec3::new(1.0, 1.5, 0.8)),
        |[i, j, k]| f64::from((37 * i + 59 * j + 83 * k + i * j * k) % 101),
    )
}

/// Colour and emission differ by value.
fn tracer(projection: RayProjection, step: f64) -> Tracer {
    let points = [
        (0.0, [0.2, 0.4, 0.0], 0.1, [0.0, 0.3, 0.0]),
        (100.0, [1.0, 0.4, 0.2], 0.9, [0.1, 0.0, 0.5]),
    ];
    let mut tracer = Tracer::new(rugged(), curve(1.0, &points), step);
    tracer.march.projection = projection;
    tracer.march.classification = None;
    tracer
}

const RAYS: [(DVec3, DVec3); 4] = [
    (DVec3::new(-3.0, 4.0, 3.0), DVec3::X),
    (DVec3::new(12.0, 9.0, -2.0), DVec3::new(-0.8, -0.4, 0.6)),
    (DVec3::new(4.0, -5.0, 2.5), DVec3::new(0.05, 1.0, 0.1)),
    (DVec3::new(3.3, 4.4, 2.2), DVec3::new(0.3, -0.5, 0.7)),
];

/// Value, distance and length of every sample, worked out apart from the march.
fn samples(tracer: &Tracer, origin: DVec3, direction: DVec3) -> Vec<[f64; 3]> {
    let direction = direction.normalize();
    let field = Field::new(&tracer.volume);
    let span = Ray { origin, direction }.span(field.ix_from_world(), field.last_ix());
    let segments = span
        .unwrap()
        .segments(tracer.march.step * tracer.volume.min_spacing(), 0.0);
    segments
        .map(|segment| {
            let p = origin + direction * segment.middle();
            let ix = field.ix_from_world().transform_point3(p);
            let value = field.sample(ix, tracer.march.interpolation).unwrap();
            [value, segment.middle(), segment.length()]
        })
        .collect()
}

#[track_caller]
fn assert_classified(pixel: &Pixel, tracer: &Tracer) {
    let optical = tracer.curve.evaluate(pixel.value);
    for channel in 0..3 {
        let emission = f64::from(u8::from(tracer.lighting.emission)) * optical.emission[channel];
        let color = optical.color[channel] + emission;
        assert_close(pixel.rgba[channel], optical.opacity * color, 1e-15);
    }
    assert_close(pixel.rgba[3], optical.opacity, 0.0);
}

#[test]
fn extrema_are_those_of_all_samples() {
    for interpolation in [
        Interpolation::Nearest,
        Interpolation::Linear,
        Interpolation::Bspline,
    ] {
        for (projection, sign) in [
            (RayProjection::Maximum, 1.0),
            (RayProjection::Minimum, -1.0),
        ] {
            let mut tracer = tracer(projection, 0.4);
            tracer.march.interpolation = interpolation;
            tracer.lighting.emission = interpolation != Interpolation::Linear;
            for (origin, direction) in RAYS {
                let pixel = tracer.ray(origin, direction);
                let all = samples(&tracer, origin, direction);
                assert_eq!(pixel.samples as usize, all.len());
                let extremum = all.iter().map(|s| sign * s[0]).fold(f64::MIN, f64::max);
                assert_eq!(sign * pixel.value, extremum);
                let first = all.iter().find(|s| sign * s[0] == extremum).unwrap();
                assert_close(pixel.depth, first[1], 1e-12);
                assert_eq!([pixel.median, pixel.expected], [pixel.depth; 2]);
                assert_classified(&pixel, &tracer);
            }
        }
    }
}

/// Along whole steps the samples are the same from either end.
#[test]
fn extrema_do_not_depend_on_the_side() {
    for projection in [
        RayProjection::Maximum,
        RayProjection::Minimum,
        RayProjection::Mean,
    ] {
        let tracer = tracer(projection, 0.5);
        // 8 voxels of 1 mm, in steps of 0.5 * 0.8 mm.
        for y in [0.3, 4.9, 10.0] {
            let there = tracer.ray(DVec3::new(-2.0, y, 3.1), DVec3::X);
            let back = tracer.ray(DVec3::new(10.0, y, 3.1), DVec3::NEG_X);
            assert_close(there.value, back.value, 1e-11);
            if projection != RayProjection::Mean {
                assert_close(there.depth + back.depth, 12.0, 1e-11);
            }
        }
    }
}

#[test]
fn the_mean_is_weighted_by_length() {
    let tracer = tracer(RayProjection::Mean, 0.7);
    for (origin, direction) in RAYS {
        let pixel = tracer.ray(origin, direction);
        let all = samples(&tracer, origin, direction);
        let length: f64 = all.iter().map(|s| s[2]).sum();
        let sum: f64 = all.iter().map(|s| s[0] * s[2]).sum();
        assert_close(pixel.value, sum / length, 1e-11);
        assert!(
            [pixel.depth, pixel.median, pixel.expected]
                .iter()
                .all(|d| d.is_infinite())
        );
        assert_classified(&pixel, &tracer);
    }
    // 16 mm in five steps of 3 and one of 1: the mean of a line is its middle.
    let line = volume_of([17, 3, 3], DAffine3::IDENTITY, |[i, _, _]| f64::from(i));
    let mut tracer = Tracer::new(line, medium(1.0, 0.5, [1.0; 3]), 3.0);
    tracer.march.projection = RayProjection::Mean;
    let pixel = tracer.ray(DVec3::new(-1.0, 1.0, 1.0), DVec3::X);
    assert_close(pixel.value, 8.0, 1e-13);
}

#[test]
fn rays_without_segments_have_no_value() {
    for projection in [
        RayProjection::Maximum,
        RayProjection::Minimum,
        RayProjection::Mean,
    ] {
        let pixel = tracer(projection, 0.5).ray(DVec3::new(-3.0, -1.0, 2.0), DVec3::X);
        assert_eq!((pixel.rgba, pixel.samples), ([0.0; 4], 0));
        assert!(pixel.value.is_nan());
        assert!(
            [pixel.depth, pixel.median, pixel.expected]
                .iter()
                .all(|d| d.is_infinite())
        );
    }
    let pixel = tracer(RayProjection::Xray, 0.5).ray(DVec3::new(-3.0, -1.0, 2.0), DVec3::X);
    assert_eq!((pixel.rgba, pixel.value), ([0.0; 4], 0.0));
}

/// A slab, whatever the step and early termination; and opaque matter.
#[test]
fn xray_of_a_slab() {
    for order in [
        Classification::Pre,
        Classification::Post,
        Classification::Preintegrated,
    ] {
        for step in [0.3, 1.0, 3.0] {
            let mut tracer = Tracer::new(homogeneous(9, 2.0), medium(5.0, 0.9, [1.0; 3]), step);
            tracer.march.projection = RayProjection::Xray;
            tracer.march.classification = Some(order);
            tracer.march.early_termination = 0.5;
            let direction = DVec3::new(1.0, 0.2, -0.3);
            let pixel = tracer.ray(DVec3::new(-5.0, 6.0, 12.0), direction);
            let length = 16.0 * direction.length();
            assert_close(pixel.value, extinction(0.9, 5.0) * length, 1e-12);
            assert_eq!(pixel.rgba[..3], [0.0; 3]);
            assert_close(pixel.rgba[3], slab_opacity(0.9, 5.0, length), 1e-13);
        }
    }
    let mut tracer = Tracer::new(homogeneous(3, 1.0), medium(1.0, 1.0, [1.0; 3]), 0.5);
    tracer.march.projection = RayProjection::Xray;
    let pixel = tracer.ray(DVec3::new(-1.0, 1.0, 1.0), DVec3::X);
    assert_eq!((pixel.value, pixel.rgba[3]), (f64::INFINITY, 1.0));
}

#[test]
fn xray_of_a_ramp() {
    let ramp = curve(
        8.0,
        &[
            (0.0, [1.0; 3], 0.05, [0.0; 3]),
            (16.0, [1.0; 3], 0.85, [0.0; 3]),
        ],
    );
    let volume = volume_of([17, 3, 3], DAffine3::IDENTITY, |[i, _, _]| f64::from(i));
    let mut tracer = Tracer::new(volume, ramp, 2.5);
    tracer.march.projection = RayProjection::Xray;
    tracer.march.classification = None;
    let pixel = tracer.ray(DVec3::new(-1.0, 1.0, 1.0), DVec3::X);
    let exact = ramp_opacity(0.05, 0.85, 8.0, 16.0);
    assert_close(pixel.value, -(1.0 - exact).ln(), 1e-13);
    assert_close(pixel.rgba[3], exact, 1e-14);
}

/// The depth of a ball is its chord times the extinction, to what interpolation shifts its surface by.
#[test]
fn xray_of_a_ball() {
    let (radius, tau) = (12.0, extinction(0.2, 1.0));
    let center = DVec3::splat(16.0);
    let volume = volume_of([33; 3], DAffine3::IDENTITY, |v| {
        DVec3::from_array(v.map(f64::from)).distance(center)
    });
    let ball = curve(
        1.0,
        &[
            (radius, [1.0; 3], 0.2, [0.0; 3]),
            (radius, [1.0; 3], 0.0, [0.0; 3]),
        ],
    );
    let mut tracer = Tracer::new(volume, ball, 0.5);
    tracer.march.projection = RayProjection::Xray;
    tracer.march.classification = None;
    let (direction, across) = (DVec3::new(0.8, 0.6, 0.0), DVec3::new(-0.36, 0.48, 0.8));
    for i in 0..=9 {
        let distance = 0.1 * f64::from(i) * radius;
        let pixel = tracer.ray(center + across * distance - direction * 40.0, direction);
        // Within a segment the distance to the centre bends by less than step^2 / (8 r) too.
        let shift = 1.0 / (4.0 * radius) + 0.25 / (8.0 * radius);
        let [low, high] = [-shift, shift].map(|shift| tau * sphere_chord(radius + shift, distance));
        assert!(
            (low..=high).contains(&pixel.value),
            "{distance}: {} {low} {high}",
            pixel.value
        );
    }
}

/// Equal segments of opacity `alpha = 1 - q` weigh `q^i (1-q)`; the sum of their middles is a geometric one.
#[test]
fn distances_in_a_slab() {
    let (opacity, unit) = (0.3, 4.0);
    for projection in [RayProjection::Composite, RayProjection::Xray] {
        for step in [0.5, 1.0, 0.05] {
            let mut tracer =
                Tracer::new(homogeneous(9, 2.0), medium(unit, opacity, [1.0; 3]), step);
            tracer.march.projection = projection;
            let pixel = tracer.ray(DVec3::new(-10.0, 5.0, 6.0), DVec3::X);
            let d = 2.0 * step;
            let tau = extinction(opacity, unit);
            let (q, n) = ((-tau * d).exp(), (16.0 / d).round());
            let mean = q / (1.0 - q) - n * q.powf(n) / (1.0 - q.powf(n));
            assert_close(pixel.expected, 10.0 + d * (0.5 + mean), 1e-11);
            // The first segment whose far end is past ln 2 / tau, and past the threshold's own depth.
            for (actual, share) in [(pixel.median, 0.5), (pixel.depth, 0.05)] {
                let segment = (-f64::ln(1.0 - share) / (tau * d)).ceil() - 1.0;
                assert_close(actual, 10.0 + (segment + 0.5) * d, 1e-11);
            }
            if step == 0.05 {
                // int t tau exp(-tau t) dt / (1 - exp(-tau L)).
                let transparency = (-tau * 16.0).exp();
                let exact = 1.0 / tau - 16.0 * transparency / (1.0 - transparency);
                assert_close(pixel.expected, 10.0 + exact, 1e-4);
            }
        }
    }
}

#[test]
fn distances_of_what_is_hardly_there() {
    let faint = Tracer::new(homogeneous(9, 1.0), medium(8.0, 0.4, [1.0; 3]), 1.0);
    let pixel = faint.ray(DVec3::new(-1.0, 4.0, 4.0), DVec3::X);
    assert!(pixel.median.is_infinite() && pixel.expected.is_finite() && pixel.value.is_nan());
    let clear = Tracer::new(homogeneous(9, 1.0), medium(8.0, 0.0, [1.0; 3]), 1.0);
    let pixel = clear.ray(DVec3::new(-1.0, 4.0, 4.0), DVec3::X);
    assert!(
        [pixel.depth, pixel.median, pixel.expected]
            .iter()
            .all(|d| d.is_infinite())
    );
    assert_eq!(pixel.samples, 8);
}
