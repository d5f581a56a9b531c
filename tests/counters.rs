//! Counters of fixed scenes, which no machine's speed changes: a change that makes the renderer take more samples, stage more
//! or hold more fails here. Expected values are in `tests/data/counters.json`; after a change that is meant to move them,
//!
//! ```sh
//! UMBRAVOX_UPDATE_COUNTERS=1 cargo test --all-features --test counters
//! ```
//!
//! writes them, and the difference belongs into the commit. Bytes staged are exact. Samples follow rounding in a
//! driver's f32 arithmetic at borders of cells, and bytes held its alignment.

#[path = "../bench/procedural.rs"]
mod procedural;

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use serde::{Deserialize, Serialize};
use umbravox::headless::{Headless, Options};
use umbravox::scene::{
    AmbientOcclusion, Classification, ControlPoint, Image, March, RaySampling, Scene,
    TransferFunction, VolumeSource,
};
use umbravox::volume::Volume;

/// Edge of the volumes, voxels, and of the pictures, pixels.
const SIZE: u32 = 64;
const IMAGE: u32 = 96;

/// How far samples may be from what is expected.
const SAMPLES_TOLERANCE: f64 = 1e-3;
/// The same of bytes held.
const RESIDENT_TOLERANCE: f64 = 0.02;

#[derive(Debug, PartialEq, Serialize, Deserialize)]
struct Counters {
    /// Of the picture at step 1, by classification.
    samples_post: u64,
    samples_preintegrated: u64,
    /// The first again, by beams, which are cast where the processor is the device.
    samples_beams: u64,
    /// Of 4 directions of 15 samples.
    light_samples: u64,
    /// The same, each distance between samples a part of a ray longer than the one before.
    growing_light_samples: u64,
    /// Voxels, index and tables.
    resident_bytes: u64,
    uploaded_bytes: u64,
}

fn scene(opacities: [f64; 2], values: [f64; 2], classification: Classification) -> Scene {
    let points = [0, 1].map(|at| ControlPoint {
        value: values[at],
        color: [1.0; 3],
        opacity: opacities[at],
        emission: [0.0; 3],
        source: [0.0; 3],
    });
    Scene {
        volume: VolumeSource {
            path: "in-memory".into(),
            ..Default::default()
        },
        camera: Default::default(),
        image: Image {
            size: [IMAGE; 2],
            ..Default::default()
        },
        transfer_function: TransferFunction {
            points: Some(points.to_vec()),
            ..Default::default()
        },
        march: March {
            step: 1.0,
            classification: Some(classification),
            ..Default::default()
        },
        lighting: Default::default(),
        ambient_occlusion: None,
        storage: Default::default(),
    }
}

fn count(headless: &Headless, volume: Volume, values: [f64; 2], opacities: [f64; 2]) -> Counters {
    let volume = Arc::new(volume);
    let stats = |classification, beams| {
        let mut scene = scene(opacities, values, classification);
        scene.march.beams = beams;
        let mut session = headless.load(volume.clone(), &scene).expect("a session");
        session.timed_frame().expect("a frame");
        session.stats().expect("statistics")
    };
    let post = stats(Classification::Post, false);
    let by_beams = stats(Classification::Post, true);
    let light_samples = |sampling, growth| {
        let mut lit = scene(opacities, values, Classification::Post);
        lit.ambient_occlusion = Some(AmbientOcclusion {
            rays: 4,
            sampling,
            growth,
            ..Default::default()
        });
        let mut session = headless.load(volume.clone(), &lit).expect("a session");
        let samples = session.count_light_samples().expect("a count");
        samples.expect("every brick at the finest level")
    };
    // The picture and what is measured beside it: 16 bytes a pixel each.
    let pictures = 2 * 16 * u64::from(IMAGE).pow(2);
    Counters {
        samples_post: post.samples.taken,
        samples_preintegrated: stats(Classification::Preintegrated, false).samples.taken,
        samples_beams: by_beams.samples.taken,
        light_samples: light_samples(RaySampling::Uniform, None),
        growing_light_samples: light_samples(RaySampling::Distance, Some(1.0)),
        // Packed corners are there on some drivers alone.
        resident_bytes: post.memory.device_bytes - post.memory.packed_cells_bytes - pictures,
        uploaded_bytes: post.memory.uploaded_bytes,
    }
}

