//! Orders of classification: the transfer function before, after and along with interpolation.

use glam::{DAffine3, DVec3};
use umbravox::reference::analytic::{color_ramp, extinction, ramp_opacity, slab_opacity};
use umbravox::reference::{Contribution, preintegrate};
use umbravox::scene::{Classification, Curve, Interpolation};

use crate::fixtures::{Tracer, assert_close, curve, homogeneous, medium, volume_of};

/// Ramps, plateaus, a jump, a peak, an opaque end; every channel different.
fn varied() -> Curve {
    curve(
        0.8,
        &[
            (0.0, [0.1, 0.9, 0.4], 0.0, [0.0, 0.2, 0.0]),
            (1.0, [0.8, 0.2, 0.4], 0.3, [0.5, 0.0, 0.1]),
            (2.0, [0.8, 0.2, 0.9], 0.3, [0.0, 0.0, 2.0]),
            (2.0, [0.2, 0.7, 0.1], 0.6, [1.0, 0.0, 0.0]),
            (2.1, [0.9, 0.1, 0.0], 0.95, [0.0; 3]),
            (2.2, [0.3, 0.3, 0.3], 0.05, [0.0; 3]),
            (4.0, [0.5, 0.6, 0.7], 1.0, [0.1, 0.3, 0.0]),
        ],
    )
}

const ENDS: [(f64, f64); 9] = [
    (0.2, 0.9),
    (0.9, 0.2),
    (-1.0, 2.05),
    (2.3, -0.5),
    (1.9, 2.3),
    (2.0, 2.2),
    (2.0, 1.0),
    (0.5, 3.9),
    (3.99, 2.5),
];

/// Puts one contribution behind another.
fn over(near: Contribution, far: Contribution) -> Contribution {
    let transparency = (-near.depth).exp();
    Contribution {
        depth: near.depth + far.depth,
        color: near.color + transparency * far.color,
        emission: near.emission + transparency * far.emission,
    }
}

/// `parts` equal parts of a segment, each by `part(front, back, length)`.
fn in_parts(
    (front, back): (f64, f64),
    length: f64,
    parts: u32,
    part: impl Fn(f64, f64, f64) -> Contribution,
) -> Contribution {
    let value = |i: u32| front + (back - front) * f64::from(i) / f64::from(parts);
    let length = length / f64::from(parts);
    (0..parts)
        .map(|i| part(value(i), value(i + 1), length))
        .fold(Contribution::default(), over)
}

#[track_caller]
fn assert_same(a: Contribution, b: Contribution, tolerance: f64) {
    assert_close(a.alpha(), b.alpha(), tolerance);
    assert!(a.color.distance(b.color) < tolerance, "{a:?} {b:?}");
    assert!(a.emission.distance(b.emission) < tolerance, "{a:?} {b:?}");
}

/// The integral of the whole is that of a thousand parts; and that of a plain midpoint rule, to its own error.
#[test]
fn one_segment_equals_many() {
    let curve = varied();
    for ends in ENDS {
        for length in [0.01, 1.0, 30.0] {
            let whole = preintegrate(&curve, ends.0, ends.1, length);
            let parts = in_parts(ends, length, 1000, |front, back, length| {
                preintegrate(&curve, front, back, length)
            });
            assert_same(whole, parts, 1e-11);
            let samples = in_parts(ends, length, 100_000, |front, back, length| {
                let optical = curve.evaluate(0.5 * (front + back));
                let alpha = slab_opacity(optical.opacity, curve.unit_distance, length);
                Contribution {
                    depth: extinction(optical.opacity, curve.unit_distance) * length,
                    color: alpha * DVec3::from_array(optical.color),
                    emission: alpha * DVec3::from_array(optical.emission),
                }
            });
            // A jump inside a part is misplaced by half of it.
            assert_same(whole, samples, 2e-5);
        }
    }
}

