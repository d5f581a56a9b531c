//! Files that are cut short.

use super::seeds::{self, Seed};
use super::{Scratch, judge};

/// A file of at most so many bytes is cut at every length, a larger one at hundreds.
const SMALL: usize = 400;

/// A cut file is refused, or read as the whole one where what is gone says nothing of this volume: padding, another
/// channel, another time.
#[test]
fn cut_anywhere() {
    let scratch = Scratch::new();
    let (mut cuts, mut read) = (0, 0);
    for seed in seeds::all() {
        let path = seed.write(&scratch);
        let options = seed.options();
        let whole = judge(&path, &options, "whole").unwrap_or_else(|e| panic!("{e}"));
        for (name, bytes) in &seed.files {
            let file = path.with_file_name(name);
            let step = if bytes.len() <= SMALL {
                1
            } else {
                bytes.len() / 200
            };
            for len in (0..bytes.len()).step_by(step) {
                std::fs::write(&file, &bytes[..len]).unwrap();
                cuts += 1;
                if let Ok(volume) = judge(&path, &options, &format!("{name} cut to {len}")) {
                    assert_eq!(volume.voxels(), whole.voxels(), "{name} cut to {len}");
                    let blank = bytes[len..].iter().all(u8::is_ascii_whitespace);
                    assert!(blank || has_tail(&seed), "{name} was read, cut to {len}");
                    read += 1;
                }
            }
            std::fs::write(&file, bytes).unwrap();
        }
    }
    println!("{cuts} cuts, {read} of padding or of what was not asked for");
    assert!(cuts > 8_000 && read < cuts / 20);
}

/// Archives, FITS and TIFF files, and those of several volumes end in what a reader need not have.
fn has_tail(seed: &Seed) -> bool {
    let endings = [".fits", ".tif", ".gz", ".xz", ".vti"];
    endings.iter().any(|ending| seed.name().ends_with(ending))
}
