//! Pictures say where they come from, and can be rendered again from that.

use std::fs;
use std::process::Command;

use serde_json::{Value, json};
use umbravox::output;

use crate::workplace::Workplace;

fn entry(place: &Workplace, picture: &str, keyword: &str) -> String {
    let entries = output::read_provenance(&place.path(picture)).unwrap();
    let found = entries.into_iter().find(|(name, _)| name == keyword);
    found.unwrap_or_else(|| panic!("no {keyword}")).1
}

fn bytes(place: &Workplace, name: &str) -> Vec<u8> {
    fs::read(place.path(name)).unwrap()
}

/// Moves the device's name in a picture's metadata to another one of the same length.
fn rename_device(place: &Workplace, picture: &str, renamed: &str) {
    let image = image::open(place.path(picture)).unwrap().to_rgb8();
    let picture_of = umbravox::picture::Picture {
        size: [image.width(), image.height()],
        rgba: image.pixels().map(|_| [0.0; 4]).collect(),
        depth: vec![0.0; image.pixels().len()],
        through: None,
        variance: None,
        median_depth: vec![0.0; image.pixels().len()],
        measure: vec![0.0; image.pixels().len()],
        measured: umbravox::picture::Measured::ExpectedDepth,
        samples: vec![0; image.pixels().len()],
    };
    let entries = output::read_provenance(&place.path(picture)).unwrap();
    let entries: Vec<(&str, String)> = entries
        .iter()
        .map(|(name, text)| {
            let text = if name == "Device" {
                "another device"
            } else {
                text
            };
            (name.as_str(), text.to_owned())
        })
        .collect();
    output::write(
        &place.path(renamed),
        &picture_of,
        &umbravox::scene::Image::default(),
        &entries,
    )
    .unwrap();
}

#[test]
fn metadata_says_where_a_picture_comes_from() {
    let place = Workplace::new();
    place.succeed(&["render", "scene.json", "-o", "a.png", "-o", "a.exr"]);
    let devices: Value = serde_json::from_str(&place.succeed(&["devices", "--json"])).unwrap();
    for picture in ["a.png", "a.exr"] {
        let of = |keyword| entry(&place, picture, keyword);
        assert_eq!(
            of("Software"),
            format!("umbravox {}", env!("CARGO_PKG_VERSION"))
        );
        assert_eq!(of("Data").len(), 64);
        assert_eq!(of("Light"), "4");
        // 20 x 18 x 16 voxels make 2 x 2 x 1 blocks, all at the finest level.
        assert_eq!(of("Levels"), "0 0 0 0 4");
        let device = devices.as_array().unwrap().iter();
        let device = device.clone().find(|d| d["name"] == json!(of("Device")));
        assert_eq!(device.unwrap()["driver"], json!(of("Driver")));
        let scene: Value = serde_json::from_str(&of("Scene")).unwrap();
        assert_eq!(scene["image"]["size"], json!([24, 16]));
        let path = scene["volume"]["path"].as_str().unwrap();
        assert_eq!(
            fs::canonicalize(path).unwrap(),
            fs::canonicalize(place.path("ball.raw")).unwrap()
        );
    }
}

#[test]
fn the_data_is_known_by_its_voxels_not_by_its_file() {
    let place = Workplace::new();
    let data = |input: &str, picture: &str, change: &str| {
        place.succeed(&[
            "render",
            input,
            "-o",
            picture,
            "--set",
            "image.size=[8,8]",
            "--set",
            change,
        ]);
        entry(&place, picture, "Data")
    };
    let raw = data("scene.json", "a.png", "ambient_occlusion=null");
    let nrrd = data("ball.nrrd", "b.png", "ambient_occlusion=null");
    assert_eq!(raw, nrrd);
    let stretched = data("scene.json", "c.png", "volume.raw.spacing=[1,1,1.6]");
    assert_ne!(raw, stretched);
    let mut voxels = bytes(&place, "ball.raw");
    voxels[4321] ^= 1;
    fs::write(place.path("ball.raw"), voxels).unwrap();
    assert_ne!(raw, data("scene.json", "d.png", "ambient_occlusion=null"));
}

