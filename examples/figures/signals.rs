//! Test signals as volumes: that of Marschner and Lobb, and distances from a centre.

use std::f64::consts::PI;
use std::path::Path;

use glam::DVec3;
use umbravox::{Result, output};

/// Where `examples/marschner_lobb.json` and `examples/shells.json` expect them.
pub(crate) const MARSCHNER_LOBB: &str = "out/marschner_lobb.nrrd";
pub(crate) const RADIAL: &str = "out/radial.nrrd";

/// Writes both.
///
/// # Errors
/// [`umbravox::Error::Io`].
pub(crate) fn write() -> Result<()> {
    write_cube(Path::new(MARSCHNER_LOBB), 41, marschner_lobb)?;
    write_cube(Path::new(RADIAL), 64, |p| 31.5 * p.length())
}

/// "An evaluation of reconstruction filters for volume rendering" (1994), eq. 8, with `f_M = 6` and `alpha = 0.25`.
fn marschner_lobb(p: DVec3) -> f64 {
    const FREQUENCY: f64 = 6.0;
    const ALPHA: f64 = 0.25;
    let ripple = (2.0 * PI * FREQUENCY * (0.5 * PI * p.truncate().length()).cos()).cos();
    (1.0 - (0.5 * PI * p.z).sin() + ALPHA * (1.0 + ripple)) / (2.0 * (1.0 + ALPHA))
}

/// Samples a field over `[-1, 1]^3` as NRRD, 32-bit floats, 1 mm apart.
fn write_cube(path: &Path, n: u32, field: impl Fn(DVec3) -> f64) -> Result<()> {
    let header = format!(
        "NRRD0004\ntype: float\ndimension: 3\nspace: left-posterior-superior\nsizes: {n} {n} {n}\n\
         space directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)\nendian: little\nencoding: raw\n\n"
    );
    let mut bytes = header.into_bytes();
    let at = |i: u32| 2.0 * f64::from(i) / f64::from(n - 1) - 1.0;
    for z in 0..n {
        for y in 0..n {
            for x in 0..n {
                let value = field(DVec3::new(at(x), at(y), at(z))) as f32;
                bytes.extend(value.to_le_bytes());
            }
        }
    }
    output::write_bytes(path, &bytes)
}
