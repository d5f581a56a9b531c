//! Every kind of bad input in a scene, and what is said about it.

use serde_json::{Value, json};
use umbravox::scene::MAX_SAMPLES_PER_RAY;

use crate::{MINIMAL, error, parse};

/// The message for a scene that has a volume and these parts.
fn message(parts: Value) -> String {
    let mut scene = json!({ "volume": { "path": "head.nrrd" } });
    for (key, value) in parts.as_object().expect("an object") {
        scene[key] = value.clone();
    }
    error(parse(&scene.to_string()))
}

#[test]
fn unknown_keys_name_the_nearest_valid_one() {
    let perspective = |key: &str| {
        json!({ "camera": { "type": "perspective", "eye": [0, -1, 0], "target": [0, 0, 0],
                            "up": [0, 0, 1], key: 30 } })
    };
    assert_eq!(
        message(perspective("fovy")),
        "camera.fovy: unknown key; did you mean \"fov_y\"? Valid here: eye, fov_y, target, type, up"
    );
    for (parts, start) in [
        (
            json!({ "marsh": {} }),
            "marsh: unknown key; did you mean \"march\"?",
        ),
        (
            json!({ "march": { "steps": 1 } }),
            "march.steps: unknown key; did you mean \"step\"?",
        ),
        (
            json!({ "transfer_function": { "points": [{ "value": 1, "colour": [1, 1, 1], "opacity": 1 }] } }),
            "transfer_function.points.0.colour: unknown key; did you mean \"color\"?",
        ),
        (
            json!({ "ambient_occlusion": { "Radius": 1 } }),
            "ambient_occlusion.Radius: unknown key; did you mean \"radius\"?",
        ),
        (
            json!({ "camera": { "type": "auto", "elevatoin": 1 } }),
            "camera.elevatoin: unknown key; did you mean \"elevation\"?",
        ),
        (perspective("height"), "camera.height: unknown key"),
    ] {
        let message = message(parts);
        assert!(message.starts_with(start), "{message}");
    }
}

#[test]
fn missing_keys_say_what_to_give() {
    assert_eq!(
        error(parse("{}")),
        "volume: missing; give an object with channel, color, labels, level, path, procedural, raw, series, strict, timestep"
    );
    assert_eq!(
        message(json!({ "camera": { "eye": [0, 0, 0] } })),
        "camera.type: missing; give one of \"perspective\", \"orthographic\", \"auto\""
    );
    assert_eq!(
        message(json!({ "camera": { "type": "orthographic" } })),
        "camera.eye: missing; give a list of 3 numbers"
    );
}

#[test]
fn wrong_types_say_what_is_valid() {
    let whole = "a whole number from 0 to 4294967295";
    for (parts, expected) in [
        (json!({ "march": { "step": "a" } }), "march.step: \"a\" is not valid; give a number".into()),
        (json!({ "march": { "jitter": 1 } }), "march.jitter: 1 is not valid; give true or false".into()),
        (json!({ "march": { "seed": -1 } }), format!("march.seed: -1 is not valid; give {whole}")),
        (json!({ "march": { "seed": 0.5 } }), format!("march.seed: 0.5 is not valid; give {whole}")),
        (
            json!({ "march": { "seed": 4294967296u64 } }),
            format!("march.seed: 4294967296 is not valid; give {whole}"),
        ),
        (
            json!({ "image": { "size": 512 } }),
            "image.size: 512 is not valid; give a list of 2 whole numbers from 1 to 16384".into(),
        ),
        (
            json!({ "image": { "size": [1, 2, 3] } }),
            "image.size: [1,2,3] is not valid; give a list of 2 whole numbers from 1 to 16384".into(),
        ),
        (
            json!({ "image": { "size": [0, 2] } }),
            "image.size.0: 0 is not valid; give a whole number from 1 to 16384".into(),
        ),
        (
            json!({ "image": { "png_bits": 12 } }),
            "image.png_bits: 12 is not valid; give one of 8, 16".into(),
        ),
        (
            json!({ "camera": 3 }),
            "camera: 3 is not valid; give an object whose \"type\" is one of \"perspective\", \"orthographic\", \"auto\""
                .into(),
        ),
        (
            json!({ "ambient_occlusion": { "weights": 3 } }),
            "ambient_occlusion.weights: 3 is not valid; give a list of numbers or null".into(),
        ),
        (
            json!({ "image": { "background": [0, null, 0] } }),
            "image.background.1: null is not valid; give a number".into(),
        ),
    ] {
        assert_eq!(message(parts), expected);
    }
    let message = message(json!({ "ambient_occlusion": 3 }));
    assert!(
        message.starts_with("ambient_occlusion: 3 is not valid; give an object with bias"),
        "{message}"
    );
    assert!(message.ends_with(" or null"), "{message}");
    assert!(error(parse("[1]")).starts_with("scene: [1] is not valid; give an object with"));
}

