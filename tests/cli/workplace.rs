//! A folder to run the program in.

use std::fs;
use std::process::Command;

use serde_json::{Value, json};
use tempfile::TempDir;

/// A folder with a small volume and a scene for it.
pub(crate) struct Workplace {
    pub(crate) folder: TempDir,
}

pub(crate) struct Outcome {
    pub(crate) status: i32,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

impl Workplace {
    /// A ball of bone in air, 20 x 18 x 16 voxels, with a scene of 24 x 16 pixels.
    pub(crate) fn new() -> Self {
        let place = Self {
            folder: tempfile::tempdir().unwrap(),
        };
        let size = [20i32, 18, 16];
        let mut voxels = Vec::new();
        for k in 0..size[2] {
            for j in 0..size[1] {
                for i in 0..size[0] {
                    let r2 = (i - 10).pow(2) + (j - 9).pow(2) + (k - 8).pow(2);
                    let value: i16 = if r2 < 36 { 1000 } else { -1000 };
                    voxels.extend(value.to_le_bytes());
                }
            }
        }
        fs::write(place.path("ball.raw"), &voxels).unwrap();
        let header = b"NRRD0004\ntype: int16\ndimension: 3\nsizes: 20 18 16\nspacings: 1 1 1.5\nendian: little\nencoding: raw\n\n";
        fs::write(
            place.path("ball.nrrd"),
            [header.as_slice(), &voxels].concat(),
        )
        .unwrap();
        let scene = json!({
            "volume": { "path": "ball.raw",
                        "raw": { "size": size, "type": "i16", "spacing": [1, 1, 1.5] } },
            "image": { "size": [24, 16] },
            "transfer_function": { "preset": "ct-bone" },
            "ambient_occlusion": { "rays": 4, "radius": 4 },
        });
        fs::write(place.path("scene.json"), scene.to_string()).unwrap();
        place
    }

    pub(crate) fn path(&self, name: &str) -> std::path::PathBuf {
        self.folder.path().join(name)
    }

    pub(crate) fn run(&self, args: &[&str]) -> Outcome {
        let output = Command::new(env!("CARGO_BIN_EXE_umbravox"))
            .args(args)
            .current_dir(self.folder.path())
            .output()
            .unwrap();
        Outcome {
            status: output.status.code().expect("not killed by a signal"),
            stdout: String::from_utf8(output.stdout).unwrap(),
            stderr: String::from_utf8(output.stderr).unwrap(),
        }
    }

    /// Runs what must succeed; returns stdout.
    pub(crate) fn succeed(&self, args: &[&str]) -> String {
        let outcome = self.run(args);
        assert_eq!(outcome.status, 0, "{args:?}: {}", outcome.stderr);
        outcome.stdout
    }

    /// Runs what must be refused with status 2, one line, and no file written; returns the line.
    pub(crate) fn refuse(&self, args: &[&str]) -> String {
        let before = self.names();
        let Outcome {
            status,
            stdout,
            stderr,
        } = self.run(args);
        assert_eq!(status, 2, "{args:?}: {stderr}");
        assert_eq!(stdout, "");
        assert_eq!(stderr.lines().count(), 1, "{stderr}");
        assert_eq!(self.names(), before, "{args:?} left something behind");
        let message = stderr.trim_end().strip_prefix("error: ");
        message.unwrap_or_else(|| panic!("{stderr}")).to_owned()
    }

    pub(crate) fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(self.folder.path()).unwrap();
        let mut names: Vec<_> = entries
            .map(|e| e.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    pub(crate) fn json(&self, name: &str) -> Value {
        serde_json::from_slice(&fs::read(self.path(name)).unwrap()).unwrap()
    }
}
