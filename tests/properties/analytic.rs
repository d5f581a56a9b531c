//! Closed forms, for steps of 0.05 to 2 voxels and voxels of 1e-3 to 1e3 mm.

use glam::DVec3;
use umbravox::conformance::synthetic::{cameras, rays};
use umbravox::picture::Picture;
use umbravox::reference::analytic::{ramp_opacity, slab_opacity, sphere_chord};
use umbravox::scene::{Camera, ControlPoint, View, linear_from_srgb};
use umbravox::volume::{Rescale, Volume, VoxelType};

use crate::fields::{placed, sampled};
use crate::sessions::{Subject, assert_valid, bounds, device, point, span};

const STEPS: [f64; 5] = [0.05, 0.13, 0.5, 1.0, 2.0];
const SPACINGS: [f64; 5] = [1e-3, 0.04, 1.0, 25.0, 1e3];
const SIZE: [u32; 2] = [24, 20];
/// What 32-bit floats may add up to.
const ROUNDING: f64 = 1e-5;

/// Pictures of a volume with every step, and the view they are seen by.
fn pictures(
    volume: &Volume,
    camera: &Camera,
    unit: f64,
    points: &[ControlPoint],
) -> (View, Vec<(f64, Picture)>) {
    let device = device(|_| {});
    let view = camera.view(volume, SIZE).unwrap();
    let subject = Subject::new(volume.clone(), camera.clone(), SIZE, unit, points.to_vec());
    let mut session = subject.session(&device);
    let pictures = STEPS.map(|step| {
        let mut settings = session.settings().clone();
        settings.march.step = step;
        session.set_settings(settings).unwrap();
        (step, session.frame().unwrap())
    });
    assert_valid(&device);
    (view, pictures.to_vec())
}

/// Asserts that every pixel has the opacity of `bounds_of` (smallest and largest) give or take rounding; how far it goes beyond.
fn check(
    name: &str,
    pictures: &[(f64, Picture)],
    rays: &[(DVec3, DVec3)],
    bounds_of: impl Fn(f64, (DVec3, DVec3)) -> [f64; 2],
    worst: &mut f64,
) {
    for (step, picture) in pictures {
        for (pixel, &ray) in picture.rgba.iter().zip(rays) {
            let opacity = f64::from(pixel[3]);
            let [low, high] = bounds_of(*step, ray);
            let beyond = (low - opacity).max(opacity - high).max(0.0);
            *worst = worst.max(beyond);
            assert!(
                beyond <= ROUNDING,
                "{name}, step {step}: {opacity} outside {low} to {high}"
            );
        }
    }
}

/// A homogeneous box that absorbs and emits: opacity `1 - exp(-tau L)`, radiance `(c + e) A`, whatever the step.
#[test]
fn homogeneous_media() {
    let mut worst = [0f64; 2];
    for voxel_type in [VoxelType::F32, VoxelType::U8, VoxelType::I16] {
        for spacing in SPACINGS {
            let placement = placed(
                [spacing, 1.3 * spacing, 0.8 * spacing],
                [1.0, 2.0, 3.0],
                40.0,
                [2.0 * spacing; 3],
            );
            let plain = Rescale::default();
            let volume = sampled(
                voxel_type,
                [19, 17, 34],
                placement,
                plain,
                [0.0, 100.0],
                |_| 0.5,
            );
            let (color, emission, opacity) = ([0.9, 0.4, 0.1], [0.0, 0.2, 0.3], 0.08);
            let mut medium = point(50.0, color, opacity);
            medium.emission = emission;
            let unit = spacing;
            for camera in cameras(&volume) {
                let (view, pictures) = pictures(&volume, &camera, unit, &[medium.clone()]);
                let rays: Vec<_> = rays(&view, SIZE).collect();
                let exact = |ray| {
                    let length = span(&volume, ray).map_or(0.0, |[enter, exit]| exit - enter);
                    slab_opacity(opacity, unit, length)
                };
                let name = format!("{voxel_type:?}, {spacing} mm");
                check(
                    &name,
                    &pictures,
                    &rays,
                    |_, ray| [exact(ray); 2],
                    &mut worst[0],
                );
                for (_, picture) in &pictures {
                    for (pixel, &ray) in picture.rgba.iter().zip(&rays) {
                        for i in 0..3 {
                            let source = linear_from_srgb(color[i]) + linear_from_srgb(emission[i]);
                            let difference = (f64::from(pixel[i]) - source * exact(ray)).abs();
                            worst[1] = worst[1].max(difference);
                            assert!(difference <= ROUNDING, "{name}: {difference:e}");
                        }
                    }
                }
            }
        }
    }
    println!(
        "homogeneous: opacity to {:.1e}, radiance to {:.1e}",
        worst[0], worst[1]
    );
}

