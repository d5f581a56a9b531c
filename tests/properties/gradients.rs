//! Stored gradients show what estimated ones do, and are there wherever a picture needs them.

use umbravox::embed::Settings;
use umbravox::headless::Session;
use umbravox::scene::{Camera, Gradient, Shading};
use umbravox::volume::{Volume, Voxels};

use crate::sessions::{Subject, assert_valid, device, largest_difference, point, shown};

const SIZE: [u32; 3] = [41, 37, 35];

/// Waves that reach the borders, from 0 to 1.
fn waves() -> Vec<f64> {
    let [width, height, depth] = SIZE;
    (0..width * height * depth)
        .map(|i| [i % width, i / width % height, i / (width * height)].map(f64::from))
        .map(|[x, y, z]| 0.5 + 0.5 * (0.31 * x).sin() * (0.23 * y + 0.4).cos() * (0.27 * z).sin())
        .collect()
}

/// The waves in one type, with a transfer function that shows the upper part of them.
fn subject(voxels: Voxels, largest: f64, from: f64) -> Subject {
    let volume = Volume::axis_aligned(voxels, SIZE, [1.0, 1.3, 0.8]).unwrap();
    let points = vec![
        point(from * largest, [0.2, 0.5, 0.9], 0.0),
        point(largest, [0.9, 0.8, 0.4], 0.4),
    ];
    let subject = Subject::new(volume, Camera::default(), [48, 40], 1.0, points);
    subject.with(|scene| scene.lighting.shading = Shading::Diffuse)
}

