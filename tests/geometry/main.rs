//! One field in every format and many orientations, written by the formats' own libraries (see
//! `tests/data/generate/geometry.py`): the same values at the same points of the world, and the same pictures.

mod pictures;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use glam::DVec3;
use serde::Deserialize;
use umbravox::io::{ReadOptions, read};
use umbravox::scene::RawDescription;
use umbravox::volume::Volume;

/// What the generator says of its files.
#[derive(Deserialize)]
struct Geometry {
    /// Points of the world (mm, LPS), and the value there, by set.
    probes: BTreeMap<String, Vec<[f64; 4]>>,
    /// Points a twentieth of a voxel outside of the field, by set.
    outside: BTreeMap<String, Vec<[f64; 3]>>,
    files: Vec<File>,
}

#[derive(Deserialize)]
struct File {
    file: String,
    /// The set of points that this file must answer.
    probes: String,
    /// What rounding in the header may change of a value, absolute.
    tolerance: f64,
    raw: Option<RawDescription>,
    /// Slices are uneven or missing.
    #[serde(default)]
    resampled: bool,
}

impl File {
    fn path(&self) -> PathBuf {
        folder().join(&self.file)
    }

    fn read(&self, strict: bool) -> umbravox::Result<Volume> {
        let options = ReadOptions {
            raw: self.raw.clone(),
            strict,
            ..ReadOptions::default()
        };
        read(&self.path(), &options)
    }

    fn volume(&self) -> Volume {
        self.read(false).unwrap_or_else(|e| panic!("{e}"))
    }
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/geometry")
}

fn geometry() -> Geometry {
    let text = std::fs::read_to_string(folder().join("geometry.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

/// What `umbravox probe` does.
fn value_at(volume: &Volume, world: [f64; 3]) -> Option<f64> {
    let ix_from_world = volume.world_from_ix().inverse();
    volume.sample(ix_from_world.transform_point3(DVec3::from_array(world)))
}

#[test]
fn every_file_answers_alike_at_points_of_the_world() {
    let geometry = geometry();
    assert!(geometry.files.len() > 150, "{}", geometry.files.len());
    let mut worst = BTreeMap::<&str, f64>::new();
    let mut complaints = Vec::new();
    for file in &geometry.files {
        let volume = file.volume();
        let mut largest = 0f64;
        for &[x, y, z, expected] in &geometry.probes[&file.probes] {
            match value_at(&volume, [x, y, z]) {
                Some(value) => largest = largest.max((value - expected).abs()),
                // Corners may lie outside by what the header rounds.
                None if file.tolerance > 1e-6 => {}
                None => complaints.push(format!("{}: nothing at {x} {y} {z}", file.file)),
            }
        }
        for &outside in &geometry.outside[&file.probes] {
            if let Some(value) = value_at(&volume, outside) {
                complaints.push(format!("{}: {value} outside, at {outside:?}", file.file));
            }
        }
        if largest > file.tolerance {
            complaints.push(format!("{}: wrong by {largest}", file.file));
        }
        let kind = file.file.split('/').next().unwrap_or_default();
        let entry = worst.entry(kind).or_default();
        *entry = entry.max(largest);
    }
    for (kind, difference) in worst {
        println!("{kind}: {difference:.2e}");
    }
    assert!(complaints.is_empty(), "\n{}", complaints.join("\n"));
}

/// Corners that a rounded header puts outside may be left out above, but not the points inside.
#[test]
fn points_inside_are_answered_by_every_file() {
    let geometry = geometry();
    for file in &geometry.files {
        let volume = file.volume();
        let points = &geometry.probes[&file.probes];
        assert_eq!(points.len(), 68, "8 corners and 60 points inside");
        for &[x, y, z, _] in &points[8..] {
            assert!(value_at(&volume, [x, y, z]).is_some(), "{}", file.file);
        }
    }
}

/// Interpolated slices, and pictures that say nothing of their spacing.
#[test]
fn strict_refuses_what_is_guessed_and_nothing_else() {
    for file in geometry().files {
        let guessed = file.resampled || file.file == "unoriented/png.zip";
        match file.read(true) {
            Ok(_) => assert!(!guessed, "{}", file.file),
            Err(error) => assert!(guessed && error.is_bad_input(), "{error}"),
        }
    }
}

fn probe(file: &Path, world: [f64; 3]) -> Output {
    let [x, y, z] = world;
    Command::new(env!("CARGO_BIN_EXE_umbravox"))
        .arg("probe")
        .arg(file)
        .args(["--json", &format!("--world={x},{y},{z}")])
        .output()
        .unwrap()
}

#[test]
fn the_program_answers_as_the_library() {
    let geometry = geometry();
    for name in ["dicom/reversed.tar.xz", "metaimage/detached.mhd"] {
        let file = geometry.files.iter().find(|f| f.file == name).unwrap();
        for &[x, y, z, expected] in geometry.probes[&file.probes].iter().skip(10).take(4) {
            let output = probe(&file.path(), [x, y, z]);
            assert!(output.status.success(), "{output:?}");
            let said: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
            let value = said["value"].as_f64().unwrap();
            assert!(
                (value - expected).abs() <= file.tolerance,
                "{value} is not {expected}"
            );
        }
        let output = probe(&file.path(), geometry.outside[&file.probes][0]);
        assert_eq!(output.status.code(), Some(2));
    }
}
