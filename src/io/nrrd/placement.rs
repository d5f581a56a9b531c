//! Where an NRRD grid lies in the world.

use glam::{DAffine3, DVec3};

use super::header::Header;
use crate::error::Result;
use crate::io::units::millimetres;
use crate::io::{grid, text};

/// Signs that turn the axes of a `space` (section 4) into left, posterior, superior. Spaces that are not
/// anatomical are taken as they are.
const SPACES: &[(&str, DVec3)] = &[
    ("right-anterior-superior", DVec3::new(-1.0, -1.0, 1.0)),
    ("RAS", DVec3::new(-1.0, -1.0, 1.0)),
    ("left-anterior-superior", DVec3::new(1.0, -1.0, 1.0)),
    ("LAS", DVec3::new(1.0, -1.0, 1.0)),
    ("left-posterior-superior", DVec3::ONE),
    ("LPS", DVec3::ONE),
    ("scanner-xyz", DVec3::ONE),
    ("3D-right-handed", DVec3::ONE),
    ("3D-left-handed", DVec3::ONE),
];

/// World (mm, LPS) from voxel index: from `space directions`, else from `spacings`, else from `axis mins` and
/// `axis maxs`, else one millimetre per voxel.
///
/// The axes of space are three, the first of them is number `first`.
pub(super) fn world_from_ix(header: &Header, size: [u32; 3], first: usize) -> Result<DAffine3> {
    let path = header.path();
    let (keys, steps, axis_origin) = match header.get("space directions") {
        Some(directions) => (
            "space directions",
            oriented_steps(header, directions, first)?,
            DVec3::ZERO,
        ),
        None => aligned_steps(header, size, first)?,
    };
    let lps_from_space = match header.get("space") {
        Some(space) => text::one_of(path, "space", space, SPACES)?,
        None => DVec3::ONE,
    };
    let origin = match header.get("space origin") {
        Some(origin) => vectors(header, "space origin", origin)?
            .first()
            .copied()
            .flatten()
            .ok_or_else(|| header.bad(&format!("space origin: {origin:?} is not (x,y,z)")))?,
        None => axis_origin,
    };
    // Without `space directions` the index axes are not tied to the axes of the space.
    let oriented = header.get("space directions").is_some();
    let world_from_space = lps_from_space * unit_scale(header, "space units", 0)?;
    let steps = if oriented {
        steps.map(|step| step * world_from_space)
    } else {
        steps
    };
    let keys = format!("{keys} and space origin");
    grid::placement(path, &keys, steps, origin * world_from_space)
}

fn oriented_steps(header: &Header, directions: &str, first: usize) -> Result<[DVec3; 3]> {
    let path = header.path();
    if let Some(dimension) = header.get("space dimension") {
        text::one_of(path, "space dimension", dimension, &[("3", ())])?;
    }
    let all = vectors(header, "space directions", directions)?;
    let all = header.per_axis("space directions", all)?;
    match all.get(first..).unwrap_or_default() {
        &[Some(x), Some(y), Some(z), ..] => Ok([x, y, z]),
        _ => Err(header.bad(&format!(
            "space directions: {directions:?} must have vectors, not none, for the three axes of space"
        ))),
    }
}

/// Steps along the axes of the world, and the origin they come with.
fn aligned_steps(
    header: &Header,
    size: [u32; 3],
    first: usize,
) -> Result<(&'static str, [DVec3; 3], DVec3)> {
    let scale = unit_scale(header, "units", first)?;
    let along = |spacing: DVec3| {
        let [x, y, z] = DVec3::AXES;
        [x * spacing.x, y * spacing.y, z * spacing.z]
    };
    if let Some(spacing) = three_from(header, "spacings", first)? {
        return Ok(("spacings", along(spacing * scale), DVec3::ZERO));
    }
    let (Some(min), Some(max)) = (
        three_from(header, "axis mins", first)?,
        three_from(header, "axis maxs", first)?,
    ) else {
        return Ok(("spacings", along(scale), DVec3::ZERO));
    };
    // Minimum and maximum are the outer voxels' centres (node) or outer faces (cell); section 6, `centers`.
    let mut node = [0.0; 3];
    let centers = header.get("centers").unwrap_or_default();
    for (node, center) in node.iter_mut().zip(centers.split_whitespace().skip(first)) {
        *node = f64::from(u8::from(center.eq_ignore_ascii_case("node")));
    }
    let node = DVec3::from_array(node);
    let intervals = DVec3::from_array(size.map(f64::from)) - node;
    let before = (DVec3::ONE - node) * 0.5;
    let spacing = (max - min) / intervals;
    Ok((
        "axis mins and axis maxs",
        along(spacing * scale),
        (min + spacing * before) * scale,
    ))
}

/// The numbers of a per-axis field for the axes of space.
fn three_from(header: &Header, key: &str, first: usize) -> Result<Option<DVec3>> {
    let Some(field) = header.get(key) else {
        return Ok(None);
    };
    let all = header.per_axis(key, text::numbers(header.path(), key, field, "a number")?)?;
    Ok(all
        .get(first..)
        .and_then(<[f64]>::first_chunk::<3>)
        .map(|&first| DVec3::from_array(first)))
}

/// Millimetres per unit on each axis, from a field of quoted names.
fn unit_scale(header: &Header, key: &str, first: usize) -> Result<DVec3> {
    let mut scale = DVec3::ONE.to_array();
    let Some(field) = header.get(key) else {
        return Ok(DVec3::ONE);
    };
    let quoted: Vec<&str> = field.split('"').skip(1).step_by(2).skip(first).collect();
    if quoted.len() < 3 {
        return Err(header.bad(&format!(
            "{key}: {field:?} must have a quoted name for each axis"
        )));
    }
    for (scale, name) in scale.iter_mut().zip(quoted) {
        // Other units (pixels, for one) say nothing about size.
        *scale = millimetres(name).unwrap_or(1.0);
    }
    Ok(DVec3::from_array(scale))
}

/// A list of `(x,y,z)` and `none`.
fn vectors(header: &Header, key: &str, list: &str) -> Result<Vec<Option<DVec3>>> {
    let bad = || {
        header.bad(&format!(
            "{key}: {list:?} is not a list of vectors (x,y,z) of three numbers, or none"
        ))
    };
    let mut all = Vec::new();
    let mut rest = list.trim();
    while !rest.is_empty() {
        if let Some(after) = rest.strip_prefix("none") {
            all.push(None);
            rest = after.trim_start();
            continue;
        }
        let (inside, after) = rest
            .strip_prefix('(')
            .and_then(|r| r.split_once(')'))
            .ok_or_else(bad)?;
        let numbers: Result<Vec<f64>, _> = inside.split(',').map(|n| n.trim().parse()).collect();
        let vector: [f64; 3] = numbers.map_err(|_| bad())?.try_into().map_err(|_| bad())?;
        all.push(Some(DVec3::from_array(vector)));
        rest = after.trim_start();
    }
    Ok(all)
}
