//! Labels beside the volume, from files.

use std::fs;

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
