//! Limits whose answer is known without computing: nothing to see, opaque matter, light that nothing can change.

use umbravox::scene::{AmbientOcclusion, linear_from_srgb};

use crate::random::subject;
use crate::sessions::{assert_valid, device, point, shown, span};

/// In voxels. The first is far below the unit distance of some scenes, so that a step of anything but opaque matter would be
/// nearly clear; with the last, many rays leave before a whole step.
const STEPS: [f64; 2] = [0.02, 3.0];

#[test]
fn transparent_volumes_are_exactly_nothing() {
    let device = device(|_| {});
    for seed in 100..112 {
        let clear = subject(seed).with(|scene| {
            scene.transfer_function.points = Some(vec![point(0.5, [1.0; 3], 0.0)]);
        });
        for skipping in [true, false] {
            let clear = clear.with(|scene| scene.march.empty_space_skipping = skipping);
            let picture = clear.picture(&device);
            assert!(picture.rgba.iter().all(|p| *p == [0.0; 4]), "case {seed}");
            assert!(
                picture.depth.iter().all(|d| *d == f32::INFINITY),
                "case {seed}"
            );
            if skipping {
                // The last segment of a ray is not skipped.
                assert!(picture.samples.iter().all(|n| *n <= 1), "case {seed}");
            }
        }
    }
    assert_valid(&device);
}

/// The first sample hides all others, however short it is: its colour, its depth, one sample.
#[test]
fn opaque_volumes_end_rays_at_the_first_sample() {
    let device = device(|_| {});
    let color = [0.9, 0.5, 0.2];
    let linear = color.map(|c| linear_from_srgb(c) as f32);
    let mut hits = 0;
    for (seed, step) in (120..132).flat_map(|seed| STEPS.map(|step| (seed, step))) {
        let opaque = subject(seed).with(|scene| {
            scene.transfer_function.points = Some(vec![point(0.5, color, 1.0)]);
            scene.lighting = Default::default();
            scene.ambient_occlusion = None;
            scene.march.jitter = false;
            scene.march.step = step;
        });
        let picture = opaque.picture(&device);
        let step = step * opaque.volume.min_spacing();
        let view = opaque
            .scene
            .camera
            .view(&opaque.volume, picture.size)
            .unwrap();
        let width = picture.size[0] as usize;
        assert!(shown(&picture) >= 1.0, "case {seed}");
        for (pixel, rgba) in picture.rgba.iter().enumerate() {
            if picture.samples[pixel] == 0 {
                assert_eq!(*rgba, [0.0; 4]);
                assert_eq!(picture.depth[pixel], f32::INFINITY);
                continue;
            }
            assert_eq!(picture.samples[pixel], 1, "case {seed}, pixel {pixel}");
            assert_eq!(rgba[3], 1.0, "case {seed}, pixel {pixel}");
            for (actual, expected) in rgba.iter().zip(linear) {
                assert!((actual - expected).abs() <= 1e-6, "case {seed}");
            }
            // The middle of the first step, or of all there is of a ray that leaves before.
            let [x, y] = [pixel % width, pixel / width].map(|p| p as f64 + 0.5);
            let [enter, exit] = span(&opaque.volume, view.ray([x, y], picture.size))
                .expect("rays with samples meet the field");
            let expected = enter + 0.5 * step.min(exit - enter);
            let depth = f64::from(picture.depth[pixel]);
            let slack = 1e-5 * exit;
            assert!(
                (depth - expected).abs() <= slack,
                "case {seed}, pixel {pixel}: {depth}, not {expected}"
            );
            hits += 1;
        }
    }
    assert!(hits > 1000, "{hits} pixels show something");
    assert_valid(&device);
}

/// Ambient occlusion that cannot darken or that is no light at all.
#[test]
fn limits_of_ambient_occlusion() {
    let device = device(|_| {});
    let unlit = subject(7).with(|scene| {
        scene.ambient_occlusion = None;
        scene.march.jitter = false;
        scene.lighting = Default::default();
        scene.transfer_function.points = Some(vec![
            point(0.2, [0.2, 0.4, 0.9], 0.0),
            point(0.8, [0.9, 0.8, 0.3], 0.9),
        ]);
    });
    let plain = unlit.picture(&device);
    assert!(shown(&plain) > 10.0);
    let with = |ao: AmbientOcclusion| {
        unlit
            .with(|scene| scene.ambient_occlusion = Some(ao))
            .picture(&device)
    };
    let some = AmbientOcclusion {
        rays: 3,
        radius: 6.0,
        ..Default::default()
    };

    let no_contrast = with(AmbientOcclusion {
        gamma: 0.0,
        ..some.clone()
    });
    // One sample a ray, which nothing lies before.
    let tiny = with(AmbientOcclusion {
        radius: 1.01,
        ..some.clone()
    });
    for (name, picture) in [("gamma 0", &no_contrast), ("a tiny radius", &tiny)] {
        let pairs = picture
            .rgba
            .iter()
            .flatten()
            .zip(plain.rgba.iter().flatten());
        let worst = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(worst <= 1e-6, "{name}: {worst:e}");
    }

    let dark = with(AmbientOcclusion {
        weights: Some(vec![0.0; 3]),
        ..some.clone()
    });
    for (dark, plain) in dark.rgba.iter().zip(&plain.rgba) {
        assert_eq!(dark[..3], [0.0; 3], "weights of 0 are no light");
        assert_eq!(dark[3], plain[3], "light does not change opacity");
    }

    // All light from the bias.
    let bias = with(AmbientOcclusion {
        weights: Some(vec![0.0; 3]),
        bias: 0.5,
        ..some.clone()
    });
    for (bias, plain) in bias.rgba.iter().zip(&plain.rgba) {
        for i in 0..3 {
            assert!((bias[i] - 0.5 * plain[i]).abs() <= 1e-6);
        }
    }

    // Between darkness and full light.
    let occluded = with(some);
    assert!(shown(&occluded) == shown(&plain));
    let sum = |picture: &umbravox::picture::Picture| -> f32 {
        picture.rgba.iter().map(|p| p[0] + p[1] + p[2]).sum()
    };
    assert!(0.0 < sum(&occluded) && sum(&occluded) < 0.95 * sum(&plain));
    assert_valid(&device);
}

/// Jitter moves samples, but never makes segments of a negative length: rays that miss stay empty, opacities stay opacities,
/// and in a homogeneous medium nothing changes.
#[test]
fn jitter_keeps_opacity() {
    let device = device(|_| {});
    for seed in 140..152 {
        let plain = subject(seed).with(|scene| {
            scene.transfer_function.points = Some(vec![point(0.5, [0.8; 3], 0.3)]);
            scene.lighting = Default::default();
            scene.ambient_occlusion = None;
            scene.march.early_termination = 1.0;
            scene.march.jitter = false;
            scene.march.step = 2.0;
        });
        let jittered = plain.with(|scene| scene.march.jitter = true);
        let (plain, jittered) = (plain.picture(&device), jittered.picture(&device));
        let pixels = plain.rgba.iter().zip(&jittered.rgba);
        for (pixel, (a, b)) in pixels.enumerate() {
            for (a, b) in a.iter().zip(b) {
                assert!((a - b).abs() < 1e-5, "case {seed}, pixel {pixel}: {a} {b}");
            }
        }
        assert!(plain != jittered || shown(&plain) == 0.0);
    }
    assert_valid(&device);
}