/// What differs by more than it may.
fn complaints(name: &str, found: &Counters, expected: &Counters, beams: bool) -> Vec<String> {
    let expected_beams = if beams {
        expected.samples_beams
    } else {
        expected.samples_post
    };
    let rows = [
        (
            "samples_post",
            found.samples_post,
            expected.samples_post,
            SAMPLES_TOLERANCE,
        ),
        (
            "samples_preintegrated",
            found.samples_preintegrated,
            expected.samples_preintegrated,
            SAMPLES_TOLERANCE,
        ),
        (
            "samples_beams",
            found.samples_beams,
            expected_beams,
            SAMPLES_TOLERANCE,
        ),
        (
            "light_samples",
            found.light_samples,
            expected.light_samples,
            SAMPLES_TOLERANCE,
        ),
        (
            "growing_light_samples",
            found.growing_light_samples,
            expected.growing_light_samples,
            SAMPLES_TOLERANCE,
        ),
        (
            "resident_bytes",
            found.resident_bytes,
            expected.resident_bytes,
            RESIDENT_TOLERANCE,
        ),
        (
            "uploaded_bytes",
            found.uploaded_bytes,
            expected.uploaded_bytes,
            0.0,
        ),
    ];
    let off = rows.iter().filter(|(_, found, expected, tolerance)| {
        found.abs_diff(*expected) as f64 > tolerance * *expected as f64
    });
    off.map(|(what, found, expected, tolerance)| {
        format!("{name}: {what} is {found}, expected {expected} within {tolerance}")
    })
    .collect()
}

#[test]
fn counters_are_as_expected() {
    let headless = Headless::new(&Options {
        validation: true,
        pipeline_cache: false,
        ..Default::default()
    })
    .expect("a device");
    let volumes = [
        ("fog", procedural::fog(SIZE), [0.0, 255.0], [0.001, 0.004]),
        (
            "sparse",
            procedural::sparse(SIZE),
            [100.0, 200.0],
            [0.0, 0.6],
        ),
        ("blobs", procedural::blobs(SIZE), [170.0, 210.0], [0.0, 0.5]),
        ("shell", procedural::shell(SIZE), [100.0, 255.0], [0.0, 0.3]),
    ];
    let found: BTreeMap<String, Counters> = volumes
        .into_iter()
        .map(|(name, volume, values, opacities)| {
            let volume = volume.expect("a volume");
            (name.to_owned(), count(&headless, volume, values, opacities))
        })
        .collect();
    assert_eq!(headless.validation_messages(), [""; 0]);
    let beams = headless.device().device_type == "cpu";

    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/counters.json");
    if std::env::var_os("UMBRAVOX_UPDATE_COUNTERS").is_some() {
        let text = serde_json::to_string_pretty(&found).expect("plain numbers") + "\n";
        std::fs::write(&path, text).expect("a writable repository");
        return;
    }
    let text = std::fs::read_to_string(&path).expect("tests/data/counters.json");
    let expected: BTreeMap<String, Counters> = serde_json::from_str(&text).expect("its own form");
    assert!(found.keys().eq(expected.keys()), "other scenes: {found:?}");
    let complaints: Vec<String> = found
        .iter()
        .flat_map(|(name, found)| complaints(name, found, &expected[name], beams))
        .collect();
    assert!(complaints.is_empty(), "\n  {}", complaints.join("\n  "));
}

/// What counts as a regression, whatever the device.
#[test]
fn regressions_are_noticed() {
    let expected = || Counters {
        samples_post: 100_000,
        samples_preintegrated: 100_000,
        samples_beams: 150_000,
        light_samples: 100_000,
        growing_light_samples: 100_000,
        resident_bytes: 100_000,
        uploaded_bytes: 100_000,
    };
    assert!(complaints("same", &expected(), &expected(), true).is_empty());
    let more = Counters {
        samples_post: 100_101,
        light_samples: 99_000,
        uploaded_bytes: 100_001,
        resident_bytes: 101_000,
        ..expected()
    };
    let said = complaints("more", &more, &expected(), true).join("; ");
    for counter in ["samples_post", "light_samples", "uploaded_bytes"] {
        assert!(said.contains(counter), "{said}");
    }
    let without_beams = complaints("without", &expected(), &expected(), false).join("; ");
    assert!(without_beams.contains("samples_beams"), "{without_beams}");
    assert!(
        !said.contains("resident_bytes") && !said.contains("preintegrated"),
        "{said}"
    );
}
