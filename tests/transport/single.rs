//! Models 4 and 5: light scattered once, without and with shadows.

use umbravox::reference::transport::{RayLight, scattered_once};
use umbravox::scene::{Light, OpticalModel, PhaseFunction, Scene, ShadowMethod};

use crate::transport_scenes::{SINGLE, TransportScene};
use crate::z_test::z_test;
use crate::{Difference, headless, picture, rays, without_noise};

/// Of the reference, mm.
const STEP: f64 = 0.1;
/// Largest error of a pixel, as a share of the brightest.
const TOLERANCE: f64 = 5e-3;
/// The same for shadows swept on a grid as fine as the volume, linear in between.
const SWEPT_TOLERANCE: f64 = 0.05;

fn phases() -> Vec<PhaseFunction> {
    vec![
        PhaseFunction::Isotropic,
        PhaseFunction::HenyeyGreenstein { g: -0.4 },
        PhaseFunction::DoubleHenyeyGreenstein {
            g1: 0.8,
            g2: -0.3,
            weight: 0.6,
        },
        PhaseFunction::Rayleigh,
        PhaseFunction::Schlick { k: 0.6 },
        PhaseFunction::LambertSphere,
        PhaseFunction::Table {
            values: vec![0.5, 0.1, 0.2, 0.9, 3.0],
        },
    ]
}

/// Every kind of light at once, and extinctions that differ by channel.
fn lit_by_all(loaded: &TransportScene) -> Scene {
    let mut scene = loaded.scene.clone();
    scene.lighting.extinction = [1.0, 0.7, 0.4];
    scene.lighting.lights = vec![
        Light::Directional {
            direction: [-0.5, 0.3, 0.8],
            irradiance: [1.0, 0.9, 0.8],
        },
        Light::Point {
            position: [30.0, -6.0, 12.0],
            intensity: [300.0, 400.0, 500.0],
        },
        Light::Spot {
            position: [11.0, -18.0, 24.0],
            direction: [0.0, 0.75, -0.6],
            intensity: [2000.0, 1500.0, 1500.0],
            beam_angle: Some(7.0),
            cutoff_angle: 18.0,
        },
    ];
    scene
}

fn expected(loaded: &TransportScene, scene: &Scene) -> Vec<RayLight> {
    let shadows = scene.lighting.model == OpticalModel::ShadowedScattering;
    let lit = loaded.with(scene.clone());
    let (medium, illumination) = (lit.medium(), lit.illumination());
    rays(&lit.view, scene.image.size, |ray| {
        scattered_once(&medium, &illumination, ray, STEP, shadows)
    })
}

#[test]
fn single_scattering_without_shadows_by_every_phase_function() {
    let headless = headless();
    let loaded = TransportScene::load("cloud_lambert_single");
    for phase in phases() {
        let mut scene = lit_by_all(&loaded);
        scene.lighting.model = OpticalModel::SingleScattering;
        scene.lighting.phase = phase;
        let found = picture(&headless, &loaded.volume, &scene);
        let expected = expected(&loaded, &scene);
        let what = format!("{:?}", scene.lighting.phase);
        Difference::of_radiance(&found, &expected).assert_below(TOLERANCE, &what);
    }
}

#[test]
fn shadows_by_rays_and_by_sweeps() {
    let headless = headless();
    let loaded = TransportScene::load("cloud_lambert_single");
    for (method, tolerance) in [
        (ShadowMethod::Rays, TOLERANCE),
        (ShadowMethod::Sweep, SWEPT_TOLERANCE),
    ] {
        let mut scene = lit_by_all(&loaded);
        scene.lighting.model = OpticalModel::ShadowedScattering;
        scene.lighting.shadows.method = method;
        scene.lighting.shadows.spacing = 1.0;
        let found = picture(&headless, &loaded.volume, &scene);
        let expected = expected(&loaded, &scene);
        let what = format!("shadows by {method:?}");
        Difference::of_radiance(&found, &expected).assert_below(tolerance, &what);
    }
}

/// Against the pictures of another renderer, every pixel by itself: the device's march has no noise.
#[test]
fn shadowed_scattering_is_what_mitsuba_has() {
    let headless = headless();
    for name in SINGLE {
        // At the scene's own step: shadow rays of finer ones meet llvmpipe's limit of 65535 loop iterations an invocation.
        let mut loaded = TransportScene::load(name);
        loaded.scene.lighting.shadows.method = ShadowMethod::Rays;
        let ours = without_noise(&picture(&headless, &loaded.volume, &loaded.scene));
        let scores = z_test(&ours, &loaded.expected, 1);
        println!("{name}: {scores}");
        scores.assert_same(name);
    }
}
