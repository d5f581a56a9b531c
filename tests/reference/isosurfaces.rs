//! Isosurfaces: where they are hit, in what order they are composited, and their normals.

use glam::{DAffine3, DVec2, DVec3};
use umbravox::reference::{Field, Light, LightGrid};
use umbravox::scene::{Gradient, Interpolation, RayProjection, Shading, Surface};
use umbravox::volume::Volume;

use crate::fixtures::{Tracer, assert_close, medium, volume_of};

fn surface(value: f64, color: [f64; 3], opacity: f64) -> Surface {
    Surface {
        value,
        color,
        opacity,
    }
}

fn tracer(volume: Volume, step: f64, surfaces: &[Surface]) -> Tracer {
    let mut tracer = Tracer::new(volume, medium(1.0, 0.0, [0.0; 3]), step);
    tracer.march.projection = RayProjection::Isosurface;
    tracer.march.classification = None;
    tracer.surfaces = surfaces.to_vec();
    tracer
}

/// Samples a function of the position on a grid of 1 mm around the origin.
fn centered(n: u32, f: impl Fn(DVec3) -> f64) -> Volume {
    let corner = DVec3::splat(-0.5 * f64::from(n - 1));
    volume_of([n; 3], DAffine3::from_translation(corner), |v| {
        f(corner + DVec3::from_array(v.map(f64::from)))
    })
}

const WHITE: [f64; 3] = [1.0; 3];

/// The distance to a sphere's centre: hits lie where the filter puts the surface, whatever the step.
///
/// Interpolation shifts a field of curvature 1/r by at most 1/8 of the Laplacian 2/r (linear), and by 1/6 of it
/// (B-spline, and what higher orders add). Catmull-Rom is exact to the second order; the third moment of its
/// weights, at most 0.0963, over 3! times the third derivatives, at most 2/sqrt(3) on each axis, is 0.056/r^2.
#[test]
fn a_sphere_is_hit_at_its_radius_whatever_the_step() {
    let radius = 11.3;
    let direction = DVec3::new(0.6, -0.48, 0.64);
    let across = DVec3::new(0.8, 0.36, -0.48);
    for (interpolation, limit) in [
        (Interpolation::Linear, 2.0 / (8.0 * radius)),
        (Interpolation::Bspline, 2.2 / (6.0 * radius)),
        (Interpolation::CatmullRom, 0.056 / (radius * radius)),
    ] {
        let hits = |step| {
            let mut tracer = tracer(
                centered(31, DVec3::length),
                step,
                &[surface(radius, WHITE, 1.0)],
            );
            tracer.march.interpolation = interpolation;
            (0..40).map(move |i| {
                let origin = across * (0.24 * f64::from(i)) - direction * 40.0;
                let pixel = tracer.ray(origin, direction);
                assert_eq!(pixel.rgba, [1.0; 4]);
                assert_eq!([pixel.median, pixel.expected], [pixel.depth; 2]);
                origin + direction * pixel.depth
            })
        };
        let finest: Vec<DVec3> = hits(0.05).collect();
        let error = |p: &DVec3| (p.length() - radius).abs();
        let largest = finest.iter().map(error).fold(0.0, f64::max);
        println!(
            "sphere of radius {radius}, {interpolation:?}: off by {largest:.6} voxels at most"
        );
        assert!(largest < limit, "{interpolation:?}: {largest} >= {limit}");
        for step in [0.2, 0.5, 1.0, 2.0, 4.0] {
            for (a, b) in hits(step).zip(&finest) {
                assert!(a.distance(*b) < 1e-8, "{interpolation:?} {step}: {a} {b}");
            }
        }
    }
}

