//! Volumes computed from their size alone.

use glam::{DVec3, UVec3};
use rayon::prelude::*;
use umbravox::Result;
use umbravox::volume::{Volume, Voxels};

pub(crate) fn fog(size: u32) -> Result<Volume> {
    cube(size, |p| 100.0 + 100.0 * p.element_sum() / 3.0)
}

/// Spheres of a hundredth of the edge in radius, 334 of which fill 0.14 %.
pub(crate) fn sparse(size: u32) -> Result<Volume> {
    const SPHERES: u32 = 334;
    const RADIUS: f64 = 0.01;
    let n = size as usize;
    let mut voxels = vec![0u8; n.pow(3)];
    let radius = RADIUS * f64::from(size);
    for sphere in 0..SPHERES {
        let unit = DVec3::from_array([0, 1, 2].map(|axis| hash([sphere, axis, 7])));
        let center = radius + unit * (f64::from(size - 1) - 2.0 * radius);
        let [low, high] = [center - radius, center + radius]
            .map(|corner| corner.round().as_uvec3().min(UVec3::splat(size - 1)));
        for z in low.z..=high.z {
            for y in low.y..=high.y {
                for x in low.x..=high.x {
                    if UVec3::new(x, y, z).as_dvec3().distance(center) <= radius {
                        voxels[x as usize + n * (y as usize + n * z as usize)] = 200;
                    }
                }
            }
        }
    }
    Volume::axis_aligned(Voxels::U8(voxels), [size; 3], [1.0; 3])
}

/// Smooth noise. It exceeds 170/255 in a fifth of the cube.
pub(crate) fn blobs(size: u32) -> Result<Volume> {
    cube(size, |p| 255.0 * noise(p * 8.0))
}

/// A hollow sphere that falls off within one voxel.
pub(crate) fn shell(size: u32) -> Result<Volume> {
    let edge = f64::from(size - 1);
    cube(size, move |p| {
        let radius = p.distance(DVec3::splat(0.5)) * edge;
        let distance = (radius - 0.42 * edge).abs();
        255.0 * (1.0 - distance).max(0.0)
    })
}

/// 8-bit voxels of a function of the unit cube.
fn cube(size: u32, value: impl Fn(DVec3) -> f64 + Sync) -> Result<Volume> {
    let last = f64::from(size - 1);
    let n = size as usize;
    let mut voxels = vec![0u8; n.pow(3)];
    let slices = voxels.par_chunks_mut(n * n).enumerate();
    slices.for_each(|(z, slice)| {
        for (at, voxel) in slice.iter_mut().enumerate() {
            let p = DVec3::new((at % n) as f64, (at / n) as f64, z as f64) / last;
            *voxel = value(p).round() as u8;
        }
    });
    Volume::axis_aligned(Voxels::U8(voxels), [size; 3], [1.0; 3])
}

/// Smooth random values in [0,1] between the nodes of the unit lattice.
fn noise(p: DVec3) -> f64 {
    let cell = p.floor();
    let f = p - cell;
    let s = f * f * (3.0 - 2.0 * f);
    let mut sum = 0.0;
    for corner in 0..8u32 {
        let bit = [0, 1, 2].map(|axis| corner >> axis & 1);
        let far = DVec3::from_array(bit.map(f64::from));
        let weight = (1.0 - far - s + 2.0 * far * s).element_product();
        let node = cell.as_uvec3();
        sum += weight * hash([node.x + bit[0], node.y + bit[1], node.z + bit[2]]);
    }
    sum
}

/// A number in [0,1) for three integers.
fn hash(key: [u32; 3]) -> f64 {
    let mut h = 0x9e37_79b9u32;
    for x in key {
        h = (h ^ x).wrapping_mul(0x85eb_ca6b);
        h = (h ^ (h >> 15)).wrapping_mul(0xc2b2_ae35);
        h ^= h >> 13;
    }
    f64::from(h) / 2f64.powi(32)
}
