//! Opaque geometry of the host in a homogeneous medium, against the closed form: opacity `1 - exp(-tau L)` of the length `L`
//! from where a ray enters the medium to the geometry, and the host's colour behind with the rest.

use ash::vk;
use glam::DVec3;
use umbravox::embed::Background;
use umbravox::gpu::HostMemory;
use umbravox::scene::{Camera, View, linear_from_srgb};

use crate::camera::{DepthKind, HostCamera};
use crate::host::{Host, Look, Stage};
use crate::pictures::{difference, scenery};
use crate::scenes::{SIZE, Subject, slab};

const RGBA32F: vk::Format = vk::Format::R32G32B32A32_SFLOAT;
/// Display colour and opacity over 1 mm of the medium.
const COLOR: [f64; 3] = [0.9, 0.6, 0.2];
const OPACITY: f64 = 0.06;
/// Depth planes, mm from the eye.
const PLANES: [f64; 2] = [1.0, 200.0];
/// What 32-bit floats may differ by.
const TOLERANCE: f64 = 1e-5;

/// Opaque geometry: distance (mm) along a ray from `origin`, infinite where it is missed.
type Geometry = fn(origin: DVec3, direction: DVec3, middle: DVec3) -> f64;

/// A plane through the middle, askew to the view.
fn plane(origin: DVec3, direction: DVec3, middle: DVec3) -> f64 {
    let normal = DVec3::new(0.3, 1.0, -0.2);
    (middle - origin).dot(normal) / direction.dot(normal)
}

/// A sphere in the middle.
fn sphere(origin: DVec3, direction: DVec3, middle: DVec3) -> f64 {
    const RADIUS: f64 = 6.0;
    let closest = (middle - origin).dot(direction);
    let off = (origin + direction * closest - middle).length_squared();
    let half_chord = (RADIUS * RADIUS - off).sqrt();
    if half_chord.is_nan() {
        f64::INFINITY
    } else {
        closest - half_chord
    }
}

/// A wall before the volume.
fn wall_before(origin: DVec3, direction: DVec3, middle: DVec3) -> f64 {
    plane(origin, direction, middle - DVec3::Y * 25.0)
}

/// A wall behind the volume.
fn wall_behind(origin: DVec3, direction: DVec3, middle: DVec3) -> f64 {
    plane(origin, direction, middle + DVec3::Y * 40.0)
}

const GEOMETRIES: [(&str, Geometry); 4] = [
    ("plane", plane),
    ("sphere", sphere),
    ("wall before", wall_before),
    ("wall behind", wall_behind),
];

fn middle(subject: &Subject) -> DVec3 {
    let size = subject.volume.size().map(|n| 0.5 * f64::from(n - 1));
    subject
        .volume
        .world_from_ix()
        .transform_point3(DVec3::from_array(size))
}

/// Distances along a ray at which it enters and leaves the field; equal where it misses.
fn span(subject: &Subject, origin: DVec3, direction: DVec3) -> [f64; 2] {
    let ix_from_world = subject.volume.world_from_ix().inverse();
    let o = ix_from_world.transform_point3(origin);
    let d = ix_from_world.transform_vector3(direction);
    let last = DVec3::from_array(subject.volume.size().map(|n| f64::from(n - 1)));
    let (a, b) = (-o / d, (last - o) / d);
    let enter = a.min(b).max_element().max(0.0);
    [enter, a.max(b).min_element().max(enter)]
}