/// A ball of constant opacity. Its surface is where the curve jumps, so a chord is right to one step, and to what trilinear
/// interpolation of the distance shifts the surface by: `h^2 / (4 r)` at most.
#[test]
fn sphere() {
    let (n, radius, opacity) = (33u32, 12.0, 0.06);
    let mut worst = 0.0;
    for spacing in SPACINGS {
        let placement = placed([spacing; 3], [0.0, 0.0, 1.0], 0.0, [0.0; 3]);
        let plain = Rescale::default();
        let half = 0.5 * f64::from(n - 1);
        let volume = sampled(VoxelType::F32, [n; 3], placement, plain, [0.0, 1.0], |p| {
            (2.0 * p - 1.0).length() * half
        });
        let white = [1.0; 3];
        let points = [
            point(0.0, white, opacity),
            point(radius, white, opacity),
            point(radius, white, 0.0),
        ];
        let center = DVec3::splat(half * spacing);
        for camera in cameras(&volume) {
            let (view, pictures) = pictures(&volume, &camera, spacing, &points);
            let rays: Vec<_> = rays(&view, SIZE).collect();
            let bounds_of = |step: f64, (origin, direction): (DVec3, DVec3)| {
                let closest = (center - origin).dot(direction);
                let distance = (origin + direction * closest).distance(center) / spacing;
                let shift = 1.0 / (4.0 * radius);
                let shortest = sphere_chord(radius - shift, distance) - step;
                let longest = sphere_chord(radius + shift, distance);
                let longest = if longest > 0.0 { longest + step } else { 0.0 };
                [shortest.max(0.0), longest].map(|length| slab_opacity(opacity, 1.0, length))
            };
            check(
                &format!("{spacing} mm"),
                &pictures,
                &rays,
                bounds_of,
                &mut worst,
            );
        }
    }
    println!("sphere: at most {worst:.1e} beyond its bounds");
}

/// A ramp of opacity `a0 + m s` along x over `L`, looked along. The midpoint rule is right to `L h^2 / 24` times the largest
/// second derivative of the extinction, `m^2 / (1 - a)^2 / u`.
#[test]
fn ramp() {
    let ends = [0.05, 0.85];
    let length = 16.0;
    let mut worst = 0.0;
    for spacing in SPACINGS {
        let placement = placed([spacing; 3], [0.0, 0.0, 1.0], 0.0, [0.0; 3]);
        let plain = Rescale::default();
        let volume = sampled(
            VoxelType::F32,
            [17, 12, 14],
            placement,
            plain,
            [0.0, 1.0],
            |p| p.x,
        );
        let white = [1.0; 3];
        let points = [point(0.0, white, ends[0]), point(1.0, white, ends[1])];
        let unit = 8.0;
        let middle = bounds(&volume).0;
        for side in [-1.0, 1.0] {
            let camera = Camera::Orthographic {
                eye: (middle + DVec3::X * (side * 40.0 * spacing)).to_array(),
                target: middle.to_array(),
                up: [0.0, 0.0, 1.0],
                height: 9.0 * spacing,
            };
            let (view, pictures) = pictures(&volume, &camera, unit * spacing, &points);
            let rays: Vec<_> = rays(&view, SIZE).collect();
            let exact = ramp_opacity(ends[0], ends[1], unit, length);
            let slope = (ends[1] - ends[0]) / length;
            let curvature = (slope / (1.0 - ends[1])).powi(2) / unit;
            let bounds_of = |step: f64, ray| {
                assert!(span(&volume, ray).is_some(), "every ray passes the ramp");
                let depth_error = length * step * step / 24.0 * curvature;
                [exact - depth_error, exact + depth_error]
            };
            check(
                &format!("{spacing} mm"),
                &pictures,
                &rays,
                bounds_of,
                &mut worst,
            );
        }
    }
    println!("ramp: at most {worst:.1e} beyond its bounds");
}
