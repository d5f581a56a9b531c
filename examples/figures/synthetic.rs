//! A volume of simple solids on a slab: flat faces, sharp corners, smooth curves, deep hollows, and layers below the
//! surface that a transfer function can make visible or let glow.

use std::path::Path;

use glam::DVec3;
use umbravox::{Result, output};

/// Voxels of 1 mm on x, y, z. x is to the right of a viewer in front, y away from him, z up.
const SIZE: [u32; 3] = [160, 128, 84];

/// Values. The layer has the highest one, so that no border between others passes through it.
const STONE: f64 = 110.0;
const LAYER: f64 = 240.0;
/// Width of a border, voxels: as a scanner blurs it, and wide enough for a smooth gradient.
const BORDER: f64 = 2.0;

/// Top of the slab.
const FLOOR: f64 = 14.0;

/// Writes the volume as NRRD, 8 bits a voxel.
///
/// # Errors
/// [`umbravox::Error::Io`].
pub(crate) fn write(path: &Path) -> Result<()> {
    let [nx, ny, nz] = SIZE;
    let header = format!(
        "NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\nsizes: {nx} {ny} {nz}\n\
         space directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)\nencoding: raw\n\n"
    );
    let mut bytes = header.into_bytes();
    for z in 0..nz {
        for y in 0..ny {
            for x in 0..nx {
                let p = DVec3::from_array([x, y, z].map(f64::from));
                bytes.push(value(p).round() as u8);
            }
        }
    }
    output::write_bytes(path, &bytes)
}

/// What later bodies leave of the value before them: `inside` of 1 replaces it.
fn over(below: f64, inside: f64, value: f64) -> f64 {
    below + (value - below) * inside
}

/// Share of a voxel inside a body, from its signed distance (negative inside), voxels.
fn coverage(distance: f64) -> f64 {
    (0.5 - distance / BORDER).clamp(0.0, 1.0)
}

fn value(p: DVec3) -> f64 {
    let mut v = over(0.0, coverage(slab(p)), STONE);
    v = over(v, coverage(stairs(p)), STONE);
    v = over(v, coverage(torus(p)), STONE);
    v = tower(p, v);
    v = cut_sphere(p, v);
    bowl(p, v)
}

/// Signed distance to a box between two corners.
fn cuboid(p: DVec3, low: [f64; 3], high: [f64; 3]) -> f64 {
    let (low, high) = (DVec3::from_array(low), DVec3::from_array(high));
    let outside = (low - p).max(p - high);
    outside.max(DVec3::ZERO).length() + outside.max_element().min(0.0)
}

/// A slab with a groove across its front.
fn slab(p: DVec3) -> f64 {
    let slab = cuboid(p, [5.0, 5.0, 5.0], [154.0, 122.0, FLOOR]);
    let groove = cuboid(p, [14.0, 12.0, 9.0], [146.0, 17.0, FLOOR + 9.0]);
    slab.max(-groove)
}

/// Four steps up to the left.
fn stairs(p: DVec3) -> f64 {
    (0..4)
        .map(|step| {
            let right = 64.0 - 14.0 * f64::from(step);
            let top = FLOOR + 11.0 * f64::from(step + 1);
            cuboid(p, [12.0, 84.0, FLOOR - 2.0], [right, 116.0, top])
        })
        .fold(f64::INFINITY, f64::min)
}

/// A ring that lies on the slab.
fn torus(p: DVec3) -> f64 {
    let q = p - DVec3::new(36.0, 48.0, FLOOR + 6.0);
    let from_ring = q.truncate().length() - 18.0;
    from_ring.hypot(q.z) - 6.5
}

/// A tower with an alcove, in whose back wall the layer lies, and with a band of the layer under its surface.
fn tower(p: DVec3, below: f64) -> f64 {
    let (low, high) = ([104.0, 84.0, FLOOR - 2.0], [148.0, 116.0, 70.0]);
    let body = cuboid(p, low, high);
    let alcove = cuboid(p, [114.0, 80.0, FLOOR + 6.0], [138.0, 102.0, 50.0]);
    let band = cuboid(p, [107.0, 87.0, 57.0], [145.0, 113.0, 62.0]);
    let lamp = cuboid(p, [118.0, 101.0, FLOOR + 10.0], [134.0, 106.0, 46.0]);
    let mut v = over(below, coverage(body.max(-alcove)), STONE);
    v = over(v, coverage(band), LAYER);
    over(v, coverage(lamp), LAYER)
}

/// A sphere of shells, open towards the viewer.
fn cut_sphere(p: DVec3, below: f64) -> f64 {
    let center = DVec3::new(82.0, 58.0, FLOOR + 21.0);
    let q = p - center;
    let sphere = |radius: f64| q.length() - radius;
    let cut = cuboid(q, [0.0, -40.0, 0.0], [40.0, 0.0, 40.0]);
    let part = |distance: f64| coverage(distance.max(-cut));
    let mut v = over(below, part(sphere(22.0)), STONE);
    v = over(v, part(sphere(18.0)), LAYER);
    over(v, part(sphere(12.0)), STONE)
}

/// A bowl with a drop of the layer at the bottom.
fn bowl(p: DVec3, below: f64) -> f64 {
    let center = DVec3::new(126.0, 44.0, FLOOR + 21.0);
    let q = p - center;
    let half = (q.length() - 21.0).max(q.z);
    let hollow = q.length() - 16.0;
    let drop = p.distance(center - DVec3::Z * 13.0) - 7.0;
    let v = over(below, coverage(half.max(-hollow)), STONE);
    over(v, coverage(drop), LAYER)
}