/// In a linear field hits are exact, several in one segment come in order, and each weighs by what it lets through.
#[test]
fn surfaces_are_composited_in_the_order_of_travel() {
    let (red, green, blue) = ([0.8, 0.0, 0.0], [0.0, 0.6, 0.0], [0.0, 0.0, 0.4]);
    let surfaces = [
        surface(1.25, red, 0.4),
        surface(3.5, green, 0.5),
        surface(3.75, blue, 0.25),
    ];
    let volume = || volume_of([9, 3, 3], DAffine3::IDENTITY, |[i, _, _]| f64::from(i));
    for order in [[0, 1, 2], [2, 0, 1]] {
        let shuffled = order.map(|i| surfaces[i]);
        for step in [0.3, 1.0, 8.0] {
            let mut tracer = tracer(volume(), step, &shuffled);
            let there = tracer.ray(DVec3::new(-10.0, 1.2, 0.7), DVec3::X);
            let weights = [0.4, 0.6 * 0.5, 0.3 * 0.25];
            for (actual, expected) in
                there
                    .rgba
                    .into_iter()
                    .zip([0.8 * weights[0], 0.6 * weights[1], 0.4 * weights[2]])
            {
                assert_close(actual, expected, 1e-15);
            }
            let opacity: f64 = weights.iter().sum();
            assert_close(there.rgba[3], opacity, 1e-15);
            // Depth at the first, median at the second that makes it 0.7.
            assert_close(there.depth, 11.25, 1e-9);
            assert_close(there.median, 13.5, 1e-9);
            let sum = weights[0] * 11.25 + weights[1] * 13.5 + weights[2] * 13.75;
            assert_close(there.expected, sum / opacity, 1e-9);

            let back = tracer.ray(DVec3::new(20.0, 1.2, 0.7), DVec3::NEG_X);
            assert_close(back.rgba[2], 0.4 * 0.25, 1e-15);
            assert_close(back.rgba[1], 0.6 * (0.75 * 0.5), 1e-15);
            assert_close(back.rgba[0], 0.8 * (0.75 * 0.5 * 0.4), 1e-15);
            assert_close(back.depth, 20.0 - 3.75, 1e-9);

            tracer.march.early_termination = 0.7;
            let ended = tracer.ray(DVec3::new(-10.0, 1.2, 0.7), DVec3::X);
            assert_close(ended.rgba[3], 0.7, 1e-15);
            assert_eq!(f64::from(ended.samples), (3.5 / step).ceil());
        }
    }
}

/// A node exactly on the surface belongs to the side above: one crossing, not two or none; touching is none.
#[test]
fn a_surface_through_a_node_is_crossed_once() {
    let volume = volume_of([9, 3, 3], DAffine3::IDENTITY, |[i, _, _]| {
        f64::from(i).min(4.0)
    });
    for direction in [1.0, -1.0] {
        for (value, hits) in [(2.0, 1), (4.0, 1), (4.5, 0), (0.0, 0)] {
            let tracer = tracer(volume.clone(), 1.0, &[surface(value, WHITE, 0.5)]);
            let pixel = tracer.ray(
                DVec3::new(4.0 - 10.0 * direction, 1.0, 1.0),
                DVec3::X * direction,
            );
            assert_close(pixel.rgba[3], 0.5 * f64::from(hits), 1e-15);
            if hits == 1 {
                let at = 4.0 + direction * (pixel.depth - 10.0);
                assert_close(at, value, 1e-9);
            }
        }
    }
}

#[test]
fn surfaces_are_lit_where_they_are_hit() {
    let volume = volume_of([5; 3], DAffine3::IDENTITY, |[i, j, _]| f64::from(2 * i + j));
    let mut tracer = tracer(volume, 0.7, &[surface(5.3, [0.9, 0.5, 0.7], 0.8)]);
    tracer.light = Some(LightGrid::from_fn([5; 3], |[i, j, k]| Light {
        rgb: [f64::from(i), f64::from(j), f64::from(k)],
        grey: 0.0,
    }));
    tracer.lighting.shading = Shading::Diffuse;
    (tracer.lighting.ambient, tracer.lighting.diffuse) = (0.2, 0.9);
    // 2 x + 1.5 = 5.3; the headlight is along x and the gradient (2, 1, 0).
    let pixel = tracer.ray(DVec3::new(-1.0, 1.5, 2.25), DVec3::X);
    let shade = 0.2 + 0.9 * 2.0 / 5f64.sqrt();
    for (channel, expected) in [0.9 * 1.9, 0.5 * 1.5, 0.7 * 2.25].into_iter().enumerate() {
        assert_close(pixel.rgba[channel], 0.8 * expected * shade, 1e-8);
    }
}