fn kinds() -> [(&'static str, Voxels, f64); 3] {
    let waves = waves();
    let scaled = |scale: f64| waves.iter().map(move |v| v * scale);
    [
        (
            "u8",
            Voxels::U8(scaled(255.0).map(|v| v.round() as u8).collect()),
            255.0,
        ),
        (
            "u16",
            Voxels::U16(scaled(4000.0).map(|v| v.round() as u16).collect()),
            4000.0,
        ),
        (
            "f32",
            Voxels::F32(scaled(3e-5).map(|v| v as f32).collect()),
            3e-5,
        ),
    ]
}

/// True when the last frame stored gradients.
fn stores(session: &Session) -> bool {
    session.passes().iter().any(|pass| pass.name == "gradients")
}

#[test]
fn stored_gradients_show_what_estimated_ones_do() {
    let device = device(|_| {});
    for (name, voxels, largest) in kinds() {
        let subject = subject(voxels, largest, 0.4);
        for estimator in [
            Gradient::CentralDifferences,
            Gradient::FourPoint,
            Gradient::Regression,
            Gradient::Sobel,
        ] {
            // One budget leaves room for packed corners, whose last bits differ; the other does not.
            let subject = subject.with(|scene| {
                scene.lighting.gradient = estimator;
                scene.storage.packed_cells = false;
            });
            // The atlas, and next to nothing else.
            let voxel_bytes = subject.volume.voxels().voxel_type().bytes() as f64;
            let atlas_mib =
                SIZE.map(|n| f64::from(n) + 2.0).iter().product::<f64>() * voxel_bytes / 1048576.0;
            let scarce = subject.with(|scene| scene.storage.memory_budget_mib = 1.05 * atlas_mib);
            let chosen = subject.with(|scene| scene.lighting.stored_gradients = false);
            let [mut stored, mut estimated] = [&subject, &scarce].map(|s| s.session(&device));
            let pictures = [stored.frame().unwrap(), estimated.frame().unwrap()];
            assert!(
                stores(&stored) && !stores(&estimated),
                "{name}, {estimator:?}"
            );
            assert_eq!(estimated.stats().unwrap().data_reduction, 1.0);
            assert!(
                pictures[1] == chosen.picture(&device),
                "{name}, {estimator:?}"
            );
            assert!(shown(&pictures[0]) > 100.0);
            let difference = largest_difference(&pictures[0], &pictures[1]);
            // Ten bits hold central differences of bytes exactly; halves are off by 2^-11 of each component.
            let exact = name == "u8" && estimator == Gradient::CentralDifferences;
            let bound = if exact { 2e-5 } else { 5e-4 };
            println!("{name}, {estimator:?}: {difference:.2e}");
            assert!(difference < bound, "{name}, {estimator:?}: {difference}");
            stored.frame().unwrap();
            assert!(!stores(&stored), "nothing new is seen");
        }
    }
    assert_valid(&device);
}

/// CPU drivers keep words of ten bits in fours where there is room: they hold the same.
#[test]
fn gradients_in_fours_are_those_in_words() {
    let device = device(|_| {});
    if device.device().device_type != "cpu" {
        println!("texture units interpolate gradients here");
        return;
    }
    let size = [41, 37, 70];
    let [width, height, depth] = size;
    // Balls here and there, so that some chunks are computed and others are not.
    let voxels = (0..width * height * depth)
        .map(|i| [i % width, i / width % height, i / (width * height)].map(f64::from))
        .map(|[x, y, z]| {
            let near = [[8.0, 9.0, 21.0], [33.0, 30.0, 49.5], [20.0, 4.0, 66.0]]
                .map(|c| (c[0] - x).hypot(c[1] - y).hypot(c[2] - z));
            let distance = near.into_iter().fold(f64::INFINITY, f64::min);
            (255.0 - 24.0 * distance).max(0.0).round() as u8
        });
    let volume = Volume::axis_aligned(Voxels::U8(voxels.collect()), size, [1.0, 1.3, 0.8]);
    let points = vec![
        point(90.0, [0.2, 0.5, 0.9], 0.0),
        point(255.0, [0.9, 0.8, 0.4], 0.4),
    ];
    let subject = Subject::new(volume.unwrap(), Camera::default(), [64, 48], 1.0, points);
    let subject = subject.with(|scene| {
        scene.lighting.shading = Shading::Diffuse;
        scene.storage.packed_cells = false;
    });
    // Room for the voxels and for 170 pages of gradients: words need 150, fours 180.
    let scarce = subject.with(|scene| {
        let voxels = f64::from(width * height * depth);
        scene.storage.memory_budget_mib = (voxels + 170.0 * 4096.0) / 1048576.0;
    });
    let estimated = subject.with(|scene| scene.lighting.stored_gradients = false);
    let [mut fours, mut words] = [&subject, &scarce].map(|s| s.session(&device));
    let pictures = [fours.frame().unwrap(), words.frame().unwrap()];
    assert!(stores(&fours) && stores(&words));
    let pages = [&mut fours, &mut words].map(|s| s.stats().unwrap().memory.gradients_bytes / 4096);
    assert_eq!(pages, [180, 150]);
    assert!(shown(&pictures[0]) > 50.0);
    assert!(pictures[0] == pictures[1]);
    let difference = largest_difference(&pictures[0], &estimated.picture(&device));
    assert!(difference < 2e-5, "{difference}");
    assert_valid(&device);
}

/// Where nothing rises, nothing is a surface: no gradient stays none.
#[test]
fn flat_places_have_no_gradient() {
    let device = device(|_| {});
    let clipped = waves()
        .into_iter()
        .map(|v| (255.0 * v.min(0.8)).round() as u8);
    let subject = subject(Voxels::U8(clipped.collect()), 255.0, 0.4);
    let estimated = subject.with(|scene| scene.lighting.stored_gradients = false);
    let mut session = subject.session(&device);
    let stored = session.frame().unwrap();
    assert!(stores(&session));
    let difference = largest_difference(&stored, &estimated.picture(&device));
    assert!(difference < 2e-5, "{difference}");
    assert_valid(&device);
}

#[test]
fn what_comes_into_sight_has_gradients() {
    let device = device(|_| {});
    let (_, voxels, largest) = kinds().into_iter().next().expect("three");
    let narrow = subject(voxels.clone(), largest, 0.9);
    let wide = subject(voxels, largest, 0.2);
    let mut session = narrow.session(&device);
    let first = session.frame().unwrap();
    let settings = Settings::of_scene(&wide.scene, &wide.volume).unwrap();
    session.set_settings(settings).unwrap();
    let second = session.frame().unwrap();
    assert!(stores(&session), "more is seen");
    assert!(second == wide.picture(&device));
    assert!(shown(&second) > 1.5 * shown(&first));
    let sobel = wide.with(|scene| scene.lighting.gradient = Gradient::Sobel);
    let settings = Settings::of_scene(&sobel.scene, &sobel.volume).unwrap();
    session.set_settings(settings).unwrap();
    assert!(session.frame().unwrap() == sobel.picture(&device));
    assert_valid(&device);
}
