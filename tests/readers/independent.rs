//! Files that other libraries wrote, see `tests/data/generate`: every voxel, and where it lies.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use glam::DVec3;
use serde_json::Value;
use umbravox::io::{ReadOptions, read};
use umbravox::scene::VolumeSource;

use super::{Scratch, assert_placed, assert_refused};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/formats")
}

fn expected() -> BTreeMap<String, Vec<Value>> {
    let files = std::fs::read_dir(folder())
        .unwrap()
        .map(|entry| entry.unwrap().path());
    let lists = files.filter(|path| path.extension().is_some_and(|e| e == "json"));
    let mut all = BTreeMap::new();
    for list in lists {
        let text = std::fs::read_to_string(list).unwrap();
        let list: BTreeMap<String, Vec<Value>> = serde_json::from_str(&text).unwrap();
        all.extend(list);
    }
    all
}

fn numbers(value: &Value) -> Vec<f64> {
    let all = value.as_array().unwrap().iter();
    all.map(|n| n.as_f64().unwrap()).collect()
}

fn vector(value: &Value) -> [f64; 3] {
    numbers(value).try_into().unwrap()
}

/// What a scene would say of this case.
fn options(case: &Value) -> ReadOptions<'static> {
    let key = |name: &str| case.get(name).map(|v| v.as_u64().unwrap() as u32);
    let source = VolumeSource {
        timestep: key("timestep"),
        channel: key("channel"),
        level: key("level"),
        series: case.get("series").map(|v| v.as_str().unwrap().to_owned()),
        ..VolumeSource::default()
    };
    ReadOptions::from(&source)
}

#[test]
fn every_voxel_and_its_place() {
    let all = expected();
    assert!(all.len() >= 60, "{} files", all.len());
    for (name, cases) in all {
        for case in cases {
            let path = folder().join(&name);
            let volume =
                read(&path, &options(&case)).unwrap_or_else(|e| panic!("{name} {case:.80}: {e}"));
            let size: Vec<f64> = volume.size().iter().map(|&n| n.into()).collect();
            assert_eq!(size, numbers(&case["size"]), "{name}");
            let steps = case["steps"].as_array().unwrap();
            let steps = [0, 1, 2].map(|i| vector(&steps[i]));
            assert_placed(&volume, steps, vector(&case["origin"]), 1e-7);
            for (i, value) in numbers(&case["values"]).into_iter().enumerate() {
                let read = volume.value_from_stored(volume.voxels().get(i));
                assert!(
                    (read - value).abs() <= value.abs() * 1e-6,
                    "{name}, voxel {i}: {read} is not {value}"
                );
            }
        }
    }
}

/// A probe at the world place of a voxel gives its value, between two the mean; outside there is none.
#[test]
fn the_world_place_of_a_voxel_has_its_value() {
    let volume = read(&folder().join("ct_oblique.tar.gz"), &ReadOptions::default()).unwrap();
    let ix_from_world = volume.world_from_ix().inverse();
    let at = |i: f64, j: f64, k: f64| {
        let world = volume.world_from_ix().transform_point3(DVec3::new(i, j, k));
        volume.sample(ix_from_world.transform_point3(world))
    };
    let near = |a: Option<f64>, b: f64| assert!((a.unwrap() - b).abs() < 1e-6, "{a:?} {b}");
    near(at(3.0, 4.0, 2.0), volume.value(3, 4, 2));
    near(at(6.0, 5.0, 4.0), volume.value(6, 5, 4));
    let middle = (volume.value(3, 4, 2) + volume.value(3, 4, 3)) / 2.0;
    near(at(3.0, 4.0, 2.5), middle);
    assert_eq!(at(6.1, 5.0, 4.0), None);
    assert_eq!(at(-0.1, 0.0, 0.0), None);
}

fn strict() -> ReadOptions<'static> {
    ReadOptions {
        strict: true,
        ..ReadOptions::default()
    }
}

#[test]
fn strict_refuses_what_would_be_guessed() {
    let missing = folder().join("missing.zip");
    assert_refused(
        &missing,
        &strict(),
        &["1 of 5 slices are missing", "strict"],
    );
    assert_refused(&folder().join("gray8_png.zip"), &strict(), &["strict"]);
    read(&folder().join("ct_oblique.tar.gz"), &strict()).unwrap();
}

#[test]
fn series_and_steps_that_are_not_there() {
    let oblique = folder().join("ct_oblique.tar.gz");
    let called = |name: &str| ReadOptions {
        series: Some(name.into()),
        ..ReadOptions::default()
    };
    for name in ["1.2.3", "4", "Series 1.2.3"] {
        assert_eq!(read(&oblique, &called(name)).unwrap().size(), [7, 6, 5]);
    }
    assert_refused(
        &oblique,
        &called("7"),
        &["volume.series", "1.2.3", "1.2.9", "4 x 4 x 1"],
    );
    assert_refused(&oblique, &called("9"), &["at least 2"]);
    let third = ReadOptions {
        timestep: Some(2),
        ..ReadOptions::default()
    };
    assert_refused(
        &folder().join("two_times.zip"),
        &third,
        &["volume.timestep 2", "0 to 1"],
    );
    assert_refused(
        &folder().join("four.npz"),
        &third,
        &["volume.timestep 2", "2 volumes"],
    );
    let fourth = ReadOptions {
        channel: Some(3),
        ..ReadOptions::default()
    };
    assert_refused(
        &folder().join("rgb_png.zip"),
        &fourth,
        &["volume.channel 3", "3 channels"],
    );
}

/// A folder, and one file of it, are read as the archive of it is.
#[test]
fn folders_and_single_files() {
    let scratch = Scratch::new();
    let archive = std::fs::File::open(folder().join("rle.zip")).unwrap();
    let mut archive = zip::ZipArchive::new(archive).unwrap();
    archive.extract(scratch.0.path()).unwrap();
    scratch.file("notes.txt", b"not a picture");
    let from_archive = read(&folder().join("rle.zip"), &ReadOptions::default()).unwrap();
    for path in [scratch.0.path().to_owned(), scratch.0.path().join("3.dcm")] {
        let volume = read(&path, &strict()).unwrap();
        assert_eq!(volume.voxels(), from_archive.voxels());
        assert_eq!(volume.world_from_ix(), from_archive.world_from_ix());
    }
}
