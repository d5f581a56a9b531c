//! Packed corners of voxel cells show what filters do, wherever something interpolates.

use std::sync::Arc;

use umbravox::headless::{Headless, Session};
use umbravox::picture::Picture;
use umbravox::scene::{
    AmbientOcclusion, Camera, Classification, Interpolation, LabelSource, RayProjection, Shading,
};
use umbravox::volume::{LabelMap, Volume, Voxels};

use crate::sessions::{Subject, assert_valid, device, largest_difference, point, shown};

// No edge is a whole number of texels.
const SIZE: [u32; 3] = [41, 34, 37];

/// Waves that reach the borders, in whole numbers from `low` to `high`.
fn waves(low: f64, high: f64) -> impl Iterator<Item = f64> {
    let [width, height, depth] = SIZE;
    (0..width * height * depth)
        .map(move |i| [i % width, i / width % height, i / (width * height)].map(f64::from))
        .map(|[x, y, z]| 0.5 + 0.5 * (0.9 * x).sin() * (0.7 * y + 0.4).cos() * (0.8 * z).sin())
        .map(move |v| (low + (high - low) * v).round())
}

/// The waves in one type, with a transfer function that shows the upper part of them.
fn subject(voxels: Voxels, low: f64, high: f64) -> Subject {
    let volume = Volume::axis_aligned(voxels, SIZE, [1.0, 1.3, 0.8]).unwrap();
    let at = |part: f64| low + (high - low) * part;
    let points = vec![
        point(at(0.45), [0.2, 0.5, 0.9], 0.0),
        point(at(0.7), [0.9, 0.3, 0.1], 0.2),
        point(at(1.0), [0.9, 0.8, 0.4], 0.4),
    ];
    Subject::new(volume, Camera::default(), [48, 40], 1.0, points)
}

