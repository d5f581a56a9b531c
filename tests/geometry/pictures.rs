//! Pictures from one eye in the world: every file against the f64 reference of the first file of its set.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::DVec3;
use umbravox::headless::{Headless, Options};
use umbravox::reference::{self, Setup};
use umbravox::scene::{
    Camera, ControlPoint, Image, Lighting, Scene, Shading, TransferFunction, VolumeSource,
};
use umbravox::volume::Volume;

use super::geometry;

/// One step of an 8-bit picture.
const TOLERANCE: f64 = 1.0 / 255.0;

/// Looks at a volume from a corner of the world that no symmetry favours: all axes are seen, none alike. Where the
/// eye is follows from the field's place in the world, which is the same however its voxels are stored.
fn scene(volume: &Volume, size: [u32; 2]) -> Scene {
    let last = DVec3::from_array(volume.size().map(f64::from)) - 1.0;
    let placement = volume.world_from_ix();
    let center = placement.transform_point3(0.5 * last);
    let radius = placement.transform_point3(last).distance(center);
    let [low, high] = volume.value_range();
    let point = |share: f64, color: [f64; 3], opacity: f64| ControlPoint {
        value: low + share * (high - low),
        color,
        opacity,
        emission: [0.0; 3],
        source: [0.0; 3],
    };
    Scene {
        volume: VolumeSource {
            path: "in-memory".into(),
            ..Default::default()
        },
        image: Image {
            size,
            ..Default::default()
        },
        camera: Camera::Perspective {
            eye: (center + radius * DVec3::new(1.1, -2.3, 1.7)).to_array(),
            target: center.to_array(),
            up: [0.1, 0.2, 1.0],
            fov_y: 40.0,
        },
        transfer_function: TransferFunction {
            unit_distance: Some(1.0),
            points: Some(vec![
                point(0.2, [0.2, 0.3, 0.9], 0.0),
                point(0.4, [0.9, 0.4, 0.2], 0.2),
                point(0.8, [1.0, 0.9, 0.7], 0.5),
            ]),
            preset: None,
            ..Default::default()
        },
        march: Default::default(),
        lighting: Lighting {
            shading: Shading::Diffuse,
            ..Default::default()
        },
        ambient_occlusion: None,
        storage: Default::default(),
    }
}

#[test]
fn every_file_gives_the_same_picture() {
    let headless = Headless::new(&Options {
        validation: true,
        ..Default::default()
    })
    .expect("a Vulkan device and the validation layer are installed");
    let mut sets = BTreeMap::new();
    let mut complaints = Vec::new();
    let mut worst = BTreeMap::<String, (f64, u32)>::new();
    for file in geometry().files {
        let volume = Arc::new(file.volume());
        let (scene, expected) = sets.entry(file.probes.clone()).or_insert_with(|| {
            let scene = scene(&volume, [40, 32]);
            let view = scene.camera.view(&volume, scene.image.size).unwrap();
            let colors = scene.image.color_management;
            let curve = scene.transfer_function.curve(&volume, colors).unwrap();
            let expected = reference::march(&Setup::new(&volume, &scene, &view, &curve, &[], None));
            let lit = expected.rgba.iter().filter(|p| p[3] > 0.1).count();
            assert!(
                lit > expected.rgba.len() / 8,
                "the field is seen: {lit} pixels"
            );
            (scene, expected)
        });
        let picture = headless.load(volume, scene).unwrap().frame().unwrap();
        let channels = picture.rgba.iter().flatten();
        let difference = channels
            .zip(expected.rgba.iter().flatten())
            .map(|(&a, b)| (f64::from(a) - b).abs())
            .fold(0.0, f64::max);
        let entry = worst.entry(file.probes.clone()).or_default();
        *entry = (entry.0.max(difference), entry.1 + 1);
        if difference > TOLERANCE {
            complaints.push(format!("{}: {:.2}/255", file.file, difference * 255.0));
        }
    }
    for (set, (difference, files)) in worst {
        println!("{set}: {:.4}/255 in {files} files", difference * 255.0);
    }
    assert!(complaints.is_empty(), "\n{}", complaints.join("\n"));
}
