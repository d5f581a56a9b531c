//! What volumes are taken for, and the functions that show them.

use glam::{DAffine3, DVec3};
use umbravox::scene::{ColorManagement, Curve, Guess, Modality, PRESETS, TransferFunction};
use umbravox::volume::{Content, Metadata, Rescale, Volume, Voxels};

const SIZE: u32 = 48;

/// A volume of whole numbers, by the distance from the middle.
fn of_distance(value: impl Fn(f64, usize) -> i16) -> Volume {
    let middle = DVec3::splat(0.5 * f64::from(SIZE - 1));
    let voxels = (0..SIZE.pow(3) as usize).map(|at| {
        let n = SIZE as usize;
        let place = DVec3::new((at % n) as f64, (at / n % n) as f64, (at / n / n) as f64);
        value(place.distance(middle), at)
    });
    Volume::axis_aligned(Voxels::I16(voxels.collect()), [SIZE; 3], [1.0; 3]).unwrap()
}

/// From 0 to 1 where a step at `radius`, blurred by one voxel, lies.
fn inside(distance: f64, radius: f64) -> f64 {
    1.0 / (1.0 + (1.7 * (distance - radius)).exp())
}

/// Repeatable noise from -0.5 to 0.5.
fn noise(at: usize) -> f64 {
    let mut x = (at as u64)
        .wrapping_add(1)
        .wrapping_mul(0x9E37_79B9_7F4A_7C15);
    x ^= x >> 31;
    x = x.wrapping_mul(0xBF58_476D_1CE4_E5B9);
    (x >> 40) as f64 / f64::from(1u32 << 24) - 0.5
}

fn modality(volume: &Volume) -> Modality {
    Guess::of(volume).modality
}

#[test]
fn files_have_the_first_word() {
    let ball = || of_distance(|d, _| (200.0 * inside(d, 15.0)) as i16);
    for (content, expected) in [
        (Content::Mr, Modality::Mr),
        (Content::Labels, Modality::Labels),
        (Content::Microscopy, Modality::Microscopy),
        (Content::Simulation, Modality::Simulation),
        (Content::LevelSet, Modality::LevelSet),
        (Content::Nuclear, Modality::Nuclear),
        (Content::Ultrasound, Modality::Ultrasound),
        // CT that is not in Hounsfield units.
        (Content::Ct, Modality::MicroCt),
    ] {
        let metadata = Metadata {
            content: Some((content, "Key VALUE".into())),
            ..Metadata::default()
        };
        let guess = Guess::of(&ball().with_metadata(metadata));
        assert_eq!(guess.modality, expected);
        assert!(guess.reason.contains("Key VALUE"), "{}", guess.reason);
        assert!(PRESETS.iter().any(|p| p.name == guess.preset));
    }
}

#[test]
fn values_tell_the_rest() {
    let ct = of_distance(|d, at| (-1000.0 + 1100.0 * inside(d, 15.0) + 40.0 * noise(at)) as i16);
    assert_eq!(modality(&ct), Modality::Ct);
    let labels = of_distance(|d, _| [40, 7, 0, 113][(d / 8.0) as usize % 4]);
    assert_eq!(modality(&labels), Modality::Labels);
    let mask = of_distance(|d, _| i16::from(d < 10.0));
    assert_eq!(modality(&mask), Modality::Labels);
    let specimen = of_distance(|d, at| {
        (100.0 + 20.0 * noise(at) + 400.0 * inside(d, 18.0) + 500.0 * inside(d, 8.0)) as i16
    });
    assert_eq!(modality(&specimen), Modality::MicroCt);
    let head = of_distance(|d, at| {
        (5.0 + 10.0 * noise(at) + (150.0 + 60.0 * noise(at)) * inside(d, 20.0)) as i16
    });
    let patient = Metadata {
        content: None,
        patient_axes: true,
        ..Metadata::default()
    };
    assert_eq!(modality(&head.clone().with_metadata(patient)), Modality::Mr);
    assert_ne!(modality(&head), Modality::Mr, "axes of no patient");
    let smooth = of_distance(|d, _| (2000.0 * (-0.02 * d * d).exp()) as i16);
    assert_eq!(modality(&smooth), Modality::Simulation);
    let reals: Vec<f32> = (0..512).map(|i| (i as f32).sin()).collect();
    let reals = Volume::axis_aligned(Voxels::F32(reals), [8; 3], [1.0; 3]).unwrap();
    assert_eq!(modality(&reals), Modality::Simulation);
    // Counts of photons: most are few, some many.
    let photons = of_distance(|_, at| {
        let share = noise(at) + 0.5;
        (-60.0 * (1.0 - share * 0.9999).ln()) as i16
    });
    assert_eq!(modality(&photons), Modality::Microscopy);
}

fn shipped(name: &str) -> Guess {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("data")
        .join(name);
    let volume = umbravox::io::read(&path, &Default::default()).unwrap();
    Guess::of(&volume)
}

#[test]
fn shipped_volumes_are_what_they_are() {
    for (name, expected) in [
        ("ct_aorta_stent.mha", Modality::Ct),
        ("ct_tooth.nrrd", Modality::MicroCt),
        ("sim_fuel_tiny.nii.gz", Modality::Simulation),
    ] {
        let guess = shipped(name);
        assert_eq!(guess.modality, expected, "{name}: {}", guess.reason);
    }
}

