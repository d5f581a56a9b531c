//! Light transport against another renderer: the pictures of Mitsuba 3 in tests/data/transport.

use rayon::prelude::*;
use umbravox::reference::Ray;
use umbravox::reference::transport::{Estimate, PathStart, PathTracer, scattered_once};

use crate::transport_scenes::{BLOCK, MULTIPLE, SINGLE, TransportScene};
use crate::z_test::z_test;

/// Of the quadrature, mm: its own error is far below the noise of the pictures.
const STEP: f64 = 0.1;

/// Every pixel by itself: the quadrature has no noise.
#[test]
fn light_scattered_once() {
    for name in SINGLE {
        let scene = TransportScene::load(name);
        let (medium, illumination) = (scene.medium(), scene.illumination());
        let [width, height] = scene.expected.size;
        let mean: Vec<_> = (0..width * height)
            .into_par_iter()
            .map(|at| {
                let pixel = [at % width, at / width].map(|c| f64::from(c) + 0.5);
                let (origin, direction) = scene.view.ray(pixel, [width, height]);
                let ray = Ray { origin, direction };
                scattered_once(&medium, &illumination, ray, STEP, true).radiance
            })
            .collect();
        let ours = Estimate {
            size: [width, height],
            variance: vec![Default::default(); mean.len()],
            mean,
        };
        let scores = z_test(&ours, &scene.expected, 1);
        println!("{name}: {scores}");
        scores.assert_same(name);
    }
}

/// Blocks of pixels: a pixel's few paths are not normal yet.
#[test]
fn light_scattered_any_number_of_times() {
    let mut complaints = Vec::new();
    for (name, samples) in MULTIPLE {
        let scene = TransportScene::load(name);
        let medium = scene.medium();
        let tracer = PathTracer {
            medium: &medium,
            illumination: scene.illumination(),
            max_scatterings: u32::MAX,
            start: PathStart::Middle,
        };
        let ours = tracer.picture(&scene.view, scene.expected.size, samples, 1);
        let scores = z_test(&ours, &scene.expected, BLOCK);
        println!("{name}: {scores}");
        complaints.extend(scores.complaint(name));
    }
    assert!(complaints.is_empty(), "\n  {}", complaints.join("\n  "));
}
