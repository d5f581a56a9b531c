//! Labels beside the volume, from files.

use std::fs;

use serde_json::{Value, json};

use crate::workplace::Workplace;

/// Labels for the ball: 5 where x < 10, 9 elsewhere, on a grid of half the voxels; 0 outside of the ball's box.
fn with_labels() -> Workplace {
    let place = Workplace::new();
    let voxels: Vec<u8> = (0..5 * 9 * 8)
        .map(|at| if at % 5 < 2 { 5 } else { 9 })
        .collect();
    write(&place, "seg.nrrd", "uint8", "5 9 8", "(2,2,1)", &voxels);
    place
}

fn write(place: &Workplace, name: &str, voxel_type: &str, sizes: &str, from: &str, voxels: &[u8]) {
    let header = format!(
        "NRRD0004\ntype: {voxel_type}\ndimension: 3\nspace: left-posterior-superior\nsizes: {sizes}\n\
         space directions: (4,0,0) (0,2,0) (0,0,3)\nspace origin: {from}\nendian: little\nencoding: raw\n\n"
    );
    fs::write(place.path(name), [header.as_bytes(), voxels].concat()).unwrap();
}

fn set(labels: &str) -> String {
    format!("volume.labels={labels}")
}

fn picture(place: &Workplace, name: &str, changes: &[&str]) -> image::RgbImage {
    let mut args = vec!["render", "scene.json", "-o", name];
    for change in changes {
        args.extend(["--set", change]);
    }
    place.succeed(&args);
    image::open(place.path(name)).unwrap().to_rgb8()
}

/// Pixels whose strongest channel is red, green or blue, by far.
fn strongest(picture: &image::RgbImage) -> [usize; 3] {
    std::array::from_fn(|c| {
        let far = |p: &&image::Rgb<u8>| {
            (0..3).all(|o| o == c || u16::from(p[c]) > 2 * u16::from(p[o]) + 20)
        };
        picture.pixels().filter(far).count()
    })
}

