//! Every pair of options, in as few pictures as a greedy search finds, against the f64 reference; pairs that make no sense are
//! refused when the scene is read.

use std::collections::BTreeSet;

use ash::vk;
use glam::DVec3;
use umbravox::embed::Background;
use umbravox::gpu::HostMemory;
use umbravox::reference::{self, Setup};
use umbravox::scene::{
    AmbientOcclusion, Camera, Classification, ColorManagement, Curve, Gradient, Interpolation,
    Isosurface, RayProjection, Shading,
};
use umbravox::volume::{Rescale, Volume, VoxelType};

use crate::backends::Dedicated;
use crate::camera::{DepthKind, HostCamera};
use crate::fields::{placed, sampled};
use crate::host::{Host, Look, Stage};
use crate::pictures::difference;
use crate::scenes::{Subject, point, subject};

const RGBA32F: vk::Format = vk::Format::R32G32B32A32_SFLOAT;
const SIZE: [u32; 2] = [30, 26];
const PLANES: [f64; 2] = [0.5, 400.0];
/// Half a step of an 8-bit picture.
const TOLERANCE: f64 = 0.5 / 255.0;

/// Options and the number of their values.
const OPTIONS: [(&str, usize); 14] = [
    ("projection", 6),
    ("interpolation", 4),
    ("classification", 4),
    ("gradient", 6),
    ("shading", 2),
    ("occlusion", 2),
    ("emission", 2),
    ("jitter", 2),
    ("camera", 3),
    ("reduction", 2),
    ("scene depth", 2),
    ("memory", 2),
    ("skipping", 2),
    ("voxels", 4),
];

type Choice = [usize; OPTIONS.len()];
/// Option and value, twice, the first option before the second.
type Pair = [(usize, usize); 2];

const PROJECTIONS: [RayProjection; 6] = [
    RayProjection::Composite,
    RayProjection::Maximum,
    RayProjection::Minimum,
    RayProjection::Mean,
    RayProjection::Xray,
    RayProjection::Isosurface,
];
const INTERPOLATIONS: [Interpolation; 4] = [
    Interpolation::Nearest,
    Interpolation::Linear,
    Interpolation::Bspline,
    Interpolation::CatmullRom,
];
const CLASSIFICATIONS: [Option<Classification>; 4] = [
    None,
    Some(Classification::Pre),
    Some(Classification::Post),
    Some(Classification::Preintegrated),
];
const GRADIENTS: [Gradient; 6] = [
    Gradient::CentralDifferences,
    Gradient::FourPoint,
    Gradient::Regression,
    Gradient::Sobel,
    Gradient::Bspline,
    Gradient::CatmullRom,
];

/// Around a point off the middle; exactly 0 in most blocks, which coarse levels therefore keep exactly. Ripples see to it that
/// the others are kept at the finest level.
fn bump(p: DVec3) -> f64 {
    let q = (p - DVec3::new(0.4, 0.55, 0.45)) * DVec3::new(1.0, 1.2, 0.9);
    let r = q.length() / 0.3;
    let ripple = (55.0 * p.x).sin() * (61.0 * p.y + 1.0).sin() * (49.0 * p.z).sin();
    if r < 1.0 {
        (1.0 - r * r).powi(2) * (0.8 + 0.2 * ripple)
    } else {
        0.0
    }
}

