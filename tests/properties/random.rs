//! Random scenes: small volumes, transfer functions, cameras, settings. Equal seeds give equal scenes.

use glam::DVec3;
use umbravox::scene::{
    AmbientOcclusion, Camera, Classification, ControlPoint, Gradient, Interpolation, Isosurface,
    RayProjection, RaySampling, Shading,
};
use umbravox::volume::{Rescale, Volume, VoxelType};

use crate::fields::{blobs, checker, marschner_lobb, placed, radial, ramp, sampled, value_noise};
use crate::sessions::{Subject, bounds, point};

/// Steele, Lea and Flood, "Fast splittable pseudorandom number generators" (2014): SplitMix64.
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed)
    }

    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// In `[0,1)`.
    pub(crate) fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / 2f64.powi(53)
    }

    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    pub(crate) fn pick<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[(self.bits() % choices.len() as u64) as usize]
    }

    pub(crate) fn chance(&mut self, share: f64) -> bool {
        self.unit() < share
    }

    pub(crate) fn direction(&mut self) -> DVec3 {
        let z = self.between(-1.0, 1.0);
        let turn = self.between(0.0, std::f64::consts::TAU);
        let r = (1.0 - z * z).sqrt();
        DVec3::new(r * turn.cos(), r * turn.sin(), z)
    }

    fn color(&mut self) -> [f64; 3] {
        [(); 3].map(|()| self.unit())
    }
}

fn volume(random: &mut Random) -> Volume {
    let voxel_type = random.pick(&VoxelType::ALL);
    // One block and several, whole and cut off.
    let size = [(); 3].map(|()| random.pick(&[2, 9, 16, 17, 18, 23, 33, 37]));
    let scale = 10f64.powf(random.between(-2.0, 2.0));
    let spacing = [(); 3].map(|()| scale * random.between(0.6, 1.8));
    let placement = if random.chance(0.3) {
        placed(spacing, [0.0, 0.0, 1.0], 0.0, [0.0; 3])
    } else {
        let axis = random.direction().to_array();
        let origin = [(); 3].map(|()| random.between(-50.0, 50.0));
        placed(spacing, axis, random.between(0.0, 360.0), origin)
    };
    let stored = match voxel_type {
        VoxelType::U8 => [0.0, 255.0],
        VoxelType::I8 => [-128.0, 127.0],
        VoxelType::U16 => [0.0, 65535.0],
        VoxelType::I16 => [-1000.0, 3000.0],
        VoxelType::F32 => [-1.5, 2.5],
    };
    let seed = random.bits() as u32;
    let along = random.direction();
    let field: Box<dyn Fn(DVec3) -> f64> = match random.pick(&[0, 1, 2, 3, 4, 5]) {
        0 => Box::new(blobs),
        1 => Box::new(radial),
        2 => Box::new(marschner_lobb),
        3 => Box::new(move |p| value_noise(p, 5.0, seed)),
        4 => Box::new(move |p| ramp(p, along)),
        _ => Box::new(move |p| checker(p, size)),
    };
    // The file's own values are 0 to 1.
    let slope = 1.0 / (stored[1] - stored[0]);
    let rescale = Rescale {
        slope,
        intercept: -slope * stored[0],
    };
    sampled(voxel_type, size, placement, rescale, stored, field)
}

/// Two to seven points over the values 0 to 1; about half of them transparent, some with a jump.
fn transfer_function(random: &mut Random) -> Vec<ControlPoint> {
    let emits = random.chance(0.3);
    let count = random.pick(&[2, 3, 4, 5, 7]);
    let mut values: Vec<_> = (0..count).map(|_| random.between(0.0, 1.0)).collect();
    if random.chance(0.3) {
        values[0] = values[1];
    }
    values.sort_by(f64::total_cmp);
    values
        .into_iter()
        .map(|value| {
            let color = random.color();
            let opacity = if random.chance(0.5) {
                0.0
            } else {
                random.unit()
            };
            let mut point = point(value, color, opacity);
            if emits && random.chance(0.5) {
                point.emission = random.color();
            }
            point
        })
        .collect()
}