#[test]
fn names_that_this_version_lacks_are_refused() {
    for (parts, expected) in [
        (
            json!({ "march": { "interpolation": "cubic" } }),
            "march.interpolation: \"cubic\" is not available; this version has \"nearest\", \"linear\", \
             \"bspline\", \"catmull_rom\"",
        ),
        (
            json!({ "lighting": { "model": "radiosity" } }),
            "lighting.model: \"radiosity\" is not available; this version has \"absorption\", \"emission\", \
             \"emission_absorption\", \"single_scattering\", \"shadowed_scattering\", \"multiple_scattering\"",
        ),
        (
            json!({ "lighting": { "shading": "phong" } }),
            "lighting.shading: \"phong\" is not available; this version has \"none\", \"diffuse\"",
        ),
        (
            json!({ "camera": { "type": "fisheye" } }),
            "camera.type: \"fisheye\" is not available; this version has \"perspective\", \"orthographic\", \"auto\"",
        ),
        (
            json!({ "image": { "color_management": "srgb" } }),
            "image.color_management: \"srgb\" is not available; this version has \"linear\", \"none\"",
        ),
        (
            json!({ "transfer_function": { "preset": "ct_bone" } }),
            "transfer_function.preset: \"ct_bone\" is not available; did you mean \"ct-bone\"? \
             This version has boundaries, colors, ct-angio, ct-bone, ct-lung, ct-muscle-and-skin, ct-soft-tissue, labels, \
             level-set, micro-ct, microscopy, mr-angio, mr-default, simulation",
        ),
    ] {
        assert_eq!(message(parts), expected);
    }
    let raw = json!({ "volume": { "path": "x", "raw": { "size": [2, 2, 2], "type": "f64" } } });
    assert!(
        error(parse(&raw.to_string())).starts_with("volume.raw.type: \"f64\" is not available")
    );
}

