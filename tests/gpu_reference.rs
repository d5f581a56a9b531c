//! The GPU against the f64 reference at full resolution: pictures, depths, sample counts and light volumes of
//! every scene. What each scene differed by is printed (`--nocapture`).

#[path = "common/scenes.rs"]
mod scenes;

use std::sync::Arc;

use scenes::TestScene;
use umbravox::headless::{Headless, LightVolume, Options, Session};
use umbravox::picture::Picture;
use umbravox::reference::{self, LightGrid, Setup};
use umbravox::scene::{March, Scene};

/// One step of an 8-bit picture.
const TOLERANCE: f64 = 1.0 / 255.0;
/// What f32 may add up to in an accumulated opacity; a threshold that close may be passed a sample
/// earlier or later.
const OPACITY_ROUNDING: f64 = 1e-5;
/// What f32 may shift the borders of segments by, relative.
const LENGTH_ROUNDING: f64 = 1e-5;
/// Rays that touch an edge of the field so briefly that rounding decides whether they have a segment.
const GRAZING_RAYS: usize = 2;

/// A device with validation: any message of the layers is an error.
fn headless() -> Headless {
    let options = Options {
        validation: true,
        ..Default::default()
    };
    Headless::new(&options).expect("a Vulkan device and the validation layer are installed")
}

fn session(headless: &Headless, test: &TestScene, scene: &Scene) -> Session {
    let mut session = headless.load(Arc::clone(&test.volume), scene).unwrap();
    session.set_view(test.view);
    while session.refine_light().unwrap() {}
    session
}

fn light_of(test: &TestScene) -> Option<LightGrid> {
    let settings = test.scene.ambient_occlusion.as_ref()?;
    Some(reference::light(
        &test.volume,
        &test.curve,
        settings,
        test.labels.as_ref(),
    ))
}

/// The scene's march with empty-space skipping on or off.
fn with_skipping(scene: &Scene, empty_space_skipping: bool) -> Scene {
    let mut scene = scene.clone();
    scene.march.empty_space_skipping = empty_space_skipping;
    scene
}

/// Largest difference of a channel.
fn color_difference(gpu: &Picture, expected: &reference::Picture) -> f64 {
    let channels = gpu
        .rgba
        .iter()
        .flatten()
        .zip(expected.rgba.iter().flatten());
    channels
        .map(|(&a, b)| (f64::from(a) - b).abs())
        .fold(0.0, f64::max)
}

/// Number of depths outside what the reference has with the threshold a rounding error lower and higher.
fn wrong_depths(gpu: &Picture, setup: &Setup) -> usize {
    let with_threshold = |shift: f64| {
        reference::march(&Setup {
            depth_threshold: setup.depth_threshold + shift,
            ..*setup
        })
        .depth
    };
    let [nearest, farthest] = [-OPACITY_ROUNDING, OPACITY_ROUNDING].map(with_threshold);
    let step = setup.march.step * setup.volume.min_spacing();
    let inside = |(&depth, (&near, &far)): (&f32, (&f64, &f64))| {
        let slack = 1e-3 * step + LENGTH_ROUNDING * near.min(1e30);
        (near - slack..=far + slack).contains(&f64::from(depth))
    };
    let bounds = nearest.iter().zip(&farthest);
    gpu.depth
        .iter()
        .zip(bounds)
        .filter(|&pair| !inside(pair))
        .count()
}

/// Number of sample counts outside what the reference has when rounding ends rays early or late.
fn wrong_sample_counts(gpu: &Picture, setup: &Setup) -> usize {
    let with_rounding = |sign: f64| {
        let march = March {
            early_termination: setup.march.early_termination + sign * OPACITY_ROUNDING,
            step: setup.march.step * (1.0 - sign * LENGTH_ROUNDING),
            ..setup.march.clone()
        };
        reference::march(&Setup {
            march: &march,
            ..*setup
        })
        .samples
    };
    let [fewest, most] = [-1.0, 1.0].map(with_rounding);
    let bounds = fewest.iter().zip(&most);
    let pairs = gpu.samples.iter().zip(bounds);
    pairs
        .filter(|(n, (low, high))| *n < low || *n > high)
        .count()
}