fn curve(preset: &str, volume: &Volume) -> Curve {
    let function = TransferFunction {
        preset: Some(preset.into()),
        ..Default::default()
    };
    function.curve(volume, ColorManagement::Linear).unwrap()
}

#[test]
fn boundaries_are_where_materials_meet() {
    // Air at 100, a material at 500, and steps of one voxel's blur between.
    let two = of_distance(|d, at| (100.0 + 400.0 * inside(d, 15.0) + 8.0 * noise(at)) as i16);
    let found = curve("boundaries", &two);
    assert_eq!(found.evaluate(105.0).opacity, 0.0, "inside of the air");
    let middle = found.evaluate(300.0).opacity;
    assert!(middle > 0.5, "{middle}");
    let first = found
        .points
        .iter()
        .find(|p| p.optical.opacity >= 0.5 * middle)
        .unwrap();
    assert!((200.0..=300.0).contains(&first.value), "{}", first.value);
}

#[test]
fn the_boundary_in_front_is_the_fainter_one() {
    let three = of_distance(|d, at| {
        (100.0 + 300.0 * inside(d, 20.0) + 400.0 * inside(d, 9.0) + 8.0 * noise(at)) as i16
    });
    let found = curve("boundaries", &three);
    let (outer, inner) = (found.evaluate(250.0).opacity, found.evaluate(600.0).opacity);
    assert!(outer > 0.05 && inner > 2.0 * outer, "{outer} {inner}");
    let between = found.evaluate(400.0).opacity;
    assert!(
        between < 0.5 * outer,
        "{between} inside of a material, {outer} at its boundary"
    );
}

#[test]
fn every_label_has_a_colour_of_its_own() {
    let labels = of_distance(|d, _| [40, 7, 0, 113][(d / 8.0) as usize % 4]);
    let found = curve("labels", &labels);
    let colors = [7.0, 40.0, 113.0].map(|label| {
        let optical = found.evaluate(label);
        assert!(optical.opacity > 0.9, "{label}");
        optical.color
    });
    assert!(colors[0] != colors[1] && colors[1] != colors[2] && colors[0] != colors[2]);
    for nothing in [0.0, 6.0, 60.0, 200.0] {
        assert_eq!(found.evaluate(nothing).opacity, 0.0, "{nothing}");
    }
}

#[test]
fn many_labels_that_fill_the_volume_are_thinned_out() {
    let cells: Vec<u16> = (0..SIZE.pow(3))
        .map(|at| {
            let [x, y, z] = [at % SIZE, at / SIZE % SIZE, at / SIZE / SIZE].map(|n| n / 6);
            (1 + (x + 8 * (y + 8 * z)) * 173 % 512) as u16
        })
        .collect();
    let volume = Volume::axis_aligned(Voxels::U16(cells), [SIZE; 3], [1.0; 3]).unwrap();
    assert_eq!(modality(&volume), Modality::Labels);
    let found = curve("labels", &volume);
    let shown = (1..=512)
        .filter(|&l| found.evaluate(f64::from(l)).opacity > 0.0)
        .count();
    assert!((20..=90).contains(&shown), "{shown} of 512");
}

#[test]
fn thinned_volumes_stay_where_they_were() {
    let placement = DAffine3::from_scale_rotation_translation(
        DVec3::new(0.5, 1.0, 2.0),
        glam::DQuat::from_rotation_x(0.3),
        DVec3::new(7.0, -3.0, 11.0),
    );
    let voxels = Voxels::U16((0..7 * 8 * 2).collect());
    let volume = Volume::new(voxels, [7, 8, 2], placement, Rescale::default()).unwrap();
    let thinned = volume.thinned(3).unwrap();
    assert_eq!(thinned.size(), [3, 3, 2]);
    for (i, j, k) in [(0, 0, 0), (2, 1, 0), (1, 2, 1)] {
        assert_eq!(thinned.value(i, j, k), volume.value(3 * i, 3 * j, k));
        let [ours, theirs] = [
            thinned
                .world_from_ix()
                .transform_point3(DVec3::new(i.into(), j.into(), k.into())),
            placement.transform_point3(DVec3::new((3 * i).into(), (3 * j).into(), k.into())),
        ];
        assert!(ours.distance(theirs) < 1e-12);
    }
}

/// Whatever their luminance looks like.
#[test]
fn colors_are_colors() {
    let volume = Volume::axis_aligned(Voxels::U8(vec![0, 1, 2, 3, 1, 1, 2, 2]), [2; 3], [1.0; 3]);
    let colors = vec![[9, 8, 7, 255]; 8];
    let volume = volume.unwrap().with_colors(Some(colors)).unwrap();
    let guess = Guess::of(&volume);
    assert_eq!((guess.modality, guess.preset), (Modality::Color, "colors"));
    let clone = volume.clone().with_colors(Some(vec![[0; 4]; 7]));
    assert!(clone.is_err(), "one colour is missing");
    assert_ne!(
        volume.fingerprint(),
        volume.clone().with_colors(None).unwrap().fingerprint()
    );
}