#[test]
fn pictures_are_reproduced_byte_by_byte() {
    let place = Workplace::new();
    place.succeed(&[
        "render",
        "scene.json",
        "-o",
        "a.png",
        "-o",
        "a.exr",
        "-o",
        "s%d.png",
        "--set",
        "march.jitter=true",
    ]);
    for (from, to) in [
        ("a.png", "b.png"),
        ("a.exr", "b.exr"),
        ("a.png", "from_png.exr"),
        ("a.exr", "from_exr.png"),
        // Of half the light.
        ("s1.png", "t.png"),
    ] {
        let outcome = place.run(&["render", "--reproduce", from, "-o", to]);
        assert_eq!((outcome.status, outcome.stderr.as_str()), (0, ""));
    }
    let same = |a, b| assert!(bytes(&place, a) == bytes(&place, b), "{a} and {b} differ");
    same("a.png", "b.png");
    same("a.exr", "b.exr");
    same("a.exr", "from_png.exr");
    same("a.png", "from_exr.png");
    same("s1.png", "t.png");
    assert!(bytes(&place, "s1.png") != bytes(&place, "a.png"));
}

#[test]
fn other_data_is_refused_and_moved_data_is_found() {
    let place = Workplace::new();
    place.succeed(&["render", "scene.json", "-o", "a.png"]);
    let then = entry(&place, "a.png", "Data");
    // Elsewhere, and in another format.
    fs::rename(place.path("ball.raw"), place.path("moved.raw")).unwrap();
    let again = ["render", "--reproduce", "a.png", "-o", "b.png"];
    let message = place.refuse(&again);
    assert!(message.contains("ball.raw"), "{message}");
    place.succeed(&[&again[..], &["--volume", "moved.raw"]].concat());
    assert!(bytes(&place, "a.png") == bytes(&place, "b.png"));
    fs::remove_file(place.path("b.png")).unwrap();
    // Changed.
    let mut voxels = bytes(&place, "moved.raw");
    voxels[5000] ^= 4;
    fs::write(place.path("ball.raw"), voxels).unwrap();
    let message = place.refuse(&again);
    assert!(message.starts_with("a.png: "), "{message}");
    assert!(message.contains(&then), "{message}");
    let hashes = message.split(|c: char| !c.is_ascii_hexdigit());
    let hashes: Vec<&str> = hashes.filter(|word| word.len() == 64).collect();
    assert_eq!(hashes.len(), 2, "{message}");
    assert_ne!(hashes[0], hashes[1]);
}

#[test]
fn another_device_is_said() {
    let place = Workplace::new();
    place.succeed(&["render", "scene.json", "-o", "a.png"]);
    rename_device(&place, "a.png", "elsewhere.png");
    let outcome = place.run(&["render", "--reproduce", "elsewhere.png", "-o", "b.png"]);
    assert_eq!(outcome.status, 0, "{}", outcome.stderr);
    assert_eq!(outcome.stderr.lines().count(), 1, "{}", outcome.stderr);
    let said = "warning: not as it was recorded: device: was another device, is ";
    assert!(outcome.stderr.starts_with(said), "{}", outcome.stderr);
    assert!(bytes(&place, "a.png") == bytes(&place, "b.png"));
}