#[test]
fn labels_hide_and_color() {
    let place = with_labels();
    let plain = picture(&place, "plain.png", &[]);
    let neutral = set(r#"{"path":"seg.nrrd","colors":{}}"#);
    assert_eq!(picture(&place, "neutral.png", &[&neutral]), plain);

    let colors = r#""colors":{"5":[1,0,0],"9":[0,0,1]}"#;
    let both = set(&format!(r#"{{"path":"seg.nrrd",{colors}}}"#));
    let [red, green, blue] = strongest(&picture(&place, "both.png", &[&both]));
    assert!(red > 0 && green == 0 && blue > 5, "{red} {green} {blue}");

    let one = set(&format!(r#"{{"path":"seg.nrrd","show":[9],{colors}}}"#));
    let [red, green, blue] = strongest(&picture(&place, "one.png", &[&one]));
    assert!(red == 0 && green == 0 && blue > 5, "{red} {green} {blue}");

    let tint = "volume.labels.tint=0";
    let untinted = picture(&place, "tint.png", &[&both, tint]);
    assert_eq!(untinted, plain, "no share of any colour");
}

/// Layers of segments that overlap: in layer 1 the labels of `with_labels` are the other way round.
fn layers() -> Vec<u8> {
    let layers = (0..5 * 9 * 8).flat_map(|at| if at % 5 < 2 { [5, 9] } else { [9, 5] });
    layers.collect()
}

fn write_layers(place: &Workplace) {
    let header = "NRRD0004\ntype: uint8\ndimension: 4\nspace: left-posterior-superior\nsizes: 2 5 9 8\n\
        kinds: list domain domain domain\nspace directions: none (4,0,0) (0,2,0) (0,0,3)\nspace origin: (2,2,1)\n\
        Segment0_LabelValue:=5\nSegment0_Name:=left\nSegment1_LabelValue:=9\nSegment1_Name:=right\nencoding: raw\n\n";
    let file = [header.as_bytes(), &layers()].concat();
    fs::write(place.path("layers.seg.nrrd"), file).unwrap();
}

const COLORS: &str = r#""colors":{"5":[1,0,0],"9":[0,0,1]}"#;

#[test]
fn layers_are_picked_by_channel() {
    let place = with_labels();
    write_layers(&place);
    let of = |name: &str, labels: &str| {
        picture(&place, name, &[&set(&format!("{{{labels},{COLORS}}}"))])
    };
    let plain = of("plain.png", r#""path":"seg.nrrd""#);
    let first = of("0.png", r#""path":"layers.seg.nrrd","channel":0"#);
    let second = of("1.png", r#""path":"layers.seg.nrrd","channel":1"#);
    assert_eq!(first, plain);
    let swapped = r#"{"path":"seg.nrrd","colors":{"5":[0,0,1],"9":[1,0,0]}}"#;
    assert_eq!(second, picture(&place, "swapped.png", &[&set(swapped)]));
    assert_ne!(second, plain);
    let third = set(r#"{"path":"layers.seg.nrrd","channel":2}"#);
    let message = place.refuse(&["render", "scene.json", "-o", "a.png", "--set", &third]);
    assert!(
        message.starts_with("layers.seg.nrrd: ") && message.contains("channel"),
        "{message}"
    );
}

#[test]
fn one_of_several_label_maps_is_picked_by_series() {
    let place = with_labels();
    let turned: Vec<u8> = layers().into_iter().skip(1).step_by(2).collect();
    write(&place, "turned.nrrd", "uint8", "5 9 8", "(2,2,1)", &turned);
    let mut archive = tar::Builder::new(fs::File::create(place.path("segs.tar")).unwrap());
    for name in ["seg.nrrd", "turned.nrrd"] {
        archive
            .append_path_with_name(place.path(name), name)
            .unwrap();
    }
    archive.finish().unwrap();
    let of = |name: &str, labels: &str| {
        picture(&place, name, &[&set(&format!("{{{labels},{COLORS}}}"))])
    };
    for name in ["seg.nrrd", "turned.nrrd"] {
        let packed = of("a.png", &format!(r#""path":"segs.tar","series":"{name}""#));
        assert_eq!(packed, of("b.png", &format!(r#""path":"{name}""#)));
    }
    let none = set(r#"{"path":"segs.tar","series":"none.nrrd"}"#);
    let message = place.refuse(&["render", "scene.json", "-o", "c.png", "--set", &none]);
    assert!(
        message.starts_with(
            "segs.tar: no volume \"none.nrrd\" among 2 volumes (seg.nrrd, turned.nrrd); "
        ),
        "{message}"
    );
}

/// Looks along y, one pixel a millimetre; column 12 starts at the middle of the ball, x = 10 mm.
const CAMERA: &str = r#"camera={"type":"orthographic","eye":[10,-40,12],"target":[10,9,12],"up":[0,0,1],"height":16}"#;

/// What `umbravox probe --pixel` says of what it hits.
fn probed(place: &Workplace, pixel: &str, labels: &str) -> Value {
    let text = place.succeed(&[
        "probe",
        "scene.json",
        "--json",
        "--validation",
        "--pixel",
        pixel,
        "--set",
        labels,
        "--set",
        CAMERA,
    ]);
    let probe: Value = serde_json::from_str(&text).unwrap();
    assert!(probe["hit"].is_object(), "{probe}");
    probe["hit"].clone()
}

#[test]
fn a_pixel_names_its_label() {
    let place = with_labels();
    write_layers(&place);
    let unnamed = set(r#"{"path":"seg.nrrd"}"#);
    let mut seen = [false; 2];
    for pixel in ["7,8", "8,6", "12,7"] {
        let hit = probed(&place, pixel, &unnamed);
        // Labels of `with_labels` lie at 2, 6, 10 … mm, and the first two of a row are 5.
        let right = hit["world"][0].as_f64().unwrap() > 8.0;
        let label = if right { 9 } else { 5 };
        assert_eq!(hit["label"], json!({ "label": label }), "{pixel}");
        for (channel, name) in [(0, label), (1, 14 - label)] {
            let layer = set(&format!(
                r#"{{"path":"layers.seg.nrrd","channel":{channel}}}"#
            ));
            let name_of = if name == 5 { "left" } else { "right" };
            assert_eq!(
                probed(&place, pixel, &layer)["label"],
                json!({ "label": name, "name": name_of })
            );
        }
        seen[usize::from(right)] = true;
    }
    assert_eq!(seen, [true; 2], "both labels are hit");
    let text = place.succeed(&["probe", "scene.json", "--pixel", "12,7", "--set", &unnamed]);
    assert!(text.contains("label"), "{text}");
    // What is left out is not hit.
    let hidden = set(r#"{"path":"seg.nrrd","show":[9]}"#);
    assert_eq!(probed(&place, "12,7", &hidden)["label"]["label"], 9);
    let args = ["--pixel", "8,6", "--set", &hidden, "--set", CAMERA];
    let text = place.succeed(&[&["probe", "scene.json", "--json"], &args[..]].concat());
    let probe: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(probe["hit"], Value::Null, "{probe}");
}

#[test]
fn paths_of_labels_start_from_the_scene() {
    let place = with_labels();
    fs::create_dir(place.path("scenes")).unwrap();
    let scene = r#"{ "volume": { "path": "../ball.nrrd", "labels": { "path": "../seg.nrrd", "hide": [0] } },
                     "image": { "size": [8, 8] } }"#;
    fs::write(place.path("scenes/one.json"), scene).unwrap();
    place.succeed(&["render", "scenes/one.json", "-o", "a.png"]);
    let message = place.refuse(&[
        "render",
        "scenes/one.json",
        "-o",
        "a.png",
        "--stats",
        "seg.nrrd",
    ]);
    assert!(
        message.starts_with("seg.nrrd: is also an input"),
        "{message}"
    );
}

#[test]
fn pictures_are_made_again_from_the_same_labels_only() {
    let place = with_labels();
    picture(&place, "a.png", &[&set(r#"{"path":"seg.nrrd"}"#)]);
    place.succeed(&["render", "--reproduce", "a.png", "-o", "b.png"]);
    let [a, b] = ["a.png", "b.png"].map(|name| image::open(place.path(name)).unwrap());
    assert_eq!(a, b);
    write(&place, "seg.nrrd", "uint8", "5 9 8", "(2,2,1)", &[7; 360]);
    let message = place.refuse(&["render", "--reproduce", "a.png", "-o", "c.png"]);
    assert!(
        message.starts_with("a.png: was rendered from data "),
        "{message}"
    );
}

#[test]
fn what_are_no_labels_is_refused() {
    let place = with_labels();
    let halves: Vec<u8> = (0..360u16)
        .flat_map(|n| (0.5 * f32::from(n)).to_le_bytes())
        .collect();
    write(&place, "halves.nrrd", "float", "5 9 8", "(0,0,0)", &halves);
    write(&place, "far.nrrd", "uint8", "5 9 8", "(500,0,0)", &[1; 360]);
    for (labels, expected) in [
        (
            r#"{"path":"seg.nrrd","show":[9,4]}"#,
            "volume.labels.show: label 4 is not in seg.nrrd; it has 0, 5, 9",
        ),
        (
            r#"{"path":"seg.nrrd","colors":{"4":[1,1,1]}}"#,
            "volume.labels.colors: label 4 is not in seg.nrrd; it has 0, 5, 9",
        ),
        (
            r#"{"path":"halves.nrrd"}"#,
            "halves.nrrd: 0.5 is no label; labels are whole numbers",
        ),
        (
            r#"{"path":"far.nrrd"}"#,
            "volume.labels: the labels lie from [498.0, -1.0, -1.5] to [518.0, 17.0, 22.5] mm, the volume from",
        ),
        (r#"{"path":"none.nrrd"}"#, "none.nrrd: No such file"),
    ] {
        let message = place.refuse(&["render", "scene.json", "-o", "a.png", "--set", &set(labels)]);
        assert!(message.starts_with(expected), "{message}");
    }
}
