//! Procedural scalar fields over the unit cube, with values in [0,1], and volumes sampled from them.

use glam::{DAffine3, DVec3};
use umbravox::volume::{Rescale, Volume, VoxelType, Voxels};

pub(crate) use umbravox::conformance::synthetic::placed;

/// A few soft spheres; nearly 0 on the border.
pub(crate) fn blobs(p: DVec3) -> f64 {
    const BLOBS: [([f64; 3], f64, f64); 5] = [
        ([0.35, 0.40, 0.45], 0.14, 1.0),
        ([0.65, 0.55, 0.35], 0.11, 0.8),
        ([0.50, 0.65, 0.70], 0.12, 0.9),
        ([0.60, 0.30, 0.65], 0.08, 0.7),
        ([0.35, 0.70, 0.30], 0.09, 0.6),
    ];
    BLOBS
        .iter()
        .map(|&(center, width, height)| {
            let r = p.distance(DVec3::from_array(center)) / width;
            height * (-0.5 * r * r).exp()
        })
        .sum::<f64>()
        .min(1.0)
}

/// 1 in the middle of the cube, falling linearly with the distance to 0 in its corners.
pub(crate) fn radial(p: DVec3) -> f64 {
    1.0 - (2.0 * p - 1.0).length() / 3f64.sqrt()
}

/// The test signal of Marschner and Lobb (1994) with `f_M = 6`, `alpha = 0.25`, over `[-1,1]^3`.
pub(crate) fn marschner_lobb(p: DVec3) -> f64 {
    use std::f64::consts::PI;
    const FREQUENCY: f64 = 6.0;
    const ALPHA: f64 = 0.25;
    let q = 2.0 * p - 1.0;
    let ripple = (2.0 * PI * FREQUENCY * (0.5 * PI * q.truncate().length()).cos()).cos();
    (1.0 - (0.5 * PI * q.z).sin() + ALPHA * (1.0 + ripple)) / (2.0 * (1.0 + ALPHA))
}

/// Smooth random values between the nodes of a lattice of `cells` cells on each axis.
pub(crate) fn value_noise(p: DVec3, cells: f64, seed: u32) -> f64 {
    let q = p * cells;
    let cell = q.floor();
    let f = q - cell;
    let s = f * f * (3.0 - 2.0 * f);
    let corner = |i: u32| DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2));
    (0..8)
        .map(|i| {
            let c = corner(i);
            let weight = (1.0 - c - s + 2.0 * c * s).element_product();
            weight * hash(cell + c, seed)
        })
        .sum()
}

/// A number in [0,1) for a lattice node.
fn hash(node: DVec3, seed: u32) -> f64 {
    let mut h = seed ^ 0x9e37_79b9;
    for x in node.to_array() {
        h = (h ^ (x as i32 as u32)).wrapping_mul(0x85eb_ca6b);
        h = (h ^ (h >> 15)).wrapping_mul(0xc2b2_ae35);
        h ^= h >> 13;
    }
    f64::from(h) / 2f64.powi(32)
}

/// Linear along a direction, 0 and 1 in the corners where it is smallest and largest.
pub(crate) fn ramp(p: DVec3, direction: DVec3) -> f64 {
    let lowest = direction.min(DVec3::ZERO).element_sum();
    let highest = direction.max(DVec3::ZERO).element_sum();
    (p.dot(direction) - lowest) / (highest - lowest)
}

/// 0 and 1 in turn from voxel to voxel.
pub(crate) fn checker(p: DVec3, size: [u32; 3]) -> f64 {
    let voxel = (p * (DVec3::from_array(size.map(f64::from)) - 1.0)).round();
    voxel.element_sum() % 2.0
}

/// Samples a field of the unit cube at every voxel; 0 and 1 are stored as `stored[0]` and `stored[1]`,
/// integers rounded.
pub(crate) fn sampled(
    voxel_type: VoxelType,
    size: [u32; 3],
    world_from_ix: DAffine3,
    rescale: Rescale,
    stored: [f64; 2],
    field: impl Fn(DVec3) -> f64,
) -> Volume {
    let last = DVec3::from_array(size.map(f64::from)) - 1.0;
    let [nx, ny, nz] = size;
    let values = (0..nz).flat_map(|k| (0..ny).flat_map(move |j| (0..nx).map(move |i| [i, j, k])));
    let values = values.map(|ix| {
        let value = field(DVec3::from_array(ix.map(f64::from)) / last);
        stored[0] + (stored[1] - stored[0]) * value
    });
    let voxels = match voxel_type {
        VoxelType::U8 => Voxels::U8(values.map(|v| v.round() as u8).collect()),
        VoxelType::I8 => Voxels::I8(values.map(|v| v.round() as i8).collect()),
        VoxelType::U16 => Voxels::U16(values.map(|v| v.round() as u16).collect()),
        VoxelType::I16 => Voxels::I16(values.map(|v| v.round() as i16).collect()),
        VoxelType::F32 => Voxels::F32(values.map(|v| v as f32).collect()),
    };
    Volume::new(voxels, size, world_from_ix, rescale).expect("test volumes are valid")
}
