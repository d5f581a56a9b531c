//! Model 6: light scattered any number of times.

use glam::DVec3;
use umbravox::picture::Picture;
use umbravox::reference::transport::{Estimate, PathStart, PathTracer};
use umbravox::scene::{Majorant, PhaseFunction, ScatteringMethod};

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

/// What the methods that approximate are off by, against Mitsuba's picture: root mean square over root mean square, of which
/// Mitsuba's own noise is 1 to 3 %; and how much of the light there is.
#[test]
fn approximations_stay_within_what_is_stated() {
    let headless = headless();
    let mut complaints = Vec::new();
    for (name, method, most) in [
        ("box_thick_constant", ScatteringMethod::Ordinates, 0.2),
        ("cloud_sun", ScatteringMethod::Ordinates, 0.2),
        ("blobs_spot", ScatteringMethod::Ordinates, 0.2),
        ("box_thick_constant", ScatteringMethod::Diffusion, 0.2),
        // Forward scattering at a mean free path of the cloud's own size is what diffusion knows least of.
        ("cloud_sun", ScatteringMethod::Diffusion, 0.4),
        ("blobs_spot", ScatteringMethod::Diffusion, 0.3),
    ] {
        let mut loaded = TransportScene::load(name);
        loaded.scene.lighting.scattering.method = method;
        loaded.scene.lighting.scattering.resolution =
            Some(if method == ScatteringMethod::Ordinates {
                16
            } else {
                32
            });
        let found = without_noise(&picture(&headless, &loaded.volume, &loaded.scene));
        let sum = |values: &[DVec3]| values.iter().sum::<DVec3>().element_sum();
        let [mut differences, mut squares] = [0.0; 2];
        for (found, expected) in found.mean.iter().zip(&loaded.expected.mean) {
            differences += found.distance_squared(*expected);
            squares += expected.length_squared();
        }
        let apart = (differences / squares).sqrt();
        let light = sum(&found.mean) / sum(&loaded.expected.mean);
        let what = format!(
            "{name} by {method:?}: {:.1} % apart, {:.1} % of the light",
            100.0 * apart,
            100.0 * light
        );
        println!("{what}");
        if apart > most {
            complaints.push(format!("{what}; {:.1} % apart allowed", 100.0 * most));
        }
    }
    assert!(complaints.is_empty(), "\n  {}", complaints.join("\n  "));
}

/// Zones must be optically thin: of a tenth of the box's extinction they are.
#[test]
fn zones_exchange_what_paths_find() {
    let headless = headless();
    let mut loaded = TransportScene::load("box_thick_constant");
    loaded.scene.lighting.extinction = [0.1; 3];
    loaded.scene.lighting.phase = PhaseFunction::Isotropic;
    loaded.scene.lighting.scattering.samples = 128;
    let traced = estimate(&picture(&headless, &loaded.volume, &loaded.scene));
    loaded.scene.lighting.scattering.method = ScatteringMethod::Zonal;
    let zonal = without_noise(&picture(&headless, &loaded.volume, &loaded.scene));
    let [mut differences, mut squares, mut noise] = [0.0; 3];
    for ((found, expected), variance) in zonal.mean.iter().zip(&traced.mean).zip(&traced.variance) {
        differences += found.distance_squared(*expected);
        squares += expected.length_squared();
        noise += variance.element_sum();
    }
    let apart = ((differences - noise).max(0.0) / squares).sqrt();
    println!("zones: {:.1} % apart", 100.0 * apart);
    assert!(apart < 0.2, "{:.1} % apart", 100.0 * apart);
}
