//! A volume's fingerprint is that of what it holds.

use std::collections::HashSet;

use glam::{DAffine3, DVec3};
use umbravox::volume::{Rescale, Volume, Voxels};

const SIZE: [u32; 3] = [2, 2, 3];

fn fingerprint(voxels: Voxels, size: [u32; 3], moved: f64, slope: f64) -> String {
    let placement = DAffine3::from_translation(DVec3::new(0.0, moved, 0.0));
    let rescale = Rescale {
        slope,
        intercept: -1024.0,
    };
    Volume::new(voxels, size, placement, rescale)
        .unwrap()
        .fingerprint()
}

#[test]
fn equal_volumes_and_no_others_have_equal_fingerprints() {
    let voxels = || Voxels::I16((0..12).collect());
    let plain = fingerprint(voxels(), SIZE, 0.0, 1.0);
    assert_eq!(plain, fingerprint(voxels(), SIZE, 0.0, 1.0));
    let mut changed: Vec<i16> = (0..12).collect();
    changed[11] = 12;
    let others = [
        fingerprint(Voxels::I16(changed), SIZE, 0.0, 1.0),
        fingerprint(Voxels::U16((0..12).collect()), SIZE, 0.0, 1.0),
        fingerprint(Voxels::U8((0..12).collect()), SIZE, 0.0, 1.0),
        fingerprint(voxels(), [2, 3, 2], 0.0, 1.0),
        fingerprint(voxels(), SIZE, 1e-9, 1.0),
        fingerprint(voxels(), SIZE, 0.0, 2.0),
    ];
    let different: HashSet<&String> = others.iter().chain([&plain]).collect();
    assert_eq!(different.len(), 7);
}

/// SHA-256 of the bytes as the documentation lists them, by another implementation (Python's hashlib).
#[test]
fn a_fingerprint_is_what_it_says() {
    let found = fingerprint(Voxels::I16((0..12).collect()), SIZE, 0.5, 2.0);
    assert_eq!(
        found,
        "24bf5adf7683eb98261c563b2e029a3e1b20eafe4d8d5e9a56c9f182c9e0da1c"
    );
}