fn camera(random: &mut Random, volume: &Volume) -> Camera {
    let (middle, radius) = bounds(volume);
    let target = middle + random.direction() * (0.3 * radius);
    let direction = random.direction();
    let far = |random: &mut Random| {
        let distance = random.between(1.5, 4.0) * radius;
        (target + direction * distance).to_array()
    };
    let up = direction.any_orthonormal_vector().to_array();
    let target_ws = target.to_array();
    match random.pick(&[0, 0, 1, 2]) {
        0 => Camera::Perspective {
            eye: far(random),
            target: target_ws,
            up,
            fov_y: random.between(15.0, 70.0),
        },
        1 => Camera::Orthographic {
            eye: far(random),
            target: target_ws,
            up,
            height: random.between(0.8, 2.5) * radius,
        },
        _ => Camera::Perspective {
            eye: (target + direction * (0.05 * radius)).to_array(),
            target: target_ws,
            up,
            fov_y: random.between(40.0, 100.0),
        },
    }
}

/// The scene of a seed: emission and absorption of a trilinear or nearest field.
pub(crate) fn subject(seed: u64) -> Subject {
    let mut random = Random::new(seed);
    let volume = volume(&mut random);
    let camera = camera(&mut random, &volume);
    let unit = volume.min_spacing() * random.pick(&[0.5, 1.0, 4.0]);
    let points = transfer_function(&mut random);
    let mut subject = Subject::new(volume, camera, [27, 22], unit, points);
    let scene = &mut subject.scene;
    scene.march.step = random.pick(&[0.1, 0.37, 0.5, 1.0, 2.0]);
    scene.march.early_termination = random.pick(&[0.6, 0.99, 1.0]);
    scene.march.jitter = random.chance(0.3);
    scene.march.seed = random.bits() as u32;
    scene.march.inter_block_interpolation = random.chance(0.8);
    if random.chance(0.2) {
        scene.march.interpolation = Interpolation::Nearest;
    }
    if random.chance(0.3) {
        scene.lighting.shading = Shading::Diffuse;
    }
    if random.chance(0.3) {
        scene.storage.data_reduction = random.between(1.5, 20.0);
    }
    if random.chance(0.4) {
        let grows = random.chance(0.5);
        scene.ambient_occlusion = Some(AmbientOcclusion {
            sampling: if grows {
                RaySampling::Distance
            } else {
                RaySampling::Uniform
            },
            growth: grows.then(|| random.pick(&[0.05, 0.3, 0.6, 1.0])),
            rays: random.pick(&[1, 2, 3]),
            radius: random.between(2.0, 12.0),
            offset: random.pick(&[0.0, 1.0]),
            step: random.between(0.5, 1.5),
            gamma: random.between(0.3, 2.0),
            bias: random.between(0.0, 0.2),
            emission: random.chance(0.7),
            ..Default::default()
        });
    }
    subject
}

/// The scene of a seed with any filter, classification and projection.
pub(crate) fn varied(seed: u64) -> Subject {
    let mut random = Random::new(!seed);
    let mut subject = subject(seed);
    let scene = &mut subject.scene;
    scene.march.interpolation = random.pick(&[
        Interpolation::Nearest,
        Interpolation::Linear,
        Interpolation::Linear,
        Interpolation::Bspline,
        Interpolation::CatmullRom,
    ]);
    let continuous = scene.march.field_is_continuous();
    let cubic = scene.march.interpolation.is_cubic();
    scene.march.inter_block_interpolation |= cubic;
    scene.march.projection = random.pick(&[
        RayProjection::Composite,
        RayProjection::Composite,
        RayProjection::Composite,
        RayProjection::Xray,
        RayProjection::Maximum,
        RayProjection::Minimum,
        RayProjection::Mean,
        if continuous {
            RayProjection::Isosurface
        } else {
            RayProjection::Composite
        },
    ]);
    if matches!(
        scene.march.projection,
        RayProjection::Composite | RayProjection::Xray
    ) {
        scene.march.classification = random.pick(&[
            None,
            Some(Classification::Post),
            (!cubic).then_some(Classification::Pre),
            continuous.then_some(Classification::Preintegrated),
        ]);
    }
    if scene.march.projection == RayProjection::Isosurface {
        scene.march.isosurfaces = (0..random.pick(&[1, 2, 5]))
            .map(|_| Isosurface {
                value: random.unit(),
                color: random.chance(0.5).then(|| random.color()),
                opacity: random.pick(&[0.3, 0.8, 1.0]),
            })
            .collect();
    }
    let is_lit = matches!(
        scene.march.projection,
        RayProjection::Composite | RayProjection::Isosurface
    );
    if is_lit {
        scene.lighting.gradient = random.pick(&[
            Gradient::CentralDifferences,
            Gradient::FourPoint,
            Gradient::Regression,
            Gradient::Sobel,
            Gradient::Bspline,
            Gradient::CatmullRom,
        ]);
    } else {
        scene.lighting.shading = Shading::None;
        scene.ambient_occlusion = None;
    }
    subject
}
