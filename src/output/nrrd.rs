//! Light volumes as NRRD.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;

use glam::{DAffine3, DVec3};

use super::atomic;
use crate::error::{Error, Result};

/// Writes `rgba` (x fastest, then y, then z; `size` voxels) as a float NRRD with a first axis of four, in LPS.
///
/// # Errors
/// [`Error::Invalid`] when the count does not match `size`; [`Error::Io`], and the file is then not there (or as it
/// was before).
pub fn write_light(
    path: &Path,
    size: [u32; 3],
    rgba: &[[f32; 4]],
    world_from_ix: DAffine3,
) -> Result<()> {
    let count = size
        .iter()
        .try_fold(1usize, |n, &s| n.checked_mul(s as usize));
    if count != Some(rgba.len()) {
        return Err(Error::invalid(
            "light volume",
            format!("{size:?} does not match the {} voxels given", rgba.len()),
        ));
    }
    let header = header(size, world_from_ix);
    atomic::write(path, |file| {
        let io = |e| Error::io(path, e);
        file.write_all(header.as_bytes()).map_err(io)?;
        rgba.as_flattened()
            .iter()
            .try_for_each(|channel| file.write_all(&channel.to_le_bytes()))
            .map_err(io)
    })
}

fn header(size: [u32; 3], world_from_ix: DAffine3) -> String {
    let vector = |v: DVec3| format!("({},{},{})", v.x, v.y, v.z);
    let axes = world_from_ix.matrix3;
    let directions = [axes.x_axis, axes.y_axis, axes.z_axis]
        .map(vector)
        .join(" ");
    let [x, y, z] = size;
    let mut text = String::from("NRRD0005\n");
    let fields = [
        ("type", "float".into()),
        ("dimension", "4".into()),
        ("space", "left-posterior-superior".into()),
        ("sizes", format!("4 {x} {y} {z}")),
        ("space directions", format!("none {directions}")),
        ("kinds", "RGBA-color domain domain domain".into()),
        ("endian", "little".into()),
        ("encoding", "raw".into()),
        ("space origin", vector(world_from_ix.translation)),
        ("space units", "\"mm\" \"mm\" \"mm\"".into()),
    ];
    for (field, value) in fields {
        // Writing to a string does not fail.
        let _ = writeln!(text, "{field}: {value}");
    }
    text.push('\n');
    text
}
