//! Views that cameras resolve to.

use glam::{DAffine3, DMat3, DVec3};
use umbravox::scene::{Camera, Framed, Projection, View};
use umbravox::volume::{Rescale, Volume, Voxels};

/// 11 x 21 x 5 voxels, 1 x 1 x 8 mm: a box of 10 x 20 x 32 mm about (105, 210, 316).
fn placed_volume() -> Volume {
    let placement = DAffine3 {
        matrix3: DMat3::from_diagonal(DVec3::new(1.0, 1.0, 8.0)),
        translation: DVec3::new(100.0, 200.0, 300.0),
    };
    let voxels = Voxels::U8(vec![7; 11 * 21 * 5]);
    Volume::new(voxels, [11, 21, 5], placement, Rescale::default()).unwrap()
}

fn auto_view(azimuth: f64, elevation: f64, zoom: f64, size: [u32; 2]) -> View {
    let camera = Camera::Auto {
        azimuth,
        elevation,
        zoom,
        frame: Framed::Volume,
    };
    camera.view(&placed_volume(), size).unwrap()
}

fn assert_near(a: DVec3, b: DVec3) {
    assert!(a.distance(b) < 1e-9, "{a} is not {b}");
}

#[test]
fn explicit_cameras_are_orthonormal() {
    let camera = Camera::Perspective {
        eye: [0.0, -10.0, 0.0],
        target: [0.0, 5.0, 0.0],
        up: [0.0, 3.0, 2.0],
        fov_y: 90.0,
    };
    let view = camera.view(&placed_volume(), [100, 50]).unwrap();
    assert_near(view.forward, DVec3::Y);
    assert_near(view.up, DVec3::Z);
    assert_near(view.right, DVec3::X);
    assert_near(view.right, view.forward.cross(view.up));
    let Projection::Perspective { fov_y } = view.projection else {
        panic!("{view:?}");
    };
    assert!((fov_y - std::f64::consts::FRAC_PI_2).abs() < 1e-15);
}

#[test]
fn automatic_camera_stands_upright_in_lps() {
    let center = DVec3::new(105.0, 210.0, 316.0);
    let view = auto_view(0.0, 0.0, 1.0, [64, 64]);
    assert_near(view.forward, DVec3::Y);
    assert_near(view.up, DVec3::Z);
    assert_near(view.right, DVec3::X);
    assert_near(view.eye.with_y(center.y), center);
    assert!(view.eye.y < center.y);
    assert!(auto_view(30.0, 0.0, 1.0, [64, 64]).eye.x > center.x);
    assert_near(auto_view(90.0, 0.0, 1.0, [64, 64]).forward, DVec3::NEG_X);
    let above = auto_view(0.0, 90.0, 1.0, [64, 64]);
    assert_near(above.forward, DVec3::NEG_Z);
    assert_near(above.up, DVec3::Y);
    for (azimuth, elevation) in [(30.0, 20.0), (-170.0, -90.0), (77.0, 89.0)] {
        let view = auto_view(azimuth, elevation, 1.0, [64, 64]);
        assert_near(view.right.cross(view.up), -view.forward);
        assert_near(view.forward.cross(view.up), view.right);
        assert!((view.right.length() - 1.0).abs() < 1e-12);
    }
}

/// Largest |x| and |y| of the bounding sphere's outline in the picture, 1 at its edges.
fn outline(view: &View, size: [u32; 2]) -> [f64; 2] {
    let Projection::Perspective { fov_y } = view.projection else {
        panic!("{view:?}");
    };
    let center = DVec3::new(105.0, 210.0, 316.0);
    let radius = DVec3::new(5.0, 10.0, 16.0).length();
    let half = (radius / view.eye.distance(center)).asin();
    let y = half.tan() / (0.5 * fov_y).tan();
    [y * f64::from(size[1]) / f64::from(size[0]), y]
}

#[test]
fn automatic_camera_frames_the_bounding_sphere() {
    for size in [[64, 64], [200, 100]] {
        let [_, y] = outline(&auto_view(30.0, 20.0, 1.0, size), size);
        assert!((y - 1.0).abs() < 1e-9, "{y}");
    }
    let tall = [100, 400];
    let [x, y] = outline(&auto_view(30.0, 20.0, 1.0, tall), tall);
    assert!((x - 1.0).abs() < 1e-9 && y < 1.0, "{x} {y}");
    let [_, y] = outline(&auto_view(30.0, 20.0, 2.0, [64, 64]), [64, 64]);
    assert!((y - 2.0).abs() < 1e-9, "{y}");
}

#[test]
fn orbits_keep_the_distance_and_return() {
    let volume = placed_volume();
    let center = DVec3::new(105.0, 210.0, 316.0);
    let start = auto_view(0.0, 0.0, 1.0, [64, 64]);
    let turned = start.orbited(&volume, 30.0);
    assert!((turned.eye.distance(center) - start.eye.distance(center)).abs() < 1e-9);
    assert!(turned.eye.dot(start.right) > start.eye.dot(start.right));
    assert_near(turned.eye, auto_view(30.0, 0.0, 1.0, [64, 64]).eye);
    assert_near(turned.forward, auto_view(30.0, 0.0, 1.0, [64, 64]).forward);
    assert_near(start.orbited(&volume, 360.0).eye, start.eye);
}

#[test]
fn points_are_seen_where_their_rays_leave() {
    let volume = placed_volume();
    let (eye, target, up) = ([80.0, 150.0, 320.0], [105.0, 212.0, 315.0], [0.1, 0.0, 1.0]);
    let size = [320, 180];
    let perspective = Camera::Perspective {
        eye,
        target,
        up,
        fov_y: 50.0,
    };
    let parallel = Camera::Orthographic {
        eye,
        target,
        up,
        height: 40.0,
    };
    for camera in [perspective, parallel] {
        let view = camera.view(&volume, size).unwrap();
        for pixel in [[0.0, 0.0], [17.25, 170.5], [160.0, 90.0], [320.0, 3.5]] {
            let (origin, direction) = view.ray(pixel, size);
            for distance in [1e-3, 1.0, 77.0, 1e5] {
                let seen = view.pixel(origin + distance * direction, size).unwrap();
                for (seen, sent) in seen.into_iter().zip(pixel) {
                    assert!((seen - sent).abs() < 1e-7, "{seen} is not {sent}");
                }
            }
        }
        let behind = view.eye - 3.0 * view.forward;
        let is_perspective = matches!(view.projection, Projection::Perspective { .. });
        assert_eq!(view.pixel(behind, size).is_none(), is_perspective);
        assert_eq!(view.pixel(view.eye, size).is_none(), is_perspective);
    }
}
