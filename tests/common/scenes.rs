//! Small, varied, deterministic scenes for comparing renderers.
//!
//! They are well conditioned: no sample sits where rounding could change its class, so that an f32 and an f64
//! renderer must agree closely. `tests/reference` checks that.

use std::sync::Arc;

use glam::DVec3;
use umbravox::scene::{
    Camera, ControlPoint, Curve, Image, Labels, Projection, Scene, Storage, Surface,
    TransferFunction, View, VolumeSource,
};
use umbravox::volume::Volume;

mod classification_scenes;
mod color_scenes;
mod fields;
mod geometry_scenes;
mod growing_scenes;
mod label_scenes;
mod optics_scenes;
mod projection_scenes;

/// A scene with what it resolves to. The volume is in memory; the path in the scene names no file.
pub(crate) struct TestScene {
    pub(crate) name: &'static str,
    pub(crate) volume: Arc<Volume>,
    pub(crate) scene: Scene,
    pub(crate) view: View,
    pub(crate) curve: Curve,
    pub(crate) surfaces: Vec<Surface>,
    pub(crate) labels: Option<Labels>,
}

/// Every scene.
pub(crate) fn all() -> Vec<TestScene> {
    let mut scenes = geometry_scenes::scenes();
    scenes.extend(optics_scenes::scenes());
    scenes.extend(classification_scenes::scenes());
    scenes.extend(projection_scenes::scenes());
    scenes.extend(label_scenes::scenes());
    scenes.extend(color_scenes::scenes());
    scenes.extend(growing_scenes::scenes());
    scenes
}

/// A 48 x 40 picture of a volume; `adjust` changes what differs from the defaults.
fn test_scene(
    name: &'static str,
    volume: Volume,
    camera: Camera,
    unit_distance: f64,
    points: Vec<ControlPoint>,
    adjust: impl FnOnce(&mut Scene),
) -> TestScene {
    let mut scene = Scene {
        volume: VolumeSource {
            path: "in-memory".into(),
            ..Default::default()
        },
        image: Image {
            size: [48, 40],
            ..Default::default()
        },
        camera,
        transfer_function: TransferFunction {
            unit_distance: Some(unit_distance),
            points: Some(points.clone()),
            ..Default::default()
        },
        march: Default::default(),
        lighting: Default::default(),
        ambient_occlusion: None,
        storage: Storage::default(),
    };
    adjust(&mut scene);
    let colors = scene.image.color_management;
    let curve = Curve::new(unit_distance, &points, colors);
    TestScene {
        name,
        labels: Labels::of_scene(&scene, &volume).expect("labels that there are"),
        volume: Arc::new(volume),
        view: view_of(&scene.camera),
        surfaces: scene.march.surfaces(&curve, colors),
        curve,
        scene,
    }
}

/// The view of a camera that is not automatic.
fn view_of(camera: &Camera) -> View {
    let (eye, target, up, projection) = match *camera {
        Camera::Perspective {
            eye,
            target,
            up,
            fov_y,
        } => {
            let fov_y = fov_y.to_radians();
            (eye, target, up, Projection::Perspective { fov_y })
        }
        Camera::Orthographic {
            eye,
            target,
            up,
            height,
        } => (eye, target, up, Projection::Orthographic { height }),
        Camera::Auto { .. } => unreachable!("test scenes place their camera themselves"),
    };
    let eye = DVec3::from_array(eye);
    let forward = (DVec3::from_array(target) - eye).normalize();
    let right = forward.cross(DVec3::from_array(up)).normalize();
    View {
        eye,
        right,
        up: right.cross(forward),
        forward,
        projection,
    }
}

/// Centre and bounding radius of the field, mm.
fn bounds(volume: &Volume) -> (DVec3, f64) {
    let last = DVec3::from_array(volume.size().map(f64::from)) - 1.0;
    let placement = volume.world_from_ix();
    let center = placement.transform_point3(0.5 * last);
    let corner = |i: u32| {
        let side = DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2));
        placement.transform_point3(side * last).distance(center)
    };
    (center, (0..8).map(corner).fold(0.0, f64::max))
}

/// Up for a line of sight: z, or y when looking along z.
fn up_for(direction: DVec3) -> [f64; 3] {
    if direction.x == 0.0 && direction.y == 0.0 {
        [0.0, 1.0, 0.0]
    } else {
        [0.0, 0.0, 1.0]
    }
}

/// Looks at the centre from a direction, `distance` bounding radii away.
fn perspective(volume: &Volume, from: [f64; 3], distance: f64, fov_y: f64) -> Camera {
    let (center, radius) = bounds(volume);
    let direction = DVec3::from_array(from).normalize();
    Camera::Perspective {
        eye: (center + direction * (distance * radius)).to_array(),
        target: center.to_array(),
        up: up_for(direction),
        fov_y,
    }
}

/// Looks at the centre from a direction with parallel rays, starting two bounding radii away; the picture is
/// `height` bounding radii high.
fn orthographic(volume: &Volume, from: [f64; 3], height: f64) -> Camera {
    let (center, radius) = bounds(volume);
    let direction = DVec3::from_array(from).normalize();
    Camera::Orthographic {
        eye: (center + direction * (2.0 * radius)).to_array(),
        target: center.to_array(),
        up: up_for(direction),
        height: height * radius,
    }
}

/// A control point without emission.
fn point(value: f64, color: [f64; 3], opacity: f64) -> ControlPoint {
    ControlPoint {
        value,
        color,
        opacity,
        emission: [0.0; 3],
        source: [0.0; 3],
    }
}

/// A control point with emission.
fn glowing(value: f64, color: [f64; 3], opacity: f64, emission: [f64; 3]) -> ControlPoint {
    ControlPoint {
        emission,
        ..point(value, color, opacity)
    }
}

/// From transparent at `from` to `opacity` at `to`, through a few colours.
fn rise(from: f64, to: f64, opacity: f64) -> Vec<ControlPoint> {
    vec![
        point(from, [0.1, 0.3, 0.9], 0.0),
        point(from + 0.4 * (to - from), [0.9, 0.4, 0.2], 0.3 * opacity),
        point(to, [1.0, 0.9, 0.7], opacity),
    ]
}

/// Opaque tents around values: (middle, half width, colour, opacity), by value ascending, not overlapping.
fn tents(tents: &[(f64, f64, [f64; 3], f64)]) -> Vec<ControlPoint> {
    tents
        .iter()
        .flat_map(|&(middle, half_width, color, opacity)| {
            [
                point(middle - half_width, color, 0.0),
                point(middle, color, opacity),
                point(middle + half_width, color, 0.0),
            ]
        })
        .collect()
}
