//! Model 6: light scattered any number of times.

use glam::DVec3;
use umbravox::picture::Picture;
use umbravox::reference::transport::{Estimate, PathStart, PathTracer};
use umbravox::scene::{Majorant, ScatteringMethod};

use crate::transport_scenes::{BLOCK, MULTIPLE, TransportScene};
use crate::z_test::z_test;
use crate::{headless, picture, without_noise};

/// What a picture by Monte Carlo says of itself.
fn estimate(picture: &Picture) -> Estimate {
    let variance = picture.variance.as_ref().expect("traced by Monte Carlo");
    let wide = |v: &[f32; 3]| DVec3::from_array(v.map(f64::from));
    Estimate {
        variance: variance.iter().map(wide).collect(),
        ..without_noise(picture)
    }
}

/// The device's paths start anywhere in their pixel, so the reference's do; from the middle of the pixels that is what
/// Mitsuba has (`tests/reference/mitsuba.rs`).
#[test]
fn paths_are_what_the_reference_has() {
    let headless = headless();
    let mut complaints = Vec::new();
    for (name, samples) in MULTIPLE {
        let mut loaded = TransportScene::load(name);
        loaded.scene.lighting.scattering.samples = samples;
        let ours = estimate(&picture(&headless, &loaded.volume, &loaded.scene));
        let medium = loaded.medium();
        let reference = PathTracer {
            medium: &medium,
            illumination: loaded.illumination(),
            max_scatterings: u32::MAX,
            start: PathStart::Anywhere,
        };
        let reference = reference.picture(&loaded.view, ours.size, samples, 1);
        let scores = z_test(&ours, &reference, BLOCK);
        println!("{name}: {scores}");
        complaints.extend(scores.complaint(name));
    }
    assert!(complaints.is_empty(), "\n  {}", complaints.join("\n  "));
}

/// A bound for the whole volume and one for each skip cell must show the same.
#[test]
fn majorants_change_no_mean() {
    let headless = headless();
    let mut loaded = TransportScene::load("cloud_chromatic");
    loaded.scene.lighting.scattering.samples = 64;
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

/// What ordinates are off by in a thick white box, against Mitsuba's picture: root mean square over root mean square.
#[test]
fn ordinates_are_near_what_mitsuba_has() {
    let headless = headless();
    let mut loaded = TransportScene::load("box_thick_constant");
    loaded.scene.lighting.scattering.method = ScatteringMethod::Ordinates;
    let found = without_noise(&picture(&headless, &loaded.volume, &loaded.scene));
    let [mut differences, mut squares, mut light] = [0.0; 3];
    for (found, expected) in found.mean.iter().zip(&loaded.expected.mean) {
        differences += found.distance_squared(*expected);
        squares += expected.length_squared();
        light += (*found - *expected).element_sum();
    }
    let apart = (differences / squares).sqrt();
    let all: DVec3 = loaded.expected.mean.iter().sum();
    let surplus = light / all.element_sum();
    println!(
        "{:.1} % apart, {:+.1} % of light",
        100.0 * apart,
        100.0 * surplus
    );
    assert!(apart < 0.1, "{apart}");
    assert!(surplus.abs() < 0.05, "{surplus}");
}