/// The host's depth buffer, and the picture that the closed form gives over `behind`.
fn expectation(
    subject: &Subject,
    view: &View,
    camera: &HostCamera,
    geometry: Geometry,
    behind: &[[f64; 4]],
) -> (Vec<f32>, Vec<[f64; 4]>) {
    let extinction = -(1.0 - OPACITY).ln();
    let color = COLOR.map(linear_from_srgb);
    let pixels = (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| [x, y]));
    pixels
        .zip(behind)
        .map(|(px, behind)| {
            let pixel = px.map(|p| f64::from(p) + 0.5);
            let (origin, direction) = view.ray(pixel, SIZE);
            let hit = geometry(origin, direction, middle(subject));
            let depth = if hit > 0.0 && hit.is_finite() {
                camera.depth_of(origin + direction * hit)
            } else {
                camera.cleared()
            };
            // What the depth buffer says, not what it was made from: its rounding is the host's.
            let end = if depth == camera.cleared() {
                f64::INFINITY
            } else {
                (camera.point_ws(pixel, SIZE, depth) - origin).dot(direction)
            };
            let [enter, exit] = span(subject, origin, direction);
            let length = (exit.min(end) - enter).max(0.0);
            let opacity = -(-extinction * length).exp_m1();
            let over = |i: usize, c: f64| c * opacity + (1.0 - opacity) * behind[i];
            let [r, g, b] = color;
            (depth, [over(0, r), over(1, g), over(2, b), over(3, 1.0)])
        })
        .unzip()
}

fn perspective() -> Camera {
    Camera::Perspective {
        eye: [10.0, -45.0, 14.0],
        target: [0.0, 0.0, 0.0],
        up: [0.0, 0.0, 1.0],
        fov_y: 38.0,
    }
}

fn orthographic() -> Camera {
    Camera::Orthographic {
        eye: [25.0, -50.0, 20.0],
        target: [0.0, 0.0, 0.0],
        up: [0.0, 0.0, 1.0],
        height: 36.0,
    }
}

fn inside() -> Camera {
    Camera::Perspective {
        eye: [1.0, -5.0, 2.0],
        target: [0.0, 10.0, 0.0],
        up: [0.0, 0.0, 1.0],
        fov_y: 60.0,
    }
}

#[test]
fn rays_end_at_opaque_geometry() {
    use DepthKind::{Normal, Reversed, ReversedInfinite};
    let host = Host::new();
    let context = host.context(HostMemory::GpuAllocator);
    let mut stage = Stage::new(&host, RGBA32F, SIZE);
    let behind = scenery(SIZE);
    let mut complaints = Vec::new();
    for (camera_name, camera, kinds) in [
        (
            "perspective",
            perspective(),
            &[Normal, Reversed, ReversedInfinite][..],
        ),
        ("orthographic", orthographic(), &[Normal, Reversed]),
        ("inside", inside(), &[Normal, ReversedInfinite]),
    ] {
        for step in [0.5, 2.0] {
            let mut subject = slab(camera.clone(), COLOR, OPACITY);
            subject.scene.march.step = step;
            // Changes nothing in a homogeneous medium.
            subject.scene.march.jitter = step > 1.0;
            subject.scene.march.early_termination = 1.0;
            let view = subject.view(SIZE);
            let mut renderer = subject.renderer(&context);
            for &kind in kinds {
                let camera = HostCamera::new(&view, SIZE, kind, PLANES);
                for (name, geometry) in GEOMETRIES {
                    let (depths, expected) =
                        expectation(&subject, &view, &camera, geometry, &behind);
                    stage.resize(RGBA32F, SIZE);
                    stage.set_contents(&behind);
                    stage.set_depth(&depths);
                    let look = Look {
                        camera: camera.frame_camera(),
                        background: Background::Target,
                        encode_srgb: false,
                    };
                    let picture = stage.draw(&look, &mut [&mut renderer]);
                    let worst = difference(&picture, &expected);
                    let line = format!("{camera_name}, step {step}, {kind:?}, {name}: {worst:.1e}");
                    println!("{line}");
                    if worst > TOLERANCE {
                        complaints.push(line);
                    }
                }
            }
        }
    }
    stage.destroy();
    drop(context);
    host.finish();
    assert!(complaints.is_empty(), "\n{}", complaints.join("\n"));
}
