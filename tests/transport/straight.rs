//! Models 1 to 3, which follow light along straight lines: absorption, emission, and both.

use glam::DVec3;
use umbravox::reference::Ray;
use umbravox::reference::transport::{Medium, RayLight, absorbed, emitted, glowing};
use umbravox::scene::{ControlPoint, Lighting, OpticalModel, Scene};

use crate::transport_scenes::TransportScene;
use crate::{Difference, headless, picture, rays};

/// Of the reference, mm: its error falls with the square.
const STEP: f64 = 0.02;
/// Largest error of a pixel, as a share of the brightest: what a step of a quarter of a voxel leaves.
const TOLERANCE: f64 = 2e-3;

/// A cloud of coloured particles in a gas that glows where there are none.
fn glowing_scene(model: OpticalModel, extinction: [f64; 3]) -> (TransportScene, Scene) {
    let loaded = TransportScene::load("cloud_sun");
    let mut scene = loaded.scene.clone();
    scene.transfer_function.unit_distance = Some(1.0);
    let point = |value, color, opacity, emission, source| ControlPoint {
        value,
        color,
        opacity,
        emission,
        source,
    };
    scene.transfer_function.points = Some(vec![
        point(0.0, [0.2, 0.3, 0.9], 0.0, [0.0; 3], [0.02, 0.01, 0.0]),
        point(100.0, [0.9, 0.5, 0.2], 0.1, [0.0; 3], [0.0, 0.01, 0.05]),
        point(255.0, [0.9, 0.9, 0.9], 0.4, [0.3, 0.2, 0.1], [0.0; 3]),
    ]);
    scene.lighting = Lighting {
        model,
        extinction,
        ..Default::default()
    };
    (loaded, scene)
}

fn compare(model: OpticalModel, light: impl Fn(&Medium, Ray) -> RayLight + Sync) {
    let headless = headless();
    for extinction in [[1.0; 3], [1.0, 0.5, 0.2]] {
        let (loaded, scene) = glowing_scene(model, extinction);
        let glowing = loaded.with(scene.clone());
        let medium = glowing.medium();
        let expected = rays(&loaded.view, scene.image.size, |ray| light(&medium, ray));
        let found = picture(&headless, &loaded.volume, &scene);
        let what = format!("{model:?}, extinction {extinction:?}");
        if model == OpticalModel::Absorption {
            assert!(
                found.rgba.iter().all(|p| p[..3] == [0.0; 3]),
                "{what}: black"
            );
        } else {
            Difference::of_radiance(&found, &expected).assert_below(TOLERANCE, &what);
        }
        // What comes through, seen as the white that is behind.
        let behind_black = found.composited(0.0, |_| [1.0; 3]).map(DVec3::from_array);
        let through = expected.iter().map(|e| e.transmittance);
        let what = format!("{what}, transmittance");
        Difference::between(behind_black, through).assert_below(TOLERANCE, &what);
    }
}

#[test]
fn absorption() {
    compare(OpticalModel::Absorption, |medium, ray| {
        absorbed(medium, ray, STEP)
    });
}

#[test]
fn emission() {
    compare(OpticalModel::Emission, |medium, ray| {
        emitted(medium, ray, STEP)
    });
}

#[test]
fn emission_and_absorption() {
    compare(OpticalModel::EmissionAbsorption, |medium, ray| {
        glowing(medium, ray, STEP)
    });
}
