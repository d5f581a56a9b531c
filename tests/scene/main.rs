//! Scene files: parsing, overrides, every kind of bad input, cameras, transfer functions.

mod camera;
mod content;
mod first_picture;
mod messages;
mod phase;
mod procedural;
mod transfer_file;
mod transfer_function;

use std::path::Path;

use serde_json::Value;
use umbravox::scene::{
    Camera, Classification, March, Override, Scene, Shading, is_scene_file, schema,
};
use umbravox::{Error, Result};

fn parse(text: &str) -> Result<Scene> {
    Scene::from_json(text, Path::new(""), &[])
}

fn error<T: std::fmt::Debug>(result: Result<T>) -> String {
    let error = result.expect_err("bad input must be refused");
    assert!(error.is_bad_input(), "{error}");
    error.to_string()
}

fn set(text: &str, overrides: &[&str]) -> Result<Scene> {
    let overrides: Result<Vec<_>> = overrides.iter().map(|o| Override::parse(o)).collect();
    Scene::from_json(text, Path::new(""), &overrides?)
}

const MINIMAL: &str = r#"{ "volume": { "path": "head.nrrd" } }"#;

const COMPLETE: &str = r#"{
  "volume": { "path": "head.raw",
              "raw": { "size": [256,256,256], "type": "u8", "spacing": [1,1,1], "endian": "little", "offset": 0 } },
  "camera": { "type": "perspective", "eye": [0,-400,0], "target": [0,0,0], "up": [0,0,1], "fov_y": 30 },
  "image":  { "size": [512,512], "background": [0,0,0], "color_management": "linear" },
  "transfer_function": {
    "unit_distance": 1.0,
    "points": [ { "value": -1000, "color": [0,0,0], "opacity": 0.0 },
                { "value": 300,   "color": [1,0.9,0.8], "opacity": 0.4, "emission": [0,0,0] } ] },
  "march":  { "step": 0.5, "early_termination": 0.99, "jitter": false, "interpolation": "linear",
              "classification": "post", "empty_space_skipping": true },
  "lighting": { "model": "emission_absorption" },
  "ambient_occlusion": { "rays": 32, "radius": 16, "offset": 1.0, "step": 1.0, "gamma": 1.0, "bias": 0.0,
                         "directions": "fibonacci", "weights": null },
  "storage": { "data_reduction": 1.0, "memory_budget_mib": 1024 }
}"#;

#[test]
fn complete_and_minimal_scenes_parse() {
    let complete = parse(COMPLETE).unwrap();
    assert_eq!(complete.image.size, [512, 512]);
    assert_eq!(
        complete.transfer_function.points.as_ref().unwrap()[1].color,
        [1.0, 0.9, 0.8]
    );
    assert_eq!(complete.ambient_occlusion, Some(Default::default()));
    let minimal = parse(MINIMAL).unwrap();
    assert_eq!(minimal.ambient_occlusion, None);
    assert_eq!(minimal.camera, Camera::default());
    assert_eq!(
        minimal.march.classification(),
        Classification::Preintegrated
    );
    assert_eq!(
        complete.march,
        March {
            classification: Some(Classification::Post),
            ..minimal.march
        }
    );
}

#[test]
fn scenes_survive_being_written() {
    for text in [COMPLETE, MINIMAL] {
        let scene = parse(text).unwrap();
        let written = serde_json::to_string(&scene).unwrap();
        assert_eq!(parse(&written).unwrap(), scene);
    }
}

#[test]
fn volume_path_is_relative_to_the_scene() {
    let folder = Path::new("/data/scenes");
    let scene = Scene::from_json(MINIMAL, folder, &[]).unwrap();
    assert_eq!(scene.volume.path, Path::new("/data/scenes/head.nrrd"));
    let absolute = [Override::parse("volume.path=/ct/head.nrrd").unwrap()];
    let scene = Scene::from_json(MINIMAL, folder, &absolute).unwrap();
    assert_eq!(scene.volume.path, Path::new("/ct/head.nrrd"));
}

#[test]
fn files_are_named_in_messages() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bad.json");
    std::fs::write(
        &path,
        r#"{ "volume": { "path": "x" }, "march": { "step": 0 } }"#,
    )
    .unwrap();
    assert_eq!(
        error(Scene::read(&path, &[])),
        format!(
            "{}: march.step: 0 is not valid; give a number > 0 (voxels)",
            path.display()
        )
    );
    std::fs::write(&path, b"{ \"volume\": \"\xff\" }").unwrap();
    assert!(
        error(Scene::read(&path, &[]))
            .ends_with("byte 13 is not UTF-8; a scene file is UTF-8 JSON")
    );
    std::fs::write(&path, format!("\u{feff}{MINIMAL}")).unwrap();
    assert_eq!(
        Scene::read(&path, &[]).unwrap().volume.path,
        folder.path().join("head.nrrd")
    );
    let missing = Scene::read(&folder.path().join("none.json"), &[]);
    assert!(matches!(missing, Err(Error::Io { .. })));
}

#[test]
fn scenes_are_told_from_volumes_by_content() {
    let folder = tempfile::tempdir().unwrap();
    let is_scene = |name: &str, content: &[u8]| {
        let path = folder.path().join(name);
        std::fs::write(&path, content).unwrap();
        is_scene_file(&path).unwrap()
    };
    assert!(is_scene("scene", b" \n{ \"volume\": {} }"));
    assert!(is_scene("scene.nrrd", b"\xef\xbb\xbf{}"));
    assert!(is_scene("broken.json", b"[1, 2"));
    assert!(!is_scene("head.nrrd", b"NRRD0004\n"));
    assert!(!is_scene("head.raw", b"{\"\0\0\x01"));
    assert!(!is_scene("short.raw", b"{z"));
    assert!(!is_scene("empty", b""));
    assert!(!is_scene_file(folder.path()).unwrap());
    assert!(is_scene_file(&folder.path().join("none")).is_err());
}

