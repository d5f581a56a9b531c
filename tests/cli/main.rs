//! The program: commands, exit status, messages, files.
#![cfg(feature = "cli")]

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

use serde_json::{Value, json};

mod bench;
mod conformance;
mod labels;
mod probe;
mod procedural;
mod reproduce;
mod transfer;
mod workplace;

use workplace::Workplace;

#[test]
fn help_and_version_are_results() {
    let place = Workplace::new();
    assert!(place.succeed(&["--version"]).starts_with("umbravox "));
    let help = place.succeed(&["--help"]);
    for command in [
        "render",
        "info",
        "probe",
        "tf",
        "light",
        "bench",
        "conformance",
        "devices",
        "schema",
    ] {
        assert!(help.contains(&format!("\n  {command}")), "{help}");
    }
}

#[test]
fn schema_is_json_and_reaches_a_closed_pipe() {
    let place = Workplace::new();
    let schema: Value = serde_json::from_str(&place.succeed(&["schema"])).unwrap();
    assert_eq!(schema, umbravox::scene::schema());
    let mut child = Command::new(env!("CARGO_BIN_EXE_umbravox"))
        .arg("schema")
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    assert!(child.wait().unwrap().success());
}

#[test]
fn bad_usage_is_refused_on_one_line() {
    let place = Workplace::new();
    for (args, expected) in [
        (
            &["render", "scene.json", "-o", "a.png", "--frob"][..],
            "unexpected argument '--frob' found",
        ),
        (
            &["redner", "scene.json"],
            "unrecognized subcommand 'redner'; a similar subcommand exists: 'render'",
        ),
        (
            &["render", "scene.json"],
            "the following required arguments were not provided: --output <FILE>",
        ),
        (
            &["bench", "scene.json", "--frames", "0"],
            "invalid value '0' for '--frames <FRAMES>'",
        ),
        (
            &["bench", "scene.json", "--orbit", "nan"],
            "invalid value 'nan' for '--orbit <DEGREES>': give a finite number",
        ),
        (
            &["render", "scene.json", "-o", "a.png", "--tile", "0"],
            "invalid value '0' for '--tile <N>'",
        ),
    ] {
        let message = place.refuse(args);
        assert!(message.starts_with(expected), "{message}");
    }
}

#[test]
fn bad_scenes_are_refused() {
    let place = Workplace::new();
    fs::write(
        place.path("bad.json"),
        r#"{ "volume": { "path": "ball.nrrd" }, "marsh": {} }"#,
    )
    .unwrap();
    let message = place.refuse(&["render", "bad.json", "-o", "a.png"]);
    assert!(
        message.starts_with("bad.json: marsh: unknown key; did you mean \"march\"?"),
        "{message}"
    );
    fs::write(place.path("syntax"), "{ \"volume\": {},\n\"march\" 3 }").unwrap();
    for command in [
        &["info", "syntax"][..],
        &["bench", "syntax"],
        &["render", "syntax", "-o", "a.png"],
    ] {
        let message = place.refuse(command);
        assert!(message.starts_with("syntax: line 2, column "), "{message}");
    }
    let message = place.refuse(&["render", "none.json", "-o", "a.png"]);
    assert!(message.starts_with("none.json: No such file"), "{message}");
    fs::write(
        place.path("lost.json"),
        r#"{ "volume": { "path": "none.nrrd" } }"#,
    )
    .unwrap();
    let message = place.refuse(&["render", "lost.json", "-o", "a.png"]);
    assert!(message.contains("none.nrrd"), "{message}");
}

#[test]
fn bad_overrides_are_refused_like_bad_scenes() {
    let place = Workplace::new();
    for (change, expected) in [
        (
            "march.step=0",
            "scene.json: march.step: 0 is not valid; give a number > 0 (voxels)",
        ),
        (
            "march.stepp=1",
            "scene.json: march.stepp: unknown key; did you mean \"step\"?",
        ),
        (
            "march.classification=integrated",
            "scene.json: march.classification: \"integrated\" is not available",
        ),
        ("march", "--set march: there is no \"=\"; give PLACE=VALUE"),
    ] {
        let message = place.refuse(&["render", "scene.json", "-o", "a.png", "--set", change]);
        assert!(message.starts_with(expected), "{message}");
    }
    let message = place.refuse(&[
        "render",
        "ball.nrrd",
        "-o",
        "a.png",
        "--set",
        "camera.type=fisheye",
    ]);
    assert!(
        message.starts_with("camera.type: \"fisheye\" is not available"),
        "{message}"
    );
}