fn kinds() -> [(&'static str, Subject); 4] {
    [
        (
            "u8",
            subject(
                Voxels::U8(waves(0.0, 255.0).map(|v| v as u8).collect()),
                0.0,
                255.0,
            ),
        ),
        (
            "i8",
            subject(
                Voxels::I8(waves(-128.0, 127.0).map(|v| v as i8).collect()),
                -128.0,
                127.0,
            ),
        ),
        (
            "u16",
            subject(
                Voxels::U16(waves(0.0, 65535.0).map(|v| v as u16).collect()),
                0.0,
                65535.0,
            ),
        ),
        (
            "i16",
            subject(
                Voxels::I16(waves(-32768.0, 32767.0).map(|v| v as i16).collect()),
                -32768.0,
                32767.0,
            ),
        ),
    ]
}

/// True when corners are packed.
fn packs(session: &mut Session) -> bool {
    session.stats().unwrap().memory.packed_cells_bytes > 0
}

/// The picture, and whether corners were packed for it.
fn first(subject: &Subject, device: &Headless) -> (Picture, bool) {
    let mut session = subject.session(device);
    let picture = session.frame().unwrap();
    (picture, packs(&mut session))
}

/// Shading that leaves colours as they are, by gradients that are not stored, takes samples one by one; without it processors take two
/// at once.
#[test]
fn samples_two_by_two_are_those_one_by_one() {
    let device = device(|_| {});
    for (name, plain) in kinds() {
        for (classification, data_reduction) in [
            (Classification::Post, 1.0),
            (Classification::Preintegrated, 1.0),
            (Classification::Post, 8.0),
        ] {
            for (step, jitter) in [(1.0, false), (0.37, true)] {
                let two = plain.with(|scene| {
                    scene.storage.data_reduction = data_reduction;
                    // Where levels mix, each sample has a brick of its own by beams; those of a run share one.
                    scene.march.beams = data_reduction == 1.0;
                    scene.march.classification = Some(classification);
                    scene.march.step = step;
                    scene.march.jitter = jitter;
                    // Some rays end at the first of two samples.
                    scene.march.early_termination = 0.4;
                });
                let one = two.with(|scene| {
                    scene.lighting.shading = Shading::Diffuse;
                    scene.lighting.ambient = 1.0;
                    scene.lighting.diffuse = 0.0;
                    scene.lighting.stored_gradients = false;
                });
                let what =
                    format!("{name}, {classification:?}, step {step}, reduction {data_reduction}");
                let (two, packed) = first(&two, &device);
                let (one, _) = first(&one, &device);
                assert_eq!(packed, device.device().device_type == "cpu", "{what}");
                assert!(shown(&two) > 100.0, "{what}");
                assert!(two.rgba == one.rgba && two.depth == one.depth, "{what}");
            }
        }
    }
    assert_valid(&device);
}

/// Samples are searched for one by one where there are labels, which here change nothing.
#[test]
fn shaded_samples_two_by_two_are_those_one_by_one() {
    let device = device(|_| {});
    for (name, plain) in kinds() {
        for classification in [Classification::Post, Classification::Preintegrated] {
            for (step, jitter) in [(1.0, false), (0.37, true)] {
                let two = plain.with(|scene| {
                    scene.lighting.shading = Shading::Diffuse;
                    scene.march.classification = Some(classification);
                    scene.march.step = step;
                    scene.march.jitter = jitter;
                    scene.march.early_termination = 0.4;
                });
                let one = Subject {
                    volume: Arc::new(as_background(&two.volume)),
                    ..two.with(|scene| {
                        scene.volume.labels = Some(LabelSource::new("in-memory"));
                    })
                };
                let what = format!("{name}, {classification:?}, step {step}");
                let (two, packed) = first(&two, &device);
                let (one, _) = first(&one, &device);
                assert_eq!(packed, device.device().device_type == "cpu", "{what}");
                assert!(shown(&two) > 100.0, "{what}");
                assert!(two.rgba == one.rgba && two.depth == one.depth, "{what}");
            }
        }
    }
    assert_valid(&device);
}

/// The volume with labels, all of it background.
fn as_background(volume: &Volume) -> Volume {
    let everywhere = Volume::new(
        Voxels::U8(vec![0; volume.voxels().len()]),
        volume.size(),
        volume.world_from_ix(),
        Default::default(),
    );
    let map = LabelMap::new(&everywhere.unwrap()).unwrap();
    volume.clone().with_labels(Some(Arc::new(map))).unwrap()
}

#[test]
fn packed_corners_show_what_filters_do() {
    let device = device(|_| {});
    for (name, plain) in kinds() {
        let subjects = [
            ("march", plain.clone()),
            (
                "step 0.3, shaded",
                plain.with(|scene| {
                    scene.march.step = 0.3;
                    scene.lighting.shading = Shading::Diffuse;
                }),
            ),
            (
                "bspline",
                plain.with(|scene| scene.march.interpolation = Interpolation::Bspline),
            ),
            (
                "maximum",
                plain.with(|scene| scene.march.projection = RayProjection::Maximum),
            ),
            (
                "bricks, light",
                plain.with(|scene| {
                    scene.storage.data_reduction = 1.5;
                    scene.ambient_occlusion = Some(AmbientOcclusion {
                        rays: 3,
                        radius: 6.0,
                        ..Default::default()
                    });
                }),
            ),
        ];
        for (what, subject) in subjects {
            let filtered = subject.with(|scene| scene.storage.packed_cells = false);
            let (picture, packed) = first(&subject, &device);
            let (expected, not_packed) = first(&filtered, &device);
            assert!(packed && !not_packed, "{name}, {what}");
            assert!(shown(&expected) > 100.0, "{name}, {what}");
            let difference = largest_difference(&picture, &expected);
            println!("{name}, {what}: {difference:.2e}");
            // Light is kept in halves, of which the last bit may differ.
            let bound = if what.ends_with("light") { 2e-3 } else { 2e-5 };
            assert!(difference < bound, "{name}, {what}: {difference}");
        }
    }
    assert_valid(&device);
}

#[test]
fn corners_are_packed_where_they_are_read_and_fit() {
    let device = device(|_| {});
    let kinds = kinds();
    // Texels for three by three cells of a slice, or three by one, in pages of 4 x 4 x 16 or 4 x 8 x 8 of them.
    for (kind, edges) in [(0, [12, 12, 16]), (2, [12, 8, 8])] {
        let (name, subject) = &kinds[kind];
        let mut session = subject.session(&device);
        session.frame().unwrap();
        let [x, y, z] = [SIZE[0], SIZE[1], SIZE[2] + 1];
        let pages = [(x, edges[0]), (y, edges[1]), (z, edges[2])].map(|(n, edge)| n.div_ceil(edge));
        let bytes = 4096 * u64::from(pages.iter().product::<u32>());
        assert_eq!(
            session.stats().unwrap().memory.packed_cells_bytes,
            bytes,
            "{name}"
        );
    }

    let [(_, bytes), ..] = kinds;
    let nearest = bytes.with(|scene| {
        scene.march.interpolation = Interpolation::Nearest;
        scene.march.classification = Some(umbravox::scene::Classification::Post);
    });
    assert!(!first(&nearest, &device).1, "nothing is interpolated");

    // Room for the voxels, and for half of what packing takes.
    let atlas = SIZE.map(|n| f64::from(n) + 2.0).iter().product::<f64>();
    let scarce = bytes.with(|scene| scene.storage.memory_budget_mib = 1.9 * atlas / 1048576.0);
    let (picture, packed) = first(&scarce, &device);
    assert!(!packed, "no room");
    let filtered = bytes.with(|scene| scene.storage.packed_cells = false);
    assert!(picture == filtered.picture(&device));

    let floats = waves(0.0, 255.0).map(|v| v as f32).collect();
    let floats = subject(Voxels::F32(floats), 0.0, 255.0);
    assert!(!first(&floats, &device).1, "of four bytes");

    // More pages than one dispatch fills: 20 x 30 x 30 of them.
    let large = (0..236u32.pow(3)).map(|i| (i.wrapping_mul(2_654_435_761) >> 16) as u16);
    let large = Voxels::U16(large.collect());
    let large = Volume::axis_aligned(large, [236; 3], [1.0; 3]).unwrap();
    let points = vec![point(0.0, [1.0; 3], 0.0), point(65535.0, [1.0; 3], 0.05)];
    let large = Subject::new(large, Camera::default(), [24, 24], 1.0, points);
    let (picture, packed) = first(&large, &device);
    assert!(packed, "of two bytes, and many");
    let filtered = large.with(|scene| scene.storage.packed_cells = false);
    let difference = largest_difference(&picture, &filtered.picture(&device));
    assert!(difference < 2e-5, "{difference}");
    assert_valid(&device);
}
