//! The white furnace: where light of radiance 1 comes from everywhere and nothing is absorbed, everything has radiance 1.

use std::sync::Arc;

use serde_json::{Value, json};
use umbravox::picture::Picture;
use umbravox::scene::{Cloud, Procedural, Scene};

use crate::{headless, picture};

/// A cloud of albedo 1 in the furnace.
fn drawn(lighting: Value) -> Picture {
    let mut lighting = lighting;
    lighting["environment"] = json!({ "radiance": [1, 1, 1] });
    let cloud = json!({ "type": "cloud", "size": [20, 20, 16] });
    let scene = json!({
        "volume": { "procedural": cloud },
        "image": { "size": [24, 24], "color_management": "none" },
        "transfer_function": { "unit_distance": 1.0, "points": [
            { "value": 0, "color": [1, 1, 1], "opacity": 0 },
            { "value": 1, "color": [1, 1, 1], "opacity": 0.5 },
        ] },
        "march": { "early_termination": 1 },
        "lighting": lighting,
    });
    let scene = Scene::from_json(&scene.to_string(), ".".as_ref(), &[]).expect("a scene");
    let Some(Procedural::Cloud(cloud)) = &scene.volume.procedural else {
        panic!("a cloud");
    };
    let volume = volume_of(cloud.clone());
    picture(&headless(), &volume, &scene)
}

fn volume_of(cloud: Cloud) -> Arc<umbravox::volume::Volume> {
    Arc::new(Procedural::Cloud(cloud).volume().expect("a cloud"))
}

/// Mean of all channels, and the farthest from 1.
fn radiance(picture: &Picture) -> (f64, f64) {
    let channels = || {
        picture
            .rgba
            .iter()
            .flat_map(|p| &p[..3])
            .map(|&c| f64::from(c))
    };
    let mean = channels().sum::<f64>() / channels().count() as f64;
    (
        mean,
        channels().map(|c| (c - 1.0).abs()).fold(0.0, f64::max),
    )
}

#[test]
fn all_light_that_comes_in_goes_out() {
    for (name, lighting, farthest) in [
        (
            "paths",
            json!({ "method": "monte_carlo", "samples": 16 }),
            1e-3,
        ),
        (
            "ordinates",
            json!({ "method": "ordinates", "resolution": 12, "directions": 24 }),
            5e-3,
        ),
        (
            "diffusion",
            json!({ "method": "diffusion", "resolution": 16, "tolerance": 1e-6 }),
            5e-3,
        ),
    ] {
        for phase in [
            json!({ "type": "isotropic" }),
            json!({ "type": "henyey_greenstein", "g": 0.6 }),
        ] {
            let lighting =
                json!({ "model": "multiple_scattering", "scattering": lighting, "phase": phase });
            let (mean, most) = radiance(&drawn(lighting));
            println!("{name}, {phase}: mean {mean:.6}, farthest {most:.1e}");
            assert!(
                (mean - 1.0).abs() < 1e-3 && most < farthest,
                "{name}, {phase}: {mean}, {most}"
            );
        }
    }
}

/// Scattered once with nothing in its way: what a ray loses it gets back.
#[test]
fn single_scattering_without_shadows_hides_in_the_furnace() {
    let phase = json!({ "type": "henyey_greenstein", "g": 0.4 });
    let (mean, most) = radiance(&drawn(
        json!({ "model": "single_scattering", "phase": phase }),
    ));
    assert!(most < 1e-3, "mean {mean}, farthest {most}");
}

/// With shadows less comes back, and nowhere more.
#[test]
fn shadows_darken_the_furnace() {
    let picture = drawn(json!({ "model": "shadowed_scattering" }));
    let (mean, _) = radiance(&picture);
    let brightest = picture
        .rgba
        .iter()
        .flat_map(|p| &p[..3])
        .fold(0.0f32, |a, &b| a.max(b));
    assert!(
        mean < 0.99 && brightest < 1.001,
        "mean {mean}, brightest {brightest}"
    );
}