/// Light passes as well either way; what is seen differs.
#[test]
fn opacity_does_not_depend_on_the_side_and_color_does() {
    let curve = varied();
    for (front, back) in ENDS {
        let [there, back] = [
            preintegrate(&curve, front, back, 1.3),
            preintegrate(&curve, back, front, 1.3),
        ];
        assert_close(there.depth, back.depth, 1e-14 * there.depth.max(1.0));
        assert!(there.color.distance(back.color) > 1e-3);
    }
}

#[test]
fn a_segment_of_one_value_is_homogeneous() {
    let curve = varied();
    for value in [-3.0, 0.0, 0.4, 1.0, 1.5, 2.0, 2.15, 3.7] {
        for length in [1e-6, 0.3, 5.0] {
            let segment = preintegrate(&curve, value, value, length);
            let optical = curve.evaluate(value);
            let alpha = slab_opacity(optical.opacity, 0.8, length);
            assert_close(segment.alpha(), alpha, 1e-15);
            let color = alpha * DVec3::from_array(optical.color);
            assert!(segment.color.distance(color) < 1e-15);
            let emission = alpha * DVec3::from_array(optical.emission);
            assert!(segment.emission.distance(emission) < 1e-15);
        }
    }
}

/// Opacity from 0.1 to 0.9 with one colour, and colours from one to another with one opacity; thin to dense.
#[test]
fn segments_with_a_closed_form() {
    let white = [1.0; 3];
    let opacity = curve(
        2.0,
        &[(0.0, white, 0.1, [0.0; 3]), (1.0, white, 0.9, [0.0; 3])],
    );
    let colors = [[0.1, 0.0, 0.5], [0.9, 1.0, 0.0]];
    let color = curve(
        2.0,
        &[
            (0.0, colors[0], 0.3, colors[1]),
            (1.0, colors[1], 0.3, colors[0]),
        ],
    );
    for length in [1e-3, 0.1, 1.0, 10.0, 1e3, 1e5] {
        let segment = preintegrate(&opacity, 0.0, 1.0, length);
        let alpha = ramp_opacity(0.1, 0.9, 2.0, length);
        assert_close(segment.alpha(), alpha, 1e-15);
        assert!(segment.color.distance(DVec3::splat(alpha)) < 1e-14);

        let tau = extinction(0.3, 2.0);
        let segment = preintegrate(&color, 0.0, 1.0, length);
        assert_close(segment.alpha(), slab_opacity(0.3, 2.0, length), 1e-14);
        for channel in 0..3 {
            let [first, last] = colors.map(|c| c[channel]);
            let there = color_ramp(first, last, tau, length);
            assert_close(segment.color[channel], there, 1e-10);
            let back = color_ramp(last, first, tau, length);
            assert_close(segment.emission[channel], back, 1e-10);
        }
    }
}

/// Of a homogeneous segment with the transparency `theta`, the share `b` has the transparency `theta^b` and the
/// colour `C (1 - theta^b) / (1 - theta)`.
#[test]
fn part_of_a_segment() {
    let medium = medium(1.5, 0.7, [0.2, 0.5, 0.9]);
    let whole = preintegrate(&medium, 0.0, 0.0, 2.0);
    let theta = 1.0 - whole.alpha();
    for b in [0.01, 0.3, 0.5, 0.99] {
        let part = preintegrate(&medium, 0.0, 0.0, 2.0 * b);
        assert_close(1.0 - part.alpha(), theta.powf(b), 1e-15);
        let color = whole.color * ((1.0 - theta.powf(b)) / (1.0 - theta));
        assert!(part.color.distance(color) < 1e-15);
    }
}