#[test]
fn pictures_of_others_are_refused() {
    let place = Workplace::new();
    image::RgbImage::new(3, 2)
        .save(place.path("plain.png"))
        .unwrap();
    fs::write(place.path("text.png"), "no picture").unwrap();
    for (picture, expected) in [
        ("plain.png", "plain.png: its metadata has no \"Levels\""),
        ("text.png", "text.png: is neither PNG nor EXR"),
        ("none.png", "none.png: No such file"),
    ] {
        let message = place.refuse(&["render", "--reproduce", picture, "-o", "b.png"]);
        assert!(message.starts_with(expected), "{message}");
    }
    for args in [
        &[
            "render",
            "scene.json",
            "--reproduce",
            "a.png",
            "-o",
            "b.png",
        ][..],
        &[
            "render",
            "--reproduce",
            "a.png",
            "--set",
            "march.step=1",
            "-o",
            "b.png",
        ],
        &[
            "render",
            "scene.json",
            "--volume",
            "ball.raw",
            "-o",
            "b.png",
        ],
        &["render", "-o", "b.png"],
    ] {
        place.refuse(args);
    }
}

/// Runs with a number of threads.
fn render_with_threads(place: &Workplace, threads: &str, output: &str) {
    let done = Command::new(env!("CARGO_BIN_EXE_umbravox"))
        .args(["render", "scene.json", "-o", output])
        .env("RAYON_NUM_THREADS", threads)
        .current_dir(place.folder.path())
        .status()
        .unwrap();
    assert!(done.success());
}

#[test]
fn bytes_depend_on_scene_and_data_alone() {
    let place = Workplace::new();
    let outputs = |name: &str| [format!("{name}.png"), format!("{name}.exr")];
    let render = |name: &str, args: &[&str]| {
        let [png, exr] = outputs(name);
        let base = ["render", "scene.json", "-o", &png, "-o", &exr];
        place.succeed(&[&base[..], args].concat());
    };
    render("a", &[]);
    render("again", &[]);
    render("tile", &["--tile", "5"]);
    let mut names = vec!["again", "tile"];
    if cfg!(feature = "vk-mem") {
        render("vma", &["--memory", "vma"]);
        names.push("vma");
    }
    for name in names {
        for (a, b) in outputs("a").into_iter().zip(outputs(name)) {
            assert!(bytes(&place, &a) == bytes(&place, &b), "{b} differs");
        }
    }
    for threads in ["1", "3"] {
        render_with_threads(&place, threads, "threads.exr");
        assert!(bytes(&place, "a.exr") == bytes(&place, "threads.exr"));
    }
    // The scene in the metadata says what budget there was; the pixels do not.
    render("ample", &["--set", "storage.memory_budget_mib=4096"]);
    let pixels = |name: &str| image::open(place.path(name)).unwrap().to_rgb8();
    assert_eq!(pixels("a.png"), pixels("ample.png"));
    let layers = |name: &str| {
        let image = exr::prelude::read_first_flat_layer_from_file(place.path(name)).unwrap();
        let channels = image.layer_data.channel_data.list;
        let floats = channels.iter().flat_map(|c| c.sample_data.values_as_f32());
        floats.map(f32::to_bits).collect::<Vec<u32>>()
    };
    assert!(layers("a.exr") == layers("ample.exr"));
}

#[test]
fn another_transfer_function_is_said() {
    let place = Workplace::new();
    let points = |opacity: f64| {
        let point = |value: f64, opacity: f64| json!({ "value": value, "color": [1, 1, 1], "opacity": opacity });
        json!({ "unit_distance": 1, "points": [point(0.0, 0.0), point(200.0, opacity)] })
            .to_string()
    };
    fs::write(place.path("tf.json"), points(0.2)).unwrap();
    let set = "transfer_function={\"file\":\"tf.json\"}";
    place.succeed(&["render", "scene.json", "--set", set, "-o", "a.png"]);
    let again = ["render", "--reproduce", "a.png", "-o", "b.png"];
    assert_eq!(place.run(&again).stderr, "");
    assert!(bytes(&place, "a.png") == bytes(&place, "b.png"));
    fs::write(place.path("tf.json"), points(0.7)).unwrap();
    let said = place.run(&again).stderr;
    let start = "warning: not as it was recorded: transfer function: was ";
    assert!(said.starts_with(start), "{said}");
    assert!(bytes(&place, "a.png") != bytes(&place, "b.png"));
}