#[test]
fn ranges() {
    for (parts, expected) in [
        (
            json!({ "march": { "step": 0 } }),
            "march.step: 0 is not valid; give a number > 0 (voxels)",
        ),
        (
            json!({ "march": { "step": -0.5 } }),
            "march.step: -0.5 is not valid; give a number > 0 (voxels)",
        ),
        (
            json!({ "march": { "step": 1e-9 } }),
            "march.step: 0.000000001 is not valid; give a number >= 0.001 (voxels)",
        ),
        (
            json!({ "march": { "early_termination": 1.5 } }),
            "march.early_termination: 1.5 is not valid; give a number > 0 and <= 1 (opacity; 1: never early)",
        ),
        (
            json!({ "image": { "background": [0, 2, 0] } }),
            "image.background: [0, 2, 0] is not valid; give three numbers from 0 to 1",
        ),
        (
            json!({ "image": { "depth_threshold": 0 } }),
            "image.depth_threshold: 0 is not valid; give a number > 0 and <= 1",
        ),
        (
            json!({ "lighting": { "ambient": -1 } }),
            "lighting.ambient: -1 is not valid; give a number >= 0",
        ),
        (
            json!({ "lighting": { "diffuse": -1 } }),
            "lighting.diffuse: -1 is not valid; give a number >= 0",
        ),
        (
            json!({ "lighting": { "direction": [0, 0, 0] } }),
            "lighting.direction: [0, 0, 0] is not valid; give three finite numbers, not all 0 (towards the light)",
        ),
        (
            json!({ "ambient_occlusion": { "rays": 0 } }),
            "ambient_occlusion.rays: 0 is not valid; give a whole number from 1 to 65536",
        ),
        (
            json!({ "ambient_occlusion": { "radius": 2, "offset": 2 } }),
            "ambient_occlusion.radius: 2 is not valid; give a number > offset, 2 (voxels)",
        ),
        (
            json!({ "ambient_occlusion": { "offset": -1 } }),
            "ambient_occlusion.offset: -1 is not valid; give a number >= 0 (voxels)",
        ),
        (
            json!({ "ambient_occlusion": { "step": 0 } }),
            "ambient_occlusion.step: 0 is not valid; give a number > 0 (voxels)",
        ),
        (
            json!({ "ambient_occlusion": { "sampling": "distance", "growth": 2 } }),
            "ambient_occlusion.growth: 2 is not valid; give a number from 0.05 to 1 (parts of a ray), or null",
        ),
        (
            json!({ "ambient_occlusion": { "growth": 0.5 } }),
            "ambient_occlusion.growth: distances do not grow in uniform sampling; give null, or \"distance\" as ambient_occlusion.sampling",
        ),
        (
            json!({ "ambient_occlusion": { "sampling": "jittered" } }),
            "ambient_occlusion.sampling: \"jittered\" is not available; this version has \"uniform\", \"distance\"",
        ),
        (
            json!({ "ambient_occlusion": { "gamma": -1 } }),
            "ambient_occlusion.gamma: -1 is not valid; give a number >= 0",
        ),
        (
            json!({ "ambient_occlusion": { "bias": -1 } }),
            "ambient_occlusion.bias: -1 is not valid; give a number >= 0",
        ),
        (
            json!({ "ambient_occlusion": { "rays": 2, "weights": [1, 2] } }),
            "ambient_occlusion.weights.1: 2 is not valid; give a number from 0 to 1",
        ),
        (
            json!({ "ambient_occlusion": { "rays": 5, "directions": "icosahedron", "weights": [1] } }),
            "ambient_occlusion.weights: a list of 1 is not valid; give 12 numbers, one for each direction, or null",
        ),
        (
            json!({ "ambient_occlusion": { "explicit_directions": [] } }),
            "ambient_occlusion.explicit_directions: a list of 0 is not valid; give 1 to 65536 directions",
        ),
        (
            json!({ "ambient_occlusion": { "explicit_directions": [[0, 0, 1], [0, 0, 0]] } }),
            "ambient_occlusion.explicit_directions.1: [0, 0, 0] is not valid; \
             give three finite numbers, not all 0 (towards the light)",
        ),
        (
            json!({ "storage": { "data_reduction": 0.5 } }),
            "storage.data_reduction: 0.5 is not valid; give a number >= 1 (voxels of the volume per voxel kept)",
        ),
        (
            json!({ "storage": { "memory_budget_mib": 0 } }),
            "storage.memory_budget_mib: 0 is not valid; give a number > 0 (MiB)",
        ),
        (
            json!({ "volume": { "path": "" } }),
            "volume.path: missing or empty; give a file, or \"procedural\" in its place",
        ),
        (
            json!({ "volume": { "path": "x", "raw": { "size": [8, 1, 8], "type": "u8" } } }),
            "volume.raw.size.1: 1 is not valid; give a whole number from 2 to 4294967295",
        ),
        (
            json!({ "volume": { "path": "x", "raw": { "size": [8, 8, 8], "type": "u8", "spacing": [1, 0, 1] } } }),
            "volume.raw.spacing: [1, 0, 1] is not valid; give three numbers > 0 (mm)",
        ),
    ] {
        assert_eq!(message(parts), expected);
    }
    let many = message(json!({ "ambient_occlusion": { "radius": 1e6, "step": 0.01 } }));
    assert!(
        many.contains(&format!(
            "a ray takes {MAX_SAMPLES_PER_RAY} samples at most"
        )),
        "{many}"
    );
}