fn scene_of(choice: &Choice) -> Subject {
    let [
        projection,
        interpolation,
        classification,
        gradient,
        shading,
        occlusion,
        emission,
        jitter,
        camera,
        reduction,
        _depth,
        _memory,
        skipping,
        voxels,
    ] = *choice;
    let placement = placed([1.0, 0.8, 1.2], [0.3, 0.1, 1.0], 35.0, [4.0, -3.0, 7.0]);
    // Two with packed corners, and two without.
    let (voxel_type, largest, packed) = [
        (VoxelType::F32, 1.0, true),
        (VoxelType::U16, 65535.0, true),
        (VoxelType::U8, 255.0, true),
        (VoxelType::U8, 255.0, false),
    ][voxels];
    let rescale = Rescale {
        slope: 1.0 / largest,
        intercept: 0.0,
    };
    let volume = sampled(
        voxel_type,
        [49, 53, 47],
        placement,
        rescale,
        [0.0, largest],
        bump,
    );
    let at = |p: [f64; 3]| {
        let last = DVec3::from_array(volume.size().map(|n| f64::from(n - 1)));
        world_of(&volume, DVec3::from_array(p) * last)
    };
    let middle = at([0.4, 0.55, 0.45]);
    let camera = match camera {
        0 => Camera::Perspective {
            eye: (middle + DVec3::new(40.0, -75.0, 30.0)).to_array(),
            target: middle.to_array(),
            up: [0.0, 0.0, 1.0],
            fov_y: 26.0,
        },
        1 => Camera::Orthographic {
            eye: (middle + DVec3::new(-60.0, -40.0, 20.0)).to_array(),
            target: middle.to_array(),
            up: [0.0, 0.0, 1.0],
            height: 40.0,
        },
        _ => Camera::Perspective {
            eye: (middle + DVec3::new(3.0, -9.0, 2.0)).to_array(),
            // Off what is round: nearest neighbours of a place in the middle of two are a matter of rounding.
            target: at([0.613, 0.517, 0.6]).to_array(),
            up: [0.0, 0.0, 1.0],
            fov_y: 70.0,
        },
    };
    let glow = if emission == 1 { 0.4 } else { 0.0 };
    let points = vec![
        point(0.1, [0.1, 0.3, 0.9], 0.0, [0.0; 3]),
        point(0.45, [0.9, 0.4, 0.1], 0.25, [glow, 0.0, 0.2 * glow]),
        point(1.0, [1.0, 0.9, 0.6], 0.5, [0.0, 0.5 * glow, 0.0]),
    ];
    let mut subject = subject(volume, camera, points);
    let scene = &mut subject.scene;
    scene.image.size = SIZE;
    scene.march.projection = PROJECTIONS[projection];
    scene.march.interpolation = INTERPOLATIONS[interpolation];
    scene.march.classification = CLASSIFICATIONS[classification];
    scene.march.step = 0.7;
    scene.march.early_termination = 1.0;
    scene.march.jitter = jitter == 1;
    scene.march.seed = 7;
    scene.march.empty_space_skipping = skipping == 0;
    if scene.march.projection == RayProjection::Isosurface {
        let surface = |value, color, opacity| Isosurface {
            value,
            color,
            opacity,
        };
        scene.march.isosurfaces = vec![
            surface(0.3, None, 0.4),
            surface(0.62, Some([0.2, 0.9, 0.5]), 1.0),
        ];
    }
    scene.lighting.gradient = GRADIENTS[gradient];
    if shading == 1 {
        scene.lighting.shading = Shading::Diffuse;
    }
    if occlusion == 1 {
        scene.ambient_occlusion = Some(AmbientOcclusion {
            rays: 3,
            radius: 5.0,
            ..Default::default()
        });
    }
    if reduction == 1 {
        scene.storage.data_reduction = 1.3;
    }
    scene.storage.packed_cells = packed;
    subject
}

fn world_of(volume: &Volume, ix: DVec3) -> DVec3 {
    volume.world_from_ix().transform_point3(ix)
}

fn is_valid(choice: &Choice) -> bool {
    scene_of(choice).scene.validate().is_ok()
}

/// Numbers in `[0, n)`, the same every time.
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % n
    }
}

fn pairs_of(choice: &Choice) -> impl Iterator<Item = Pair> {
    (0..choice.len()).flat_map(move |b| (0..b).map(move |a| [(a, choice[a]), (b, choice[b])]))
}

/// Choices that have every pair which some valid choice has, and the pairs that none has.
fn cover() -> (Vec<Choice>, BTreeSet<Pair>) {
    let mut missing = BTreeSet::new();
    for (b, (_, b_values)) in OPTIONS.iter().enumerate() {
        for (a, (_, a_values)) in OPTIONS[..b].iter().enumerate() {
            for x in 0..*a_values {
                missing.extend((0..*b_values).map(|y| [(a, x), (b, y)]));
            }
        }
    }
    let mut random = Random(1);
    let (mut choices, mut refused) = (Vec::new(), BTreeSet::new());
    while let Some(&wanted) = missing.iter().next() {
        let mut best: Option<(usize, Choice)> = None;
        let mut valid = 0;
        for _ in 0..300 {
            let mut choice: Choice = std::array::from_fn(|o| random.below(OPTIONS[o].1));
            for (option, value) in wanted {
                choice[option] = value;
            }
            if !is_valid(&choice) {
                continue;
            }
            valid += 1;
            let new = pairs_of(&choice).filter(|p| missing.contains(p)).count();
            if best.is_none_or(|(most, _)| new > most) {
                best = Some((new, choice));
            }
            if valid == 30 {
                break;
            }
        }
        match best {
            None => {
                missing.remove(&wanted);
                refused.insert(wanted);
            }
            Some((_, choice)) => {
                for pair in pairs_of(&choice) {
                    missing.remove(&pair);
                }
                choices.push(choice);
            }
        }
    }
    (choices, refused)
}

/// PCG (Jarzynski and Olano 2020), the hash behind the jitter.
fn pcg(v: u32) -> u32 {
    let state = v.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
    (word >> 22) ^ word
}