/// Distance to a torus about z.
fn torus(p: DVec3) -> f64 {
    DVec2::new(p.truncate().length() - TORUS_RADIUS, p.z).length()
}

const TORUS_RADIUS: f64 = 8.0;
const TUBE_RADIUS: f64 = 3.5;

fn torus_normal(p: DVec3) -> DVec3 {
    let ring = p.truncate().normalize() * TORUS_RADIUS;
    (p - ring.extend(0.0)).normalize()
}

/// Root mean square angle to the torus's normals, and the largest excess of the turn from one hit to the next over
/// the torus's own: facets show as sudden turns. Degrees.
fn normal_errors(interpolation: Interpolation, gradient: Gradient) -> [f64; 2] {
    let mut tracer = tracer(
        centered(27, torus),
        0.5,
        &[surface(TUBE_RADIUS, WHITE, 1.0)],
    );
    tracer.march.interpolation = interpolation;
    let field = Field::new(&tracer.volume);
    let direction = DVec3::new(0.48, -0.36, -0.8);
    let (right, up) = (DVec3::new(0.6, 0.8, 0.0), DVec3::new(0.64, -0.48, 0.6));
    let (mut squares, mut count, mut sharpest) = (0.0, 0.0, 0f64);
    for y in -16..=16 {
        let mut last: Option<[DVec3; 2]> = None;
        for x in -220..=220 {
            let origin =
                right * (0.05 * f64::from(x)) + up * (0.5 * f64::from(y)) - direction * 30.0;
            let pixel = tracer.ray(origin, direction);
            let hit = origin + direction * pixel.depth;
            let exact = torus_normal(hit);
            // Not the silhouettes, where the next hit is far away, nor the part next to them.
            if !pixel.depth.is_finite() || exact.dot(direction).abs() < 0.3 {
                last = None;
                continue;
            }
            let ix = field.ix_from_world().transform_point3(hit);
            let normal = field.gradient_ws(ix, gradient).unwrap().normalize();
            squares += normal.angle_between(exact).powi(2);
            count += 1.0;
            if let Some([before, exact_before]) = last {
                let turn = (normal - before) - (exact - exact_before);
                sharpest = sharpest.max(turn.length());
            }
            last = Some([normal, exact]);
        }
    }
    [f64::sqrt(squares / count), sharpest].map(f64::to_degrees)
}

/// Linear values and differences show the grid; cubic derivatives smooth the shading, and cubic values the surface.
#[test]
fn normals_of_a_torus_by_filter() {
    println!(
        "values      gradient             rms angle  sharpest turn beyond the torus's, degrees"
    );
    let [linear, mixed, cubic, sharp] = [
        (Interpolation::Linear, Gradient::CentralDifferences),
        (Interpolation::Linear, Gradient::Bspline),
        (Interpolation::Bspline, Gradient::Bspline),
        (Interpolation::CatmullRom, Gradient::CatmullRom),
    ]
    .map(|(interpolation, gradient)| {
        let errors = normal_errors(interpolation, gradient);
        let [rms, turn] = errors;
        let [values, normals] = [format!("{interpolation:?}"), format!("{gradient:?}")];
        println!("{values:<10}  {normals:<19}  {rms:.4}     {turn:.4}");
        errors
    });
    assert!(mixed[1] < linear[1] && cubic[1] < mixed[1]);
    assert!(cubic[0] < linear[0] && sharp[0] < linear[0]);
}