#[test]
fn bad_outputs_are_refused_before_rendering() {
    let place = Workplace::new();
    fs::create_dir(place.path("dir.png")).unwrap();
    for (args, expected) in [
        (
            &["-o", "a.gif"][..],
            "a.gif: extension \"gif\" is not a picture format; give .png or .exr",
        ),
        (
            &["-o", "none/a.png"],
            "none/a.png: there is no folder none; create it first",
        ),
        (&["-o", "dir.png"], "dir.png: is a folder; give a file name"),
        (
            &["-o", "a.png", "-o", "a.png"],
            "a.png: is given twice; give each output once",
        ),
        (
            &["-o", "a.png", "-o", "./a.png"],
            "./a.png: is given twice; give each output once",
        ),
        (
            &["-o", "a.png", "--stats", "a.png"],
            "a.png: is given twice; give each output once",
        ),
        (
            &["-o", "a.png", "--stats", "none/s.json"],
            "none/s.json: there is no folder none; create it first",
        ),
        (
            &["-o", "a.png", "--stats", "scene.json"],
            "scene.json: is also an input; give another file",
        ),
        (
            &["-o", "a.png", "--stats", "ball.raw"],
            "ball.raw: is also an input; give another file",
        ),
    ] {
        let args = [&["render", "scene.json"], args].concat();
        assert_eq!(place.refuse(&args), expected);
    }
    for (args, expected) in [
        (
            &["-o", "light.mha"][..],
            "light.mha: extension \"mha\" is not a light volume format; give .nrrd",
        ),
        (
            &["-o", "none/l.nrrd"],
            "none/l.nrrd: there is no folder none; create it first",
        ),
        (
            &["-o", "l.nrrd", "--set", "ambient_occlusion=null"],
            "ambient_occlusion: is off, so there is no light volume",
        ),
    ] {
        let message = place.refuse(&[&["light", "scene.json"], args].concat());
        assert!(message.starts_with(expected), "{message}");
    }
    let message = place.refuse(&["light", "ball.nrrd", "-o", "ball.nrrd"]);
    assert_eq!(message, "ball.nrrd: is also an input; give another file");
}

/// Said before the scene is even looked for: rendering may take hours.
#[cfg(target_os = "linux")]
#[test]
fn folders_that_take_no_file_are_found_before_rendering() {
    let place = Workplace::new();
    for (command, file) in [("render", "/proc/a.png"), ("light", "/proc/l.nrrd")] {
        let message = place.refuse(&[command, "none.json", "-o", file]);
        assert!(message.starts_with(&format!("{file}: ")), "{message}");
    }
}

#[test]
fn unknown_devices_are_refused() {
    let place = Workplace::new();
    for device in ["no such device", "4711"] {
        let message = place.refuse(&["render", "scene.json", "-o", "a.png", "--device", device]);
        assert!(message.contains(device), "{message}");
    }
}

#[test]
fn files_that_are_no_volume_are_refused() {
    let place = Workplace::new();
    fs::write(place.path("noise.bin"), b"nothing that anybody knows").unwrap();
    for args in [
        &["info", "noise.bin"][..],
        &["render", "noise.bin", "-o", "a.png"],
    ] {
        let message = place.refuse(args);
        assert!(message.starts_with("noise.bin: "), "{message}");
    }
    let message = place.refuse(&[
        "render",
        "scene.json",
        "-o",
        "a.png",
        "--set",
        "volume.raw.size.0=21",
    ]);
    assert!(message.contains("ball.raw"), "{message}");
}

#[test]
fn info_describes_volumes_and_scenes() {
    let place = Workplace::new();
    for input in ["ball.nrrd", "scene.json"] {
        let info: Value = serde_json::from_str(&place.succeed(&["info", input, "--json"])).unwrap();
        assert_eq!(info["size"], json!([20, 18, 16]), "{info}");
        assert!(place.succeed(&["info", input]).contains("[20,18,16]"));
    }
}

/// Parsers of other crates warn of what a reader deals with, file by file.
#[test]
fn a_series_without_file_meta_groups_is_read_in_silence() {
    let series = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/data/formats/no_meta_implicit.zip"
    );
    let quiet = Workplace::new().run(&["info", series]);
    assert_eq!((quiet.status, quiet.stderr.as_str()), (0, ""));
    let verbose = Workplace::new().run(&["info", series, "-v"]);
    assert!(
        verbose.stderr.contains("dicom_object"),
        "{}",
        verbose.stderr
    );
}