/// The picture of the device and that of the reference.
fn both(host: &Host, choice: &Choice) -> [Vec<[f64; 4]>; 2] {
    let subject = scene_of(choice);
    let memory = match choice[11] {
        0 => HostMemory::GpuAllocator,
        _ => HostMemory::Custom(Dedicated::new(host)),
    };
    let context = host.context(memory);
    let view = subject.view(SIZE);
    let camera = HostCamera::new(&view, SIZE, DepthKind::Reversed, PLANES);
    let middle = world_of(&subject.volume, DVec3::new(20.0, 29.0, 21.0));
    let has_depth = choice[10] == 1;
    let mut depths = Vec::new();
    let mut ends = Vec::new();
    for y in 0..SIZE[1] {
        for x in 0..SIZE[0] {
            let pixel = [f64::from(x) + 0.5, f64::from(y) + 0.5];
            let (origin, direction) = view.ray(pixel, SIZE);
            let normal = DVec3::new(0.3, 1.0, -0.2);
            let hit = (middle - origin).dot(normal) / direction.dot(normal);
            let depth = if hit > 0.0 && hit.is_finite() {
                camera.depth_of(origin + direction * hit)
            } else {
                camera.cleared()
            };
            // What the depth buffer says: its rounding is the host's.
            ends.push(if depth == camera.cleared() {
                f64::INFINITY
            } else {
                (camera.point_ws(pixel, SIZE, depth) - origin).dot(direction)
            });
            depths.push(depth);
        }
    }
    let mut stage = Stage::new(host, RGBA32F, SIZE);
    if has_depth {
        stage.set_depth(&depths);
    }
    let mut renderer = subject.renderer(&context);
    let look = Look {
        camera: camera.frame_camera(),
        background: Background::Transparent,
        encode_srgb: false,
    };
    let picture = stage.draw(&look, &mut [&mut renderer]);
    let newest = stage.destroy() as u32;
    drop(renderer);
    drop(context);

    let scene = &subject.scene;
    let points = scene
        .transfer_function
        .points
        .as_deref()
        .unwrap_or_default();
    let curve = Curve::new(1.0, points, ColorManagement::Linear);
    let surfaces = scene.march.surfaces(&curve, ColorManagement::Linear);
    let light = scene
        .ambient_occlusion
        .as_ref()
        .map(|ao| reference::light(&subject.volume, &curve, ao, None));
    let jitter = |[x, y]: [u32; 2]| {
        let hash = pcg(x.wrapping_add(pcg(
            y.wrapping_add(pcg(newest.wrapping_add(pcg(scene.march.seed))))
        )));
        f64::from(hash >> 8) / f64::from(1 << 24)
    };
    let end = |[x, y]: [u32; 2]| ends[(x + y * SIZE[0]) as usize];
    let setup = Setup {
        size: SIZE,
        jitter: if scene.march.jitter {
            Some(&jitter)
        } else {
            None
        },
        end: if has_depth { Some(&end) } else { None },
        ..Setup::new(
            &subject.volume,
            scene,
            &view,
            &curve,
            &surfaces,
            light.as_ref(),
        )
    };
    [picture, reference::march(&setup).rgba]
}

fn name(choice: &Choice) -> String {
    let named = OPTIONS.iter().zip(choice);
    named
        .map(|((option, _), value)| format!("{option} {value}, "))
        .collect()
}

#[test]
fn every_pair_of_options_agrees_with_the_reference() {
    let (choices, refused) = cover();
    println!(
        "{} pictures; {} pairs are refused",
        choices.len(),
        refused.len()
    );
    let host = Host::new();
    let (mut complaints, mut shown, mut worst) = (Vec::new(), 0, 0.0f64);
    for choice in &choices {
        let [picture, expected] = both(&host, choice);
        let off = difference(&picture, &expected);
        worst = worst.max(off);
        shown += usize::from(expected.iter().filter(|p| p[3] > 0.05).count() > 50);
        println!("{}{:.4}/255", name(choice), off * 255.0);
        if off > TOLERANCE {
            complaints.push(format!("{}{:.4}/255", name(choice), off * 255.0));
        }
    }
    host.finish();
    println!("worst {:.4}/255", worst * 255.0);
    assert!(complaints.is_empty(), "\n{}", complaints.join("\n"));
    assert!(
        shown * 4 > choices.len() * 3,
        "{shown} of {} show something",
        choices.len()
    );

    // Pairs without a meaning, by option and value.
    let mut expected = BTreeSet::new();
    for projection in [1, 2, 3, 5] {
        expected.extend((1..4).map(|classification| [(0, projection), (2, classification)]));
    }
    for projection in 1..5 {
        expected.insert([(0, projection), (4, 1)]);
        expected.insert([(0, projection), (5, 1)]);
    }
    expected.insert([(0, 5), (1, 0)]);
    expected.insert([(1, 0), (2, 3)]);
    expected.extend([2, 3].map(|cubic| [(1, cubic), (2, 1)]));
    assert_eq!(refused, expected);
    for pair in refused {
        let mut choice = [0; OPTIONS.len()];
        choice[1] = 1;
        for (option, value) in pair {
            choice[option] = value;
        }
        let error = scene_of(&choice).scene.validate().unwrap_err().to_string();
        let says = ["march.", "lighting.", "ambient_occlusion"];
        assert!(says.iter().any(|key| error.contains(key)), "{error}");
    }
}
