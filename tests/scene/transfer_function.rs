//! Curves that transfer functions resolve to.

use umbravox::scene::{ColorManagement, Curve, PRESETS, TransferFunction, linear_from_srgb};
use umbravox::volume::{Volume, Voxels};

use crate::{MINIMAL, set};

fn grid(spacing: [f64; 3]) -> Volume {
    Volume::axis_aligned(Voxels::U8(vec![0; 8]), [2; 3], spacing).unwrap()
}

fn curve(function: TransferFunction, volume: &Volume) -> Curve {
    function.curve(volume, ColorManagement::Linear).unwrap()
}

fn assert_ready(curve: &Curve) {
    assert!(!curve.points.is_empty());
    assert!(curve.unit_distance > 0.0);
    assert!(curve.points.windows(2).all(|w| w[0].value <= w[1].value));
    for point in &curve.points {
        assert!((0.0..=1.0).contains(&point.optical.opacity));
        assert!(point.optical.color.iter().all(|c| (0.0..=1.0).contains(c)));
    }
}

#[test]
fn explicit_points_are_decoded_and_refer_to_one_millimetre() {
    let scene = set(
        MINIMAL,
        &[r#"transfer_function.points=[{"value":5,"color":[0.5,0,1],"opacity":0.25,"emission":[2,0,0]}]"#],
    )
    .unwrap();
    let volume = grid([1.0; 3]);
    let linear = curve(scene.transfer_function.clone(), &volume);
    assert_eq!(linear.unit_distance, 1.0);
    assert_eq!(
        linear.points[0].optical.color,
        [linear_from_srgb(0.5), 0.0, 1.0]
    );
    assert_eq!(
        linear.points[0].optical.emission,
        [linear_from_srgb(2.0), 0.0, 0.0]
    );
    let raw = scene
        .transfer_function
        .curve(&volume, ColorManagement::None)
        .unwrap();
    assert_eq!(raw.points[0].optical.color, [0.5, 0.0, 1.0]);
}

#[test]
fn presets_are_valid_and_follow_the_spacing() {
    let volume = grid([0.5, 0.75, 2.0]);
    for preset in PRESETS.iter() {
        let function = TransferFunction {
            preset: Some(preset.name.into()),
            ..Default::default()
        };
        let curve = curve(function, &volume);
        assert_ready(&curve);
        assert_eq!(curve.unit_distance, 0.5);
        // Air around the patient is invisible in each of them.
        if preset.fixed_points().is_some() {
            assert_eq!(curve.evaluate(-1000.0).opacity, 0.0, "{}", preset.name);
        }
    }
    let given = TransferFunction {
        preset: Some("ct-bone".into()),
        unit_distance: Some(3.0),
        ..Default::default()
    };
    assert_eq!(curve(given, &volume).unit_distance, 3.0);
}

/// A dark noisy background, a body of medium and a core of high values.
fn phantom(value: impl Fn(usize) -> i16) -> Volume {
    let voxels = (0..32 * 32 * 32).map(value).collect();
    Volume::axis_aligned(Voxels::I16(voxels), [32; 3], [1.0; 3]).unwrap()
}

#[test]
fn hounsfield_data_get_a_ct_function() {
    let ct = phantom(|i| if i % 10 == 0 { 1200 } else { -1000 });
    let bone = TransferFunction {
        preset: Some("ct-bone".into()),
        ..Default::default()
    };
    assert_eq!(curve(TransferFunction::default(), &ct), curve(bone, &ct));
}

#[test]
fn tissue_gets_a_ramp_above_the_background() {
    let mr = phantom(|i| match i % 10 {
        0..=6 => (i % 17) as i16,
        7 | 8 => 300 + (i % 97) as i16,
        _ => 900,
    });
    let ramp = TransferFunction {
        preset: Some("mr-default".into()),
        ..Default::default()
    };
    for function in [ramp.clone(), TransferFunction::default()] {
        let curve = curve(function, &mr);
        assert_ready(&curve);
        for background in [0.0, 8.0, 16.0] {
            assert_eq!(curve.evaluate(background).opacity, 0.0, "{background}");
        }
    }
    let curve = curve(ramp, &mr);
    assert!(curve.evaluate(350.0).opacity > 0.0);
    assert!(curve.evaluate(900.0).opacity > 2.0 * curve.evaluate(350.0).opacity);
}

#[test]
fn unusual_data_get_a_usable_function() {
    let constant = phantom(|_| 5);
    let bright_background = phantom(|i| if i % 10 == 0 { i as i16 % 100 } else { 1000 });
    let two_values = phantom(|i| (i % 2) as i16);
    for volume in [constant, bright_background, two_values] {
        let curve = curve(TransferFunction::default(), &volume);
        assert_ready(&curve);
        let [_, highest] = volume.value_range();
        assert!(curve.evaluate(highest).opacity > 0.0);
    }
}

/// Opacity of a straight way through values, `(from, to, length in mm)`.
fn opacity(curve: &Curve, [from, to, length]: [f64; 3]) -> f64 {
    const STEPS: u32 = 1000;
    let depth: f64 = (0..STEPS)
        .map(|i| from + (to - from) * (f64::from(i) + 0.5) / f64::from(STEPS))
        .map(|value| -(1.0 - curve.evaluate(value).opacity).ln())
        .sum();
    1.0 - (-depth * length / f64::from(STEPS) / curve.unit_distance).exp()
}

#[test]
fn lungs_are_seen_through_the_skin() {
    let function = TransferFunction {
        preset: Some("ct-lung".into()),
        ..TransferFunction::default()
    };
    let curve = curve(function, &grid([0.8; 3]));
    // The border between air and skin is two voxels wide, and so is that of a vessel.
    let [skin, muscle, lung] = [
        [-1000.0, 40.0, 1.6],
        [0.0, 60.0, 100.0],
        [-820.0, -780.0, 100.0],
    ];
    let seen = opacity(&curve, skin);
    assert!(seen < 0.05, "skin: {seen}");
    assert_eq!(opacity(&curve, muscle), 0.0);
    let seen = opacity(&curve, lung);
    assert!(seen > 0.8, "lung: {seen}");
}