#[test]
fn devices_are_listed() {
    let place = Workplace::new();
    let devices: Value = serde_json::from_str(&place.succeed(&["devices", "--json"])).unwrap();
    let devices = devices.as_array().unwrap();
    assert!(!devices.is_empty());
    let listing = place.succeed(&["devices"]);
    for device in devices {
        assert!(listing.contains(device["name"].as_str().unwrap()));
        assert!(device["usable"] == true || device["reason"].is_string());
    }
}

/// Every key that scripts rely on.
fn assert_stats(stats: &Value) {
    for pointer in [
        "/device/name",
        "/device/driver",
        "/device/type",
        "/image/size",
        "/frame_ms",
        "/passes/0/name",
        "/passes/0/gpu_ms",
        "/lao/rays",
        "/lao/ms_per_ray",
        "/lao/voxels",
        "/samples/taken",
        "/samples/per_pixel_mean",
        "/blocks/total",
        "/blocks/resident",
        "/blocks/by_level",
        "/data_reduction",
        "/memory/device_bytes",
        "/memory/packed_cells_bytes",
        "/memory/gradients_bytes",
        "/memory/host_peak_bytes",
    ] {
        assert!(
            stats.pointer(pointer).is_some_and(|v| !v.is_null()),
            "{pointer} in {stats}"
        );
    }
    assert_eq!(stats["image"]["size"], json!([24, 16]));
    assert_eq!(stats["lao"]["rays"], 4);
    // 20 x 18 x 16 voxels make 2 x 2 x 1 blocks.
    assert_eq!(stats["blocks"]["total"], 4);
    assert!(stats["memory"]["host_peak_bytes"].as_u64().unwrap() > 20 * 18 * 16 * 2);
}

/// Size of a picture, and whether its middle shows the ball and its corner the background.
fn assert_shows_ball(path: &Path, size: [u32; 2], background: [u8; 3]) {
    let picture = image::open(path).unwrap().to_rgb8();
    assert_eq!(picture.dimensions(), size.into());
    assert_eq!(picture.get_pixel(0, 0).0, background);
    let middle = picture.get_pixel(size[0] / 2, size[1] / 2).0;
    assert!(middle.iter().all(|&c| c > 30), "{middle:?}");
}

#[test]
fn scenes_render_to_every_output_at_once() {
    let place = Workplace::new();
    let stdout = place.succeed(&[
        "render",
        "scene.json",
        "-o",
        "a.png",
        "-o",
        "b.exr",
        "--stats",
        "stats.json",
    ]);
    assert_eq!(stdout, "");
    assert_eq!(
        place.names(),
        [
            "a.png",
            "b.exr",
            "ball.nrrd",
            "ball.raw",
            "scene.json",
            "stats.json"
        ]
    );
    assert_shows_ball(&place.path("a.png"), [24, 16], [0; 3]);
    assert!(
        fs::read(place.path("b.exr"))
            .unwrap()
            .starts_with(&[0x76, 0x2f, 0x31, 0x01])
    );
    let stats = place.json("stats.json");
    assert_stats(&stats);
    assert!(stats["samples"]["taken"].as_u64().unwrap() > 0);
}

#[test]
fn volumes_render_without_a_scene() {
    let place = Workplace::new();
    let args = [
        "render",
        "ball.nrrd",
        "-o",
        "a.png",
        "--set",
        "image.size=[24,16]",
    ];
    place.succeed(&args);
    assert_shows_ball(&place.path("a.png"), [24, 16], [23, 26, 31]);
}

#[test]
fn number_patterns_show_the_light_refine() {
    let place = Workplace::new();
    place.succeed(&[
        "render",
        "scene.json",
        "-o",
        "frame_%04d.png",
        "-o",
        "final.png",
    ]);
    let pictures: Vec<_> = place
        .names()
        .into_iter()
        .filter(|n| n.ends_with(".png"))
        .collect();
    assert_eq!(
        pictures,
        [
            "final.png",
            "frame_0000.png",
            "frame_0001.png",
            "frame_0002.png",
            "frame_0003.png"
        ]
    );
    let pixels = |name: &str| image::open(place.path(name)).unwrap().to_rgb8();
    assert_eq!(pixels("frame_0003.png"), pixels("final.png"));
    assert_ne!(pixels("frame_0000.png"), pixels("final.png"));
    let unlit = Workplace::new();
    unlit.succeed(&[
        "render",
        "scene.json",
        "-o",
        "f%d.png",
        "--set",
        "ambient_occlusion=null",
    ]);
    assert!(unlit.names().contains(&"f0.png".to_owned()));
    assert!(!unlit.names().contains(&"f1.png".to_owned()));
}

