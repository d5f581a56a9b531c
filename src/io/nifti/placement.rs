//! Where a NIfTI grid lies in the world: `sform`, else `qform`, else the voxel sizes alone.

use glam::{DAffine3, DQuat, DVec3, DVec4};

use super::header::Header;
use crate::error::Result;
use crate::io::grid;

/// LPS from RAS.
const LPS_FROM_RAS: DVec3 = DVec3::new(-1.0, -1.0, 1.0);

/// Below this a rotation is taken as one by 180 degrees, whose real part is lost to rounding.
const MIN_REAL_PART_SQUARED: f64 = 1e-7;

/// World (mm, LPS) from voxel index.
pub(super) fn world_from_ix(header: &Header) -> Result<DAffine3> {
    let (qform_code, sform_code) = header.form_codes();
    let (keys, steps, origin, lps_from_form) = if sform_code > 0 {
        let rows = header.affine_rows().map(DVec4::from_array);
        let steps = [rows.map(|r| r.x), rows.map(|r| r.y), rows.map(|r| r.z)];
        let origin = DVec3::from_array(rows.map(|r| r.w));
        let steps = steps.map(DVec3::from_array);
        ("srow_x, srow_y, srow_z", steps, origin, LPS_FROM_RAS)
    } else if qform_code > 0 {
        let (steps, origin) = qform(header)?;
        let keys = "quatern_b, quatern_c, quatern_d, qoffset";
        (keys, steps, origin, LPS_FROM_RAS)
    } else {
        // Method 1 attaches no orientation to the axes, so there is nothing to turn; ITK does the same.
        let spacing = grid::positive_spacing(header.path(), "pixdim", header.spacing())?;
        let [x, y, z] = DVec3::AXES;
        let steps = [x * spacing.x, y * spacing.y, z * spacing.z];
        ("pixdim", steps, DVec3::ZERO, DVec3::ONE)
    };
    let mm = match header.space_unit() {
        1 => 1000.0,
        3 => 1e-3,
        _ => 1.0,
    };
    let lps = lps_from_form * mm;
    grid::placement(
        header.path(),
        keys,
        steps.map(|step| step * lps),
        origin * lps,
    )
}

/// Method 2 of `nifti1.h`: a rotation, voxel sizes, and a handedness.
fn qform(header: &Header) -> Result<([DVec3; 3], DVec3)> {
    let spacing = grid::positive_spacing(header.path(), "pixdim", header.spacing())?;
    let imaginary = DVec3::from_array(header.quaternion());
    if !imaginary.is_finite() {
        return Err(header.bad(format!(
            "quatern_b, quatern_c, quatern_d {imaginary}: finite numbers are needed"
        )));
    }
    let real_squared = 1.0 - imaginary.length_squared();
    let rotation = if real_squared < MIN_REAL_PART_SQUARED {
        let unit = imaginary.normalize_or_zero();
        DQuat::from_xyzw(unit.x, unit.y, unit.z, 0.0)
    } else {
        DQuat::from_xyzw(imaginary.x, imaginary.y, imaginary.z, real_squared.sqrt())
    };
    let handedness = if header.qfac() < 0.0 { -1.0 } else { 1.0 };
    let steps = [
        rotation * DVec3::X * spacing.x,
        rotation * DVec3::Y * spacing.y,
        rotation * DVec3::Z * spacing.z * handedness,
    ];
    Ok((steps, DVec3::from_array(header.quaternion_offset())))
}
