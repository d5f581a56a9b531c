//! Surfaces, reciprocity, and when light volumes start again.

use std::sync::Arc;

use glam::{DAffine3, DVec3};
use serde_json::{Value, json};
use umbravox::headless::{Headless, Session};
use umbravox::picture::Picture;
use umbravox::renderer::Settings;
use umbravox::scene::Scene;
use umbravox::volume::{Rescale, Volume, Voxels};

use crate::{headless, picture};

fn scene(parts: Value) -> Scene {
    let mut scene = json!({
        "volume": { "procedural": { "type": "cloud", "size": [20, 18, 16] } },
        "image": { "size": [32, 32], "color_management": "none" },
        "transfer_function": { "unit_distance": 1.0, "points": [
            { "value": 0, "color": [1, 1, 1], "opacity": 0 },
            { "value": 1, "color": [0.8, 0.8, 0.8], "opacity": 0.4 },
        ] },
        "march": { "step": 0.25, "early_termination": 1 },
    });
    for (key, value) in parts.as_object().expect("an object") {
        scene[key] = value.clone();
    }
    Scene::from_json(&scene.to_string(), ".".as_ref(), &[]).expect("a scene")
}

fn cloud(scene: &Scene) -> Arc<Volume> {
    let procedural = scene.volume.procedural.as_ref().expect("a cloud");
    Arc::new(procedural.volume().expect("a cloud"))
}

/// A ramp along x in a medium of the same opacity everywhere, seen along x by parallel rays: the integral has a closed form.
#[test]
fn surfaces_reflect_by_their_gradient() {
    const SLOPE: f64 = 4.0;
    const SIZE: u32 = 11;
    const OPACITY: f64 = 0.3;
    const COLOR: f64 = 0.6;
    const STRENGTH: f64 = 0.7;
    let values = (0..SIZE.pow(3)).map(|i| SLOPE as f32 * (i % SIZE) as f32);
    let volume = Arc::new(
        Volume::new(
            Voxels::F32(values.collect()),
            [SIZE; 3],
            DAffine3::IDENTITY,
            Rescale::default(),
        )
        .expect("a volume"),
    );
    let light = DVec3::new(-0.8, 0.5, 0.3).normalize();
    let (normal, eye) = (-DVec3::X, -DVec3::X);
    let middle = (light + eye).normalize();
    let (n_l, n_h, v_h) = (normal.dot(light), normal.dot(middle), eye.dot(middle));
    let reflected = 2.0 * n_l * normal - light;
    let (shininess, roughness) = (5.0, 0.4);
    let facets = ((n_h * n_h - 1.0) / (n_h * n_h * roughness * roughness)).exp()
        / (std::f64::consts::PI * roughness * roughness * n_h.powi(4));
    let masking = f64::min(1.0, 2.0 * n_h * f64::min(1.0, n_l) / v_h);
    let fresnel = 0.04 + 0.96 * (1.0 - v_h).powi(5);
    for (model, highlight) in [
        ("lambert", 0.0),
        ("phong", reflected.dot(eye).powf(shininess)),
        ("blinn_phong", n_h.powf(shininess)),
        ("cook_torrance", facets * masking * fresnel / 4.0),
    ] {
        let scene = |stored: bool| {
            scene(json!({
            "volume": { "path": "ramp" },
            "camera": { "type": "orthographic", "eye": [-20, 5, 5], "target": [5, 5, 5], "up": [0, 0, 1], "height": 4 },
            "image": { "size": [4, 4], "color_management": "none" },
            "transfer_function": { "unit_distance": 1.0, "points": [
                { "value": 0, "color": [COLOR, COLOR, COLOR], "opacity": OPACITY },
                { "value": 50, "color": [COLOR, COLOR, COLOR], "opacity": OPACITY },
            ] },
            "lighting": { "model": "single_scattering", "reflectance": model, "strength": STRENGTH, "specular": 0.9,
                "shininess": shininess, "roughness": roughness, "stored_gradients": stored,
                "lights": [{ "type": "directional", "direction": light.to_array(), "irradiance": [2, 2, 2] }] },
            }))
        };
        let tau = -f64::ln_1p(-OPACITY);
        let through = (-tau * f64::from(SIZE - 1)).exp();
        let source = STRENGTH * OPACITY * SLOPE / 50.0 * (COLOR * n_l + 0.9 * highlight) * 2.0;
        let expected = source * (1.0 - through) / tau;
        // Stored gradients are halves.
        for (stored, bound) in [(false, 2e-4), (true, 2e-4 + 2f64.powi(-11))] {
            let picture = picture(&headless(), &volume, &scene(stored));
            for pixel in &picture.rgba {
                let found = f64::from(pixel[0]);
                assert!(
                    (found / expected - 1.0).abs() < bound,
                    "{model}, stored {stored}: {found}, not {expected}"
                );
            }
        }
    }
}