#[test]
fn data_files_of_the_input_are_not_overwritten() {
    let place = Workplace::new();
    let header = "NRRD0004\ntype: int16\ndimension: 3\nsizes: 20 18 16\nendian: little\nencoding: raw\ndata file: data.nrrd\n";
    fs::write(place.path("ball.nhdr"), header).unwrap();
    fs::copy(place.path("ball.raw"), place.path("data.nrrd")).unwrap();
    let message = place.refuse(&["light", "ball.nhdr", "-o", "data.nrrd"]);
    assert_eq!(message, "data.nrrd: is also an input; give another file");
    let voxels = fs::read(place.path("ball.raw")).unwrap();
    assert_eq!(fs::read(place.path("data.nrrd")).unwrap(), voxels);
}

#[test]
fn tiles_change_no_pixel() {
    let place = Workplace::new();
    place.succeed(&["render", "scene.json", "-o", "a.exr"]);
    place.succeed(&[
        "render",
        "scene.json",
        "-o",
        "b.exr",
        "--tile",
        "7",
        "--no-pipeline-cache",
    ]);
    assert!(fs::read(place.path("a.exr")).unwrap() == fs::read(place.path("b.exr")).unwrap());
    place.succeed(&[
        "render",
        "scene.json",
        "-o",
        "c.exr",
        "--tile",
        "4294967295",
    ]);
    assert!(fs::read(place.path("a.exr")).unwrap() == fs::read(place.path("c.exr")).unwrap());
}

#[test]
fn light_is_exported_on_the_full_grid() {
    let place = Workplace::new();
    place.succeed(&["light", "scene.json", "-o", "light.nrrd"]);
    let bytes = fs::read(place.path("light.nrrd")).unwrap();
    let end = bytes.windows(2).position(|w| w == b"\n\n").unwrap();
    let header = std::str::from_utf8(&bytes[..end]).unwrap();
    for line in [
        "type: float",
        "sizes: 4 20 18 16",
        "space: left-posterior-superior",
        "space directions: none (1,0,0) (0,1,0) (0,0,1.5)",
        "space origin: (0,0,0)",
        "encoding: raw",
    ] {
        assert!(header.lines().any(|l| l == line), "{line} in {header}");
    }
    let light: Vec<f32> = bytes[end + 2..]
        .chunks_exact(4)
        .map(|b| f32::from_le_bytes(b.try_into().unwrap()))
        .collect();
    assert_eq!(light.len(), 4 * 20 * 18 * 16);
    let voxel = |i: usize, j: usize, k: usize| {
        let at = 4 * (i + 20 * (j + 18 * k));
        &light[at..at + 4]
    };
    let [middle, edge] = [voxel(10, 9, 8), voxel(10, 3, 8)];
    assert_eq!([middle[3], edge[3]], [1.0, 1.0]);
    assert!(
        middle[0] < edge[0],
        "{middle:?} is not darker than {edge:?}"
    );
}

#[test]
fn probe_answers_at_world_points_and_refuses_others() {
    let place = Workplace::new();
    let at = |world: &str| place.succeed(&["probe", "ball.nrrd", "--world", world, "--json"]);
    // The middle of the ball, and a corner of the field.
    let middle: Value = serde_json::from_str(&at("10,9,12")).unwrap();
    assert_eq!(middle["value"], 1000.0, "{middle}");
    let corner: Value = serde_json::from_str(&at("0,0,0")).unwrap();
    assert_eq!(corner["value"], -1000.0, "{corner}");
    let message = place.refuse(&["probe", "ball.nrrd", "--world", "1,2"]);
    assert!(message.contains("world"), "{message}");
}

#[test]
fn formats_are_listed() {
    let place = Workplace::new();
    let formats: Value = serde_json::from_str(&place.succeed(&["formats", "--json"])).unwrap();
    let names = formats.to_string();
    for name in ["NRRD", "NIfTI", "MetaImage", "DICOM", "OpenVDB", "OME-Zarr"] {
        assert!(names.contains(name), "{names}");
    }
}