#[test]
fn library_scenes_are_checked_like_files() {
    let mut scene = parse(MINIMAL).unwrap();
    assert!(scene.validate().is_ok());
    scene.march.step = f64::NAN;
    assert_eq!(
        error(scene.validate()),
        "march.step: NaN is not valid; give a number > 0 (voxels)"
    );
    scene.march.step = 0.5;
    scene.image.size = [0, 10];
    assert!(
        error(scene.validate())
            .starts_with("image.size: [0, 10] is not valid; give width and height")
    );
    scene.image.size = [10, 10];
    scene.image.png_bits = 12;
    assert_eq!(
        error(scene.validate()),
        "image.png_bits: 12 is not valid; give 8 or 16"
    );
}

#[test]
fn control_points() {
    let points = |points: Value| message(json!({ "transfer_function": { "points": points } }));
    let point = |value: f64| json!({ "value": value, "color": [1, 1, 1], "opacity": 0.5 });
    assert_eq!(
        points(json!([])),
        "transfer_function.points: empty; give at least one control point"
    );
    assert_eq!(
        points(json!([point(1.0), point(0.5)])),
        "transfer_function.points.1.value: 0.5 is not valid; give a number >= 1, the value of the point before: points ascend"
    );
    let mut bad = point(0.0);
    bad["color"] = json!([0, 0, 1.5]);
    assert_eq!(
        points(json!([bad])),
        "transfer_function.points.0.color: [0, 0, 1.5] is not valid; give three numbers from 0 to 1"
    );
    let mut bad = point(0.0);
    bad["opacity"] = json!(-0.1);
    assert_eq!(
        points(json!([bad])),
        "transfer_function.points.0.opacity: -0.1 is not valid; give a number from 0 to 1"
    );
    let mut bad = point(0.0);
    bad["emission"] = json!([0, -1, 0]);
    assert_eq!(
        points(json!([bad])),
        "transfer_function.points.0.emission: [0, -1, 0] is not valid; give three numbers from 0 to 60"
    );
    assert!(points(json!([point(1e300)])).ends_with("is not valid; give a finite number"));
    assert_eq!(
        message(json!({ "transfer_function": { "unit_distance": 0 } })),
        "transfer_function.unit_distance: 0 is not valid; give a number > 0 (mm)"
    );
    assert!(
        message(json!({ "transfer_function": { "preset": "ct-bone", "points": [point(0.0)] } }))
            .starts_with("transfer_function: has both \"points\" and \"preset\"")
    );
    let jump = json!({ "volume": { "path": "x" }, "transfer_function": { "points": [point(1.0), point(1.0)] } });
    assert!(parse(&jump.to_string()).is_ok());
}