/// All light that leaves in a direction.
fn sum(picture: &Picture) -> f64 {
    picture.rgba.iter().map(|p| f64::from(p[1])).sum()
}

/// Light and eye may change places: as much light of a beam leaves towards the eye.
#[test]
fn light_goes_either_way() {
    let headless = headless();
    let directions =
        [DVec3::new(0.9, -0.2, 0.4), DVec3::new(-0.3, -0.8, -0.5)].map(DVec3::normalize);
    let drawn = |model: Value, eye: DVec3, light: DVec3| {
        let middle = DVec3::new(9.5, 8.5, 7.5);
        let mut lighting = model;
        lighting["lights"] = json!([{ "type": "directional", "direction": light.to_array(), "irradiance": [1, 1, 1] }]);
        lighting["phase"] = json!({ "type": "henyey_greenstein", "g": 0.3 });
        let scene = scene(json!({
            "camera": { "type": "orthographic", "eye": (middle + 60.0 * eye).to_array(), "target": middle.to_array(),
                "up": [0, 0, 1], "height": 32 },
            "image": { "size": [64, 64], "color_management": "none" },
            "lighting": lighting,
        }));
        picture(&headless, &cloud(&scene), &scene)
    };
    let [a, b] = directions;
    let once = json!({ "model": "shadowed_scattering", "shadows": { "method": "rays" } });
    let [there, back] = [(a, b), (b, a)].map(|(eye, light)| sum(&drawn(once.clone(), eye, light)));
    println!("once: {there} and {back}");
    assert!((there / back - 1.0).abs() < 0.01, "{there} and {back}");
    let often = json!({ "model": "multiple_scattering", "scattering": { "method": "monte_carlo", "samples": 32 } });
    let [there, back] = [(a, b), (b, a)].map(|(eye, light)| drawn(often.clone(), eye, light));
    let variance = |picture: &Picture| -> f64 {
        let by_pixel = picture.variance.as_ref().expect("paths").iter();
        by_pixel.map(|v| f64::from(v[1])).sum()
    };
    let z = (sum(&there) - sum(&back)) / (variance(&there) + variance(&back)).sqrt();
    println!("often: {} and {}, Z {z:.2}", sum(&there), sum(&back));
    assert!(z.abs() < 4.0, "{} and {}, Z {z}", sum(&there), sum(&back));
}

fn loaded(headless: &Headless, scene: &Scene) -> (Session, Arc<Volume>) {
    let volume = cloud(scene);
    let mut session = headless
        .load(Arc::clone(&volume), scene)
        .expect("a session");
    while session.refine_light().expect("an iteration") {}
    (session, volume)
}

/// Views share scattered light; another light, phase function or medium does not.
#[test]
fn scattered_light_starts_again_when_it_must() {
    let headless = headless();
    let of = |direction: [f64; 3], g: f64, yaw: f64| {
        scene(json!({
            "camera": { "type": "auto", "azimuth": yaw },
            "lighting": { "model": "multiple_scattering", "phase": { "type": "henyey_greenstein", "g": g },
                "scattering": { "resolution": 8, "directions": 24, "tolerance": 0.01 },
                "lights": [{ "type": "directional", "direction": direction }] },
        }))
    };
    let first = of([0.0, -1.0, 0.5], 0.5, 0.0);
    let (mut session, volume) = loaded(&headless, &first);
    let before = session.frame().expect("a picture");

    let turned = of([0.0, -1.0, 0.5], 0.5, 70.0);
    let curve = &session.settings().curve;
    let view = turned.view(&volume, curve).expect("a view");
    session.set_view(view);
    assert!(
        !session.refine_light().expect("nothing to do"),
        "the camera moved"
    );
    let moved = session.frame().expect("a picture");
    assert_ne!(before.rgba, moved.rgba);
    // What is gathered for the new eye is what a fresh session gathers.
    let fresh = loaded(&headless, &turned).0.frame().expect("a picture");
    assert_eq!(moved.rgba, fresh.rgba, "after the camera moved");

    for other in [
        of([1.0, 0.0, 0.0], 0.5, 70.0),
        of([1.0, 0.0, 0.0], -0.2, 70.0),
    ] {
        let settings = Settings::of_scene(&other, &volume).expect("settings");
        session.set_settings(settings).expect("new light");
        assert!(session.refine_light().expect("an iteration"), "other light");
        while session.refine_light().expect("an iteration") {}
        let edited = session.frame().expect("a picture");
        let fresh = loaded(&headless, &other).0.frame().expect("a picture");
        assert_eq!(edited.rgba, fresh.rgba, "after an edit");
    }
    assert_eq!(headless.validation_messages(), Vec::<String>::new());
}