#[test]
fn syntax_errors_have_line_and_column() {
    assert_eq!(
        error(parse("{ \"volume\": {},\n }")),
        "line 2, column 2: not valid JSON: trailing comma"
    );
    assert!(error(parse("")).starts_with("line 1, column 0: not valid JSON: EOF"));
    assert!(
        error(parse("{ \"march\": {\n \"step\": 1, \"step\": 2 } }"))
            .starts_with("line 2, column 18: not valid JSON: the key \"step\" stands twice")
    );
    assert!(error(parse(r#"{ "march": { "step": 1e999 } }"#)).contains("number out of range"));
}

#[test]
fn overrides_reach_every_place() {
    let scene = set(
        COMPLETE,
        &[
            "march.step=0.25",
            "/march/jitter=true",
            "camera.eye=[0,1,2]",
            "transfer_function.points.0.opacity=1",
            "lighting.shading=diffuse",
        ],
    )
    .unwrap();
    assert_eq!(scene.march.step, 0.25);
    assert!(scene.march.jitter);
    assert!(matches!(
        scene.camera,
        Camera::Perspective {
            eye: [0.0, 1.0, 2.0],
            ..
        }
    ));
    assert_eq!(scene.transfer_function.points.unwrap()[0].opacity, 1.0);
    let scene = set(MINIMAL, &["ambient_occlusion.rays=8"]).unwrap();
    assert_eq!(scene.ambient_occlusion.unwrap().rays, 8);
    assert_eq!(
        set(COMPLETE, &["ambient_occlusion=null"])
            .unwrap()
            .ambient_occlusion,
        None
    );
    let scene = set(MINIMAL, &["volume.path=a=b.nrrd"]).unwrap();
    assert_eq!(scene.volume.path, Path::new("a=b.nrrd"));
}

#[test]
fn wrong_overrides_read_like_wrong_files() {
    for (change, expected) in [
        (
            "march.step=0",
            "march.step: 0 is not valid; give a number > 0 (voxels)",
        ),
        (
            "march.step=fast",
            "march.step: \"fast\" is not valid; give a number",
        ),
        (
            "march.step.x=1",
            "march.step: 0.5 has no part \"x\"; set it as a whole",
        ),
        (
            "transfer_function.points.7.opacity=1",
            "transfer_function.points: \"7\" is not an item of this list; it has 2, counted from 0",
        ),
        (
            "march.step",
            "--set march.step: there is no \"=\"; give PLACE=VALUE, as in march.step=0.25 or /march/step=0.25",
        ),
        (
            "march..step=1",
            "--set march..step=1: the place has an empty key; give PLACE=VALUE, as in march.step=0.25 or /march/step=0.25",
        ),
    ] {
        assert_eq!(error(set(COMPLETE, &[change])), expected);
    }
    assert!(
        error(set(MINIMAL, &["march.stepp=1"]))
            .starts_with("march.stepp: unknown key; did you mean \"step\"?")
    );
    assert!(error(set(MINIMAL, &["=1"])).contains("empty key"));
}

#[test]
fn a_volume_without_a_scene_gets_one() {
    let scene = Scene::for_volume(Path::new("dir/head.nrrd"), &[]).unwrap();
    assert_eq!(scene.volume.path, Path::new("dir/head.nrrd"));
    assert_eq!(scene.ambient_occlusion.unwrap().radius, 16.0);
    assert_eq!(scene.lighting.shading, Shading::Diffuse);
    let change = Override::parse("ambient_occlusion=null").unwrap();
    let scene = Scene::for_volume(Path::new("head.nrrd"), &[change]).unwrap();
    assert_eq!(scene.ambient_occlusion, None);
}

#[test]
fn scenes_may_name_their_schema() {
    let naming = |schema: &str| MINIMAL.replacen('{', &format!("{{ \"$schema\": {schema}, "), 1);
    let plain = set(MINIMAL, &[]).unwrap();
    assert_eq!(set(&naming("\"scene.schema.json\""), &[]).unwrap(), plain);
    assert!(error(set(&naming("4"), &[])).starts_with("$schema: 4 is not valid; give "));
    assert_eq!(schema()["properties"]["$schema"]["type"], "string");
}

#[test]
fn schema_describes_every_key() {
    fn undescribed(schema: &Value, at: &str, found: &mut Vec<String>) {
        for (key, property) in schema["properties"].as_object().into_iter().flatten() {
            // The tag of a variant is described by the variant.
            if property.get("description").is_none() && property.get("const").is_none() {
                found.push(format!("{at}.{key}"));
            }
        }
        for (name, part) in schema["$defs"].as_object().into_iter().flatten() {
            undescribed(part, name, found);
            for variant in part["oneOf"].as_array().into_iter().flatten() {
                undescribed(variant, name, found);
            }
        }
    }
    let schema = schema();
    assert!(schema["properties"].as_object().unwrap().len() >= 8);
    let mut found = Vec::new();
    undescribed(&schema, "", &mut found);
    assert_eq!(found, Vec::<String>::new());
}
