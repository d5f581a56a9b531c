//! Model 6: light scattered any number of times.

use glam::DVec3;
use umbravox::picture::Picture;
use umbravox::reference::transport::Estimate;
use umbravox::scene::Majorant;

use crate::transport_scenes::{MULTIPLE, TransportScene};
use crate::z_test::z_test;
use crate::{headless, picture, without_noise};

/// Paths of every pixel.
const SAMPLES: u32 = 64;
/// Edge of the blocks of pixels whose means are compared: a pixel's few paths are not normal yet.
const BLOCK: u32 = 6;

/// What a picture by Monte Carlo says of itself.
fn estimate(picture: &Picture) -> Estimate {
    let variance = picture.variance.as_ref().expect("traced by Monte Carlo");
    let wide = |v: &[f32; 3]| DVec3::from_array(v.map(f64::from));
    Estimate {
        variance: variance.iter().map(wide).collect(),
        ..without_noise(picture)
    }
}

#[test]
fn paths_are_what_mitsuba_has() {
    let headless = headless();
    for name in MULTIPLE {
        let mut loaded = TransportScene::load(name);
        loaded.scene.lighting.scattering.samples = SAMPLES;
        let ours = estimate(&picture(&headless, &loaded.volume, &loaded.scene));
        let scores = z_test(&ours, &loaded.expected, BLOCK);
        println!("{name}: {scores}");
        scores.assert_same(name);
    }
}

/// A bound for the whole volume and one for each skip cell must show the same.
#[test]
fn majorants_change_no_mean() {
    let headless = headless();
    let mut loaded = TransportScene::load("cloud_chromatic");
    loaded.scene.lighting.scattering.samples = SAMPLES;
    let [local, global] = [Majorant::Local, Majorant::Global].map(|majorant| {
        loaded.scene.lighting.scattering.majorant = majorant;
        // Independent paths: the same ones would differ by less than chance allows.
        loaded.scene.march.seed = 1 + u32::from(majorant == Majorant::Global);
        estimate(&picture(&headless, &loaded.volume, &loaded.scene))
    });
    let scores = z_test(&local, &global, BLOCK);
    println!("majorants: {scores}");
    scores.assert_same("majorants");
}