/// Opaque matter hides what is behind it; one opaque point does not.
#[test]
fn opaque_matter_in_a_segment() {
    let [red, blue] = [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
    let wall = curve(
        1.0,
        &[
            (0.0, red, 0.0, [0.0; 3]),
            (1.0, red, 0.0, [0.0; 3]),
            (1.0, blue, 1.0, [0.0; 3]),
            (2.0, red, 1.0, [0.0; 3]),
            (2.0, red, 0.5, [0.0; 3]),
        ],
    );
    let front = preintegrate(&wall, 0.0, 3.0, 1.0);
    assert_eq!((front.alpha(), front.color), (1.0, DVec3::from_array(blue)));
    let behind = preintegrate(&wall, 3.0, 0.0, 3.0);
    let seen = slab_opacity(0.5, 1.0, 1.0);
    assert_eq!(behind.alpha(), 1.0);
    assert_close(behind.color.x, 1.0, 1e-15);
    assert_close(seen, 0.5, 1e-15);
    // int_0^1 -ln(1 - s) ds = 1.
    let point = curve(1.0, &[(0.0, red, 0.0, [0.0; 3]), (1.0, red, 1.0, [0.0; 3])]);
    assert_close(preintegrate(&point, 0.0, 1.0, 0.7).depth, 0.7, 1e-15);
    assert_close(preintegrate(&point, 1.0, 0.0, 0.7).depth, 0.7, 1e-15);
}

/// A ray through a ramp, in which the value is linear along any segment, has no error at any step.
#[test]
fn a_linear_field_is_integrated_exactly_at_any_step() {
    let volume = || volume_of([17, 3, 3], DAffine3::IDENTITY, |[i, _, _]| f64::from(i));
    let ramp = curve(
        8.0,
        &[
            (0.0, [1.0; 3], 0.05, [0.0; 3]),
            (16.0, [1.0; 3], 0.85, [0.0; 3]),
        ],
    );
    let exact = ramp_opacity(0.05, 0.85, 8.0, 16.0);
    for step in [0.3, 0.5, 1.0, 2.0, 7.0, 16.0] {
        let mut tracer = Tracer::new(volume(), ramp.clone(), step);
        tracer.march.classification = Some(Classification::Preintegrated);
        for shift in [0.0, 0.4] {
            let pixel = tracer.jittered(DVec3::new(-4.0, 1.2, 0.8), DVec3::X, shift);
            assert_close(pixel.rgba[3], exact, 1e-13);
            assert_close(pixel.rgba[0], exact, 1e-13);
        }
    }
}

/// Shells thinner than a step around a centre: sampled, they come and go from ray to ray; integrated, they stay
/// within a few percent of what fine steps find.
#[test]
fn thin_shells_are_not_missed() {
    let volume = || {
        volume_of([41; 3], DAffine3::IDENTITY, |v| {
            DVec3::from_array(v.map(f64::from)).distance(DVec3::splat(20.0))
        })
    };
    let shell = curve(
        1.0,
        &[
            (11.9, [1.0, 0.4, 0.2], 0.0, [0.0; 3]),
            (12.0, [1.0, 0.4, 0.2], 0.9, [0.0; 3]),
            (12.1, [1.0, 0.4, 0.2], 0.0, [0.0; 3]),
        ],
    );
    let opacities = |classification, step| {
        let mut tracer = Tracer::new(volume(), shell.clone(), step);
        tracer.march.classification = Some(classification);
        (0..60).map(move |i| {
            let offset = DVec3::new(0.13 * f64::from(i), 0.3, 0.0);
            tracer
                .ray(DVec3::new(20.0, 20.0, -9.0) + offset, DVec3::Z)
                .rgba[3]
        })
    };
    let exact: Vec<f64> = opacities(Classification::Post, 0.002).collect();
    let largest_error = |classification| {
        let errors = opacities(classification, 1.0).zip(&exact);
        errors.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    let [post, preintegrated] =
        [Classification::Post, Classification::Preintegrated].map(largest_error);
    println!("shell a tenth of a step thick: post {post:.4}, preintegrated {preintegrated:.4}");
    assert!(exact.iter().all(|a| *a > 0.1));
    assert!(post > 0.1 && preintegrated < 0.01, "{post} {preintegrated}");
}

/// Between an opaque red voxel and a clear blue one: associated colours are red all the way, `a = w a_red`.
#[test]
fn classified_voxels_are_interpolated_associated() {
    let volume = volume_of([2, 3, 3], DAffine3::IDENTITY, |[i, _, _]| f64::from(i));
    let (red, blue) = ([1.0, 0.0, 0.0], [0.0, 0.0, 1.0]);
    let glow = [0.0, 0.6, 0.0];
    let points = [
        (0.0, red, 0.8, glow),
        (0.5, blue, 0.9, [0.0; 3]),
        (1.0, blue, 0.0, [0.0; 3]),
    ];
    let mut tracer = Tracer::new(volume, curve(1.0, &points), 2.0);
    tracer.march.classification = Some(Classification::Pre);
    for x in [0.0, 0.25, 0.5, 0.9] {
        let pixel = tracer.ray(DVec3::new(x, 1.0, -1.0), DVec3::Z);
        let alpha = slab_opacity((1.0 - x) * 0.8, 1.0, 2.0);
        for (channel, expected) in [1.0, 0.6, 0.0, 1.0].into_iter().enumerate() {
            assert_close(pixel.rgba[channel], expected * alpha, 1e-14);
        }
    }
    let clear = tracer.ray(DVec3::new(1.0, 1.0, -1.0), DVec3::Z);
    assert_eq!(clear.rgba, [0.0; 4]);
}

/// The order does not matter where interpolation changes nothing, or where the function is a line.
#[test]
fn orders_agree_where_they_must() {
    let value = |[i, j, k]: [u32; 3]| f64::from((3 * i + 5 * j + 2 * k) % 7);
    let line = [
        (0.0, [0.7; 3], 0.1, [0.1; 3]),
        (7.0, [0.7; 3], 0.8, [0.1; 3]),
    ];
    let pixel = |points, interpolation, classification| {
        let volume = volume_of([6; 3], DAffine3::IDENTITY, value);
        let mut tracer = Tracer::new(volume, curve(1.0, points), 0.37);
        tracer.march.interpolation = interpolation;
        tracer.march.classification = Some(classification);
        tracer
            .ray(DVec3::new(-1.0, 1.3, 2.2), DVec3::new(1.0, 0.3, 0.2))
            .rgba
    };
    let bent = [
        (0.0, [0.9, 0.1, 0.3], 0.1, [0.0; 3]),
        (3.0, [0.0; 3], 0.5, [0.2; 3]),
        line[1],
    ];
    for (points, interpolation, same) in [
        (&line[..], Interpolation::Linear, true),
        (&bent[..], Interpolation::Linear, false),
        (&bent[..], Interpolation::Nearest, true),
    ] {
        let [pre, post] = [Classification::Pre, Classification::Post]
            .map(|order| pixel(points, interpolation, order));
        let difference = (0..4).map(|c| (pre[c] - post[c]).abs()).fold(0.0, f64::max);
        assert_eq!(
            difference < 1e-13,
            same,
            "{interpolation:?}: {difference:e}"
        );
    }
}

#[test]
fn homogeneous_media_look_alike_in_every_order() {
    for order in [
        Classification::Pre,
        Classification::Post,
        Classification::Preintegrated,
    ] {
        let mut tracer = Tracer::new(homogeneous(6, 2.0), medium(3.0, 0.4, [0.3, 0.6, 0.9]), 0.7);
        tracer.march.classification = Some(order);
        let pixel = tracer.ray(DVec3::new(-3.0, 5.0, 5.0), DVec3::X);
        let alpha = slab_opacity(0.4, 3.0, 10.0);
        for (channel, c) in [0.3, 0.6, 0.9, 1.0].into_iter().enumerate() {
            assert_close(pixel.rgba[channel], c * alpha, 1e-13);
        }
    }
}