#[test]
fn degenerate_cameras() {
    let camera = |key: &str, value: Value| {
        let mut camera = json!({ "type": "perspective", "eye": [0, -4, 0], "target": [0, 0, 0],
                                 "up": [0, 0, 1], "fov_y": 30 });
        camera[key] = value;
        message(json!({ "camera": camera }))
    };
    assert_eq!(
        camera("target", json!([0, -4, 0])),
        "camera.target: [0.0, -4.0, 0.0] is where the eye is; give another point, to look at"
    );
    for up in [json!([0, 1, 0]), json!([0, -3, 0]), json!([0, 0, 0])] {
        assert!(
            camera("up", up)
                .ends_with("is 0 or along the line of sight; give a vector that is neither")
        );
    }
    assert_eq!(
        camera("fov_y", json!(180)),
        "camera.fov_y: 180 is not valid; give an angle > 0 and < 180 (degrees)"
    );
    assert_eq!(
        camera("eye", json!([1e300, 0, 0]))
            .split_once(" is not")
            .unwrap()
            .1,
        " valid; give three finite numbers (mm)"
    );
    let auto = |key: &str, value: f64| message(json!({ "camera": { "type": "auto", key: value } }));
    assert_eq!(
        auto("elevation", 91.0),
        "camera.elevation: 91 is not valid; give an angle from -90 to 90 (degrees)"
    );
    assert_eq!(
        auto("zoom", 0.0),
        "camera.zoom: 0 is not valid; give a number > 0"
    );
    assert_eq!(
        message(
            json!({ "camera": { "type": "orthographic", "eye": [0, -4, 0], "target": [0, 0, 0],
                                    "up": [0, 0, 1], "height": 0 } })
        ),
        "camera.height: 0 is not valid; give a number > 0 (mm)"
    );
}

#[test]
fn labels_say_what_is_valid() {
    let labels = |labels: Value| {
        let volume = json!({ "path": "head.nrrd", "labels": labels });
        error(parse(&json!({ "volume": volume }).to_string()))
    };
    for (value, expected) in [
        (json!({}), "volume.labels.path: missing; give a string"),
        (
            json!({ "path": "" }),
            "volume.labels.path: empty; give a file",
        ),
        (
            json!({ "path": "a", "shown": [1] }),
            "volume.labels.shown: unknown key; did you mean \"show\"? Valid here: channel, colors, hide, path, series, show, tint",
        ),
        (
            json!({ "path": "a", "show": [0.5] }),
            "volume.labels.show.0: 0.5 is not valid; give a whole number",
        ),
        (
            json!({ "path": "a", "show": [1], "hide": [0] }),
            "volume.labels: has both \"show\" and \"hide\"; give one of them, or neither to draw every label",
        ),
        (
            json!({ "path": "a", "colors": { "liver": [1, 0, 0] } }),
            "volume.labels.colors.liver: unknown key; keys here are whole numbers of 32 bits",
        ),
        (
            json!({ "path": "a", "colors": { "1": [1, 0] } }),
            "volume.labels.colors.1: [1,0] is not valid; give a list of 3 numbers",
        ),
        (
            json!({ "path": "a", "colors": { "1": [1, 0, 2] } }),
            "volume.labels.colors.1: [1, 0, 2] is not valid; give three numbers from 0 to 1",
        ),
        (
            json!({ "path": "a", "tint": 1.5 }),
            "volume.labels.tint: 1.5 is not valid; give a number from 0 to 1",
        ),
    ] {
        assert_eq!(labels(value), expected);
    }
}

#[test]
fn colors_of_the_data() {
    let colors = |more: Value, color: &str| {
        let mut scene = json!({ "volume": { "path": "x", "color": color } });
        for (key, value) in more.as_object().unwrap() {
            scene[key] = value.clone();
        }
        parse(&scene.to_string())
    };
    for projection in ["maximum", "minimum", "mean", "xray", "isosurface"] {
        let mut march = json!({ "march": { "projection": projection } });
        if projection == "isosurface" {
            march["march"]["isosurfaces"] = json!([{ "value": 1 }]);
        }
        assert!(colors(march.clone(), "transfer_function").is_ok());
        assert_eq!(
            error(colors(march, "data")),
            "volume.color: \"data\" needs the projection \"composite\", others draw values and surfaces; give \
             \"transfer_function\""
        );
    }
    assert_eq!(
        error(parse(
            r#"{"volume":{"path":"x","color":"data","channel":1}}"#
        )),
        "volume.color: \"data\" draws all channels as colours, volume.channel reads one of them; give one of the two"
    );
    assert_eq!(
        error(colors(json!({}), "datum")),
        "volume.color: \"datum\" is not available; this version has \"data\", \"transfer_function\""
    );
}