#[test]
fn pictures_agree_with_the_reference() {
    let headless = headless();
    let mut complaints = Vec::new();
    for test in scenes::all() {
        let light = light_of(&test);
        let setup = Setup {
            labels: test.labels.as_ref(),
            ..Setup::new(
                &test.volume,
                &test.scene,
                &test.view,
                &test.curve,
                &test.surfaces,
                light.as_ref(),
            )
        };
        let expected = reference::march(&setup);
        for skipping in [true, false] {
            let scene = with_skipping(&test.scene, skipping);
            let gpu = session(&headless, &test, &scene).frame().unwrap();
            assert_eq!(gpu.size, expected.size);
            let color = color_difference(&gpu, &expected);
            let depths = wrong_depths(&gpu, &setup);
            // Skipped samples are not counted.
            let counts = if skipping {
                0
            } else {
                wrong_sample_counts(&gpu, &setup)
            };
            let line = format!(
                "{}, skipping {skipping}: {:.4}/255; {depths} depths, {counts} counts differ",
                test.name,
                color * 255.0
            );
            println!("{line}");
            if color > TOLERANCE || depths > GRAZING_RAYS || counts > GRAZING_RAYS {
                complaints.push(line);
            }
        }
    }
    assert!(complaints.is_empty(), "\n{}", complaints.join("\n"));
}

/// Largest difference of a channel of the computed voxels, and their number; every voxel that can be seen
/// must be computed.
fn compare_light(gpu: &LightVolume, expected: &LightGrid, test: &TestScene) -> (f64, usize) {
    assert_eq!(gpu.size, expected.size());
    let (mut largest, mut computed) = (0f64, 0);
    for (at, (voxel, light)) in gpu.rgba.iter().zip(expected.voxels()).enumerate() {
        let stored = test.volume.voxels().get(at);
        let opacity = test
            .curve
            .evaluate(test.volume.value_from_stored(stored))
            .opacity;
        if voxel[3] == 0.0 {
            assert_eq!(
                opacity, 0.0,
                "{}: voxel {at} is visible and has no light",
                test.name
            );
            continue;
        }
        computed += 1;
        for (actual, expected) in voxel[..3].iter().zip(light.rgb) {
            largest = largest.max((f64::from(*actual) - expected).abs());
        }
    }
    (largest, computed)
}

#[test]
fn light_volumes_agree_with_the_reference() {
    let headless = headless();
    let mut complaints = Vec::new();
    for test in scenes::all() {
        let Some(expected) = light_of(&test) else {
            continue;
        };
        let gpu = session(&headless, &test, &test.scene)
            .light_volume()
            .unwrap();
        let (difference, computed) = compare_light(&gpu, &expected, &test);
        let line = format!(
            "{}: {:.4}/255 in {computed} voxels",
            test.name,
            difference * 255.0
        );
        println!("{line}");
        if difference > TOLERANCE || computed == 0 {
            complaints.push(line);
        }
    }
    assert!(complaints.is_empty(), "\n{}", complaints.join("\n"));
}

/// Labels are looked up at the same voxel whether cells before it were skipped or not.
#[test]
fn skipping_changes_no_bit_of_labels() {
    let headless = headless();
    let with_labels = |test: &TestScene| test.labels.is_some();
    for test in scenes::all().into_iter().filter(with_labels) {
        let [skipped, whole] = [true, false].map(|skipping| {
            let scene = with_skipping(&test.scene, skipping);
            session(&headless, &test, &scene).frame().unwrap()
        });
        let bits = |picture: &Picture| -> Vec<_> {
            let pixels = picture.rgba.iter().zip(&picture.depth);
            pixels
                .map(|(rgba, depth)| (rgba.map(f32::to_bits), depth.to_bits()))
                .collect()
        };
        assert!(bits(&skipped) == bits(&whole), "{}", test.name);
    }
}
