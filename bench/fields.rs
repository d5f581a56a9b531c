//! The volumes that are measured: the same voxels on every machine.

use std::path::Path;
use std::sync::Arc;

use glam::DVec3;
use umbravox::Result;
use umbravox::io::{self, ReadOptions};
use umbravox::scene::{ControlPoint, TransferFunction};
use umbravox::volume::{Volume, Voxels};

/// A volume with what makes it visible.
pub(crate) struct Field {
    pub(crate) name: &'static str,
    /// What it stands for.
    pub(crate) about: &'static str,
    pub(crate) volume: Arc<Volume>,
    pub(crate) transfer_function: TransferFunction,
}

/// Every field; the procedural ones are cubes of `size` voxels of 1 mm.
///
/// # Errors
/// When the CT in `data/` cannot be read.
pub(crate) fn all(size: u32) -> Result<Vec<Field>> {
    Ok(vec![
        fog(size)?,
        sparse(size)?,
        blobs(size)?,
        shell(size)?,
        ct()?,
    ])
}

fn fog(size: u32) -> Result<Field> {
    Ok(Field {
        name: "fog",
        about: "thin everywhere: nothing to skip, no ray ends early",
        volume: cube(size, |p| 100.0 + 100.0 * p.element_sum() / 3.0)?,
        transfer_function: ramp([0.0, 255.0], [0.001, 0.004]),
    })
}

/// Spheres of a hundredth of the edge in radius, 334 of which fill 0.14 %.
fn sparse(size: u32) -> Result<Field> {
    const SPHERES: u32 = 334;
    const RADIUS: f64 = 0.01;
    let n = size as usize;
    let mut voxels = vec![0u8; n.pow(3)];
    let radius = RADIUS * f64::from(size);
    for sphere in 0..SPHERES {
        let unit = DVec3::from_array([0, 1, 2].map(|axis| hash([sphere, axis, 7])));
        let center = radius + unit * (f64::from(size - 1) - 2.0 * radius);
        let [low, high] = [center - radius, center + radius]
            .map(|corner| corner.round().as_uvec3().min(glam::UVec3::splat(size - 1)));
        for z in low.z..=high.z {
            for y in low.y..=high.y {
                for x in low.x..=high.x {
                    if glam::UVec3::new(x, y, z).as_dvec3().distance(center) <= radius {
                        voxels[x as usize + n * (y as usize + n * z as usize)] = 200;
                    }
                }
            }
        }
    }
    Ok(Field {
        name: "sparse",
        about: "small spheres in 0.14 % of the space: nearly all is skipped",
        volume: Arc::new(Volume::axis_aligned(
            Voxels::U8(voxels),
            [size; 3],
            [1.0; 3],
        )?),
        transfer_function: ramp([100.0, 200.0], [0.0, 0.6]),
    })
}

/// Smooth noise, opaque where it is highest. This noise exceeds 170/255 in a fifth of it.
fn blobs(size: u32) -> Result<Field> {
    Ok(Field {
        name: "blobs",
        about: "smooth bodies in 20 % of the space, opaque inside",
        volume: cube(size, |p| 255.0 * noise(p * 8.0))?,
        transfer_function: ramp([170.0, 210.0], [0.0, 0.5]),
    })
}

fn shell(size: u32) -> Result<Field> {
    let edge = f64::from(size - 1);
    let about_middle = move |p: DVec3| p.distance(DVec3::splat(0.5)) * edge;
    Ok(Field {
        name: "shell",
        about: "a hollow sphere one voxel thick",
        volume: cube(size, |p| {
            let distance = (about_middle(p) - 0.42 * edge).abs();
            255.0 * (1.0 - distance).max(0.0)
        })?,
        transfer_function: ramp([100.0, 255.0], [0.0, 0.3]),
    })
}

fn ct() -> Result<Field> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/ct_aorta_stent.mha");
    Ok(Field {
        name: "ct",
        about: "CT angiography of a chest, 120 x 126 x 164",
        volume: Arc::new(io::read(&path, &ReadOptions::default())?),
        transfer_function: TransferFunction {
            preset: Some("ct-bone".to_owned()),
            ..Default::default()
        },
    })
}

/// Opacities (over 1 mm) at two values, in ivory.
fn ramp(values: [f64; 2], opacities: [f64; 2]) -> TransferFunction {
    let point = |at: usize| ControlPoint {
        value: values[at],
        color: [0.95, 0.88, 0.76],
        opacity: opacities[at],
        emission: [0.0; 3],
        source: [0.0; 3],
    };
    TransferFunction {
        unit_distance: Some(1.0),
        points: Some(vec![point(0), point(1)]),
        ..Default::default()
    }
}

/// 8-bit voxels of a function of the unit cube.
fn cube(size: u32, value: impl Fn(DVec3) -> f64) -> Result<Arc<Volume>> {
    let last = f64::from(size - 1);
    let mut voxels = Vec::with_capacity((size as usize).pow(3));
    for z in 0..size {
        for y in 0..size {
            for x in 0..size {
                let p = glam::UVec3::new(x, y, z).as_dvec3() / last;
                voxels.push(value(p).round() as u8);
            }
        }
    }
    Volume::axis_aligned(Voxels::U8(voxels), [size; 3], [1.0; 3]).map(Arc::new)
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
