//! `umbravox tf`, and what `info` takes a volume for.

use std::fs;

use serde_json::{Value, json};

use crate::workplace::Workplace;

#[test]
fn presets_are_listed() {
    let place = Workplace::new();
    let list = place.succeed(&["tf"]);
    assert_eq!(list, place.succeed(&["tf", "list"]));
    let rows: Value = serde_json::from_str(&place.succeed(&["tf", "list", "--json"])).unwrap();
    let rows = rows.as_array().unwrap();
    assert_eq!(rows.len(), list.lines().count());
    for name in ["ct-bone", "mr-default", "labels", "boundaries"] {
        assert!(rows.iter().any(|row| row["name"] == name), "{name}: {list}");
    }
}

#[test]
fn functions_go_through_every_form() {
    let place = Workplace::new();
    place.succeed(&["tf", "convert", "ct-bone", "-o", "a.json"]);
    let first = place.json("a.json");
    assert_eq!(first["points"][0]["value"], json!(150.0));
    for (from, to) in [
        ("a.json", "b.xml"),
        ("b.xml", "c.vp"),
        ("c.vp", "d.vp.json"),
        ("d.vp.json", "e.json"),
    ] {
        place.succeed(&["tf", "convert", from, "-o", to]);
    }
    let last = place.json("e.json");
    let ends = |function: &Value| {
        let points = function["points"].as_array().unwrap();
        [
            points[0]["value"].clone(),
            points[points.len() - 1]["value"].clone(),
        ]
    };
    assert_eq!(ends(&last), ends(&first));
    place.succeed(&[
        "tf",
        "convert",
        "a.json",
        "-o",
        "p.json",
        "--format",
        "paraview-json",
    ]);
    assert_eq!(place.json("p.json")[0]["ColorSpace"], "RGB");
    // Scenes take each of them.
    for file in ["a.json", "b.xml", "c.vp", "d.vp.json", "p.json"] {
        let set = format!("transfer_function={{\"file\":\"{file}\"}}");
        place.succeed(&["info", "scene.json", "--set", &set]);
    }
}

#[test]
fn plots_are_pictures() {
    let place = Workplace::new();
    place.succeed(&["tf", "plot", "ct-bone", "-o", "a.png"]);
    place.succeed(&[
        "tf",
        "plot",
        "boundaries",
        "--volume",
        "ball.nrrd",
        "-o",
        "b.png",
    ]);
    let [a, b] = ["a.png", "b.png"].map(|name| image::open(place.path(name)).unwrap().to_rgb8());
    assert_eq!(a.dimensions(), b.dimensions());
    assert_ne!(a, b, "a histogram behind, another curve");
}

#[test]
fn what_cannot_be_converted_is_refused() {
    let place = Workplace::new();
    fs::write(place.path("bad.xml"), "<ColorMap><Point x='0'/></ColorMap>").unwrap();
    for (args, expected) in [
        (
            &["tf", "convert", "ct-bon", "-o", "a.json"][..],
            "ct-bon: is neither a file nor one of the presets ct-bone",
        ),
        (
            &["tf", "convert", "ct-bone", "-o", "a.txt"],
            "a.txt: its extension is none of transfer functions",
        ),
        (
            &[
                "tf", "convert", "ct-bone", "-o", "a.json", "--format", "vtk",
            ],
            "--format: \"vtk\" is not a form",
        ),
        (
            &["tf", "convert", "labels", "-o", "a.json"],
            "labels: follows the values of a volume",
        ),
        (
            &["tf", "convert", "bad.xml", "-o", "a.json"],
            "bad.xml: ColorMap.Point 0.r: missing",
        ),
        (
            &["tf", "convert", "bad.xml", "-o", "bad.xml"],
            "bad.xml: is also an input",
        ),
        (
            &["tf", "plot", "ct-bone", "-o", "a.exr"],
            "a.exr: plots are PNG",
        ),
    ] {
        let message = place.refuse(args);
        assert!(message.starts_with(expected), "{message}");
    }
}

#[test]
fn info_says_what_a_volume_is_taken_for() {
    let place = Workplace::new();
    let info: Value =
        serde_json::from_str(&place.succeed(&["info", "ball.nrrd", "--json"])).unwrap();
    assert_eq!(info["content"]["modality"], "ct");
    assert_eq!(info["content"]["preset"], "ct-bone");
    let reason = info["content"]["reason"].as_str().unwrap();
    assert!(
        reason.contains("-1000") && reason.contains("Hounsfield"),
        "{reason}"
    );
}
