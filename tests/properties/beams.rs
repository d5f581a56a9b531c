//! Beams change no bit, whatever rays they stand for.

use std::sync::Arc;

use glam::{DAffine3, DMat3, DVec3};
use umbravox::picture::Picture;
use umbravox::renderer::Settings;
use umbravox::scene::{Camera, Classification, Interpolation, RayProjection, Scene, Shading};
use umbravox::volume::{Rescale, Volume, Voxels};

use crate::bits::differing;
use crate::sessions::{Subject, assert_valid, device, point, shown};

const EDGE: u32 = 50;

/// Small balls far apart, and a wall of one voxel.
fn balls() -> Volume {
    let voxels = (0..EDGE.pow(3))
        .map(|i| [i % EDGE, i / EDGE % EDGE, i / (EDGE * EDGE)].map(f64::from))
        .map(|p| {
            let ball = |center: [f64; 3]| {
                let squares = (0..3).map(|axis| (p[axis] - center[axis]).powi(2));
                squares.sum::<f64>().sqrt() < 2.5
            };
            let balls = [[8.0, 9.0, 10.0], [40.0, 12.0, 30.0], [25.0, 41.0, 44.0]];
            let shown = balls.into_iter().any(ball) || (p[0] == 30.0 && p[1] > 30.0);
            if shown { 255 } else { 0 }
        })
        .collect();
    Volume::axis_aligned(Voxels::U8(voxels), [EDGE; 3], [1.0, 1.1, 0.9]).unwrap()
}

fn seen_from(camera: Camera) -> Subject {
    let points = vec![
        point(60.0, [0.2, 0.5, 0.9], 0.0),
        point(200.0, [0.9, 0.3, 0.1], 0.3),
        point(255.0, [0.9, 0.8, 0.4], 0.5),
    ];
    // Neither edge is a whole number of beams.
    Subject::new(balls(), camera, [101, 67], 1.0, points)
}

/// Name, and what is changed of the plain scene.
type Change = (&'static str, fn(&mut Scene));

const CHANGES: [Change; 10] = [
    ("post", |s| {
        s.march.classification = Some(Classification::Post)
    }),
    ("pre", |s| {
        s.march.classification = Some(Classification::Pre)
    }),
    ("preintegrated", |s| {
        s.march.classification = Some(Classification::Preintegrated);
    }),
    ("jitter", |s| {
        s.march.jitter = true;
        s.march.classification = Some(Classification::Post);
    }),
    ("jitter, preintegrated", |s| s.march.jitter = true),
    // More bits than are found at once.
    ("400 segments", |s| s.march.step = 0.2),
    // Bits stand for more segments than the shortest.
    ("2000 segments", |s| s.march.step = 0.04),
    ("long steps", |s| s.march.step = 3.0),
    ("shaded", |s| s.lighting.shading = Shading::Diffuse),
    ("xray", |s| s.march.projection = RayProjection::Xray),
];

#[test]
fn beams_change_no_bit() {
    let device = device(|_| {});
    let small_tiles = self::device(|options| options.tile = Some(24));
    let target = [24.0, 26.0, 22.0];
    let up = [0.0, 0.0, 1.0];
    let perspective = |eye: [f64; 3]| Camera::Perspective {
        eye,
        target,
        up,
        fov_y: 50.0,
    };
    let along_an_axis = Camera::Orthographic {
        eye: [-90.0, 26.0, 22.0],
        target,
        up,
        height: 60.0,
    };
    let cameras = [
        ("framed", Camera::default()),
        ("along an axis", along_an_axis),
        ("inside", perspective([20.0, 15.0, 18.0])),
        ("oblique", perspective([90.0, -70.0, 60.0])),
        // Partly outside the picture.
        (
            "beside",
            Camera::Perspective {
                eye: [24.0, -60.0, 30.0],
                target: [52.0, 26.0, 44.0],
                up,
                fov_y: 30.0,
            },
        ),
    ];
    for (from, camera) in cameras {
        for (what, change) in CHANGES {
            let subject = seen_from(camera.clone()).with(change);
            let expected = subject
                .with(|scene| scene.march.beams = false)
                .picture(&device);
            assert!(shown(&expected) > 10.0, "{from}, {what}");
            for device in [&device, &small_tiles] {
                let picture = subject.picture(device);
                assert_eq!(differing(&picture, &expected), 0, "{from}, {what}");
                let cast = picture.samples != expected.samples;
                let processor = device.device().device_type == "cpu";
                assert_eq!(cast, processor, "{from}, {what}: beams");
            }
        }
    }
    assert_valid(&device);
    assert_valid(&small_tiles);
}

/// Clouds without edges: where a block is coarse or missing, its neighbours show something up to their faces.
fn clouds() -> Volume {
    let voxels = (0..EDGE.pow(3))
        .map(|i| [i % EDGE, i / EDGE % EDGE, i / (EDGE * EDGE)].map(f64::from))
        .map(|[x, y, z]| {
            let waves = (0.21 * x).sin() * (0.17 * y + 1.0).sin() * (0.19 * z + 2.0).sin();
            (127.5 + 127.5 * waves) as u8
        })
        .collect();
    Volume::axis_aligned(Voxels::U8(voxels), [EDGE; 3], [1.0, 1.1, 0.9]).unwrap()
}

/// Runs of beams go on from brick to brick, and through places without one.
#[test]
fn beams_change_no_bit_where_levels_mix() {
    let device = device(|_| {});
    let plain = Subject {
        volume: Arc::new(clouds()),
        ..seen_from(Camera::default())
    };
    let inside = Camera::Perspective {
        eye: [20.0, 15.0, 18.0],
        target: [24.0, 26.0, 22.0],
        up: [0.0, 0.0, 1.0],
        fov_y: 50.0,
    };
    let (mut mixed, mut dropped, mut cast) = (0, 0, 0);
    for camera in [Camera::default(), inside] {
        for data_reduction in [8.0, 30.0, 3000.0] {
            for classification in [
                Classification::Pre,
                Classification::Post,
                Classification::Preintegrated,
            ] {
                for (step, jitter) in [(1.0, false), (0.8, true), (3.0, false)] {
                    let subject = plain.with(|scene| {
                        scene.camera = camera.clone();
                        scene.storage.data_reduction = data_reduction;
                        scene.march.classification = Some(classification);
                        scene.march.step = step;
                        scene.march.jitter = jitter;
                    });
                    let what = format!("{data_reduction}, {classification:?}, step {step}");
                    let mut session = subject.session(&device);
                    let picture = session.frame().unwrap();
                    let blocks = session.stats().unwrap().blocks;
                    mixed += usize::from(blocks.by_level.iter().filter(|&&n| n > 0).count() > 1);
                    dropped += blocks.dropped;
                    let expected = subject.with(|scene| scene.march.beams = false);
                    let expected = expected.picture(&device);
                    assert!(shown(&expected) > 10.0, "{what}");
                    assert_eq!(differing(&picture, &expected), 0, "{what}");
                    cast += usize::from(picture.samples != expected.samples);
                }
            }
        }
    }
    assert!(mixed > 10, "{mixed} of several levels");
    assert!(dropped > 10, "{dropped} blocks dropped");
    let processor = device.device().device_type == "cpu";
    assert_eq!(cast > 10, processor, "{cast} with beams");
    assert_valid(&device);
}

#[test]
fn where_nothing_shows_there_is_background() {
    let device = device(|_| {});
    let looks_away = Camera::Perspective {
        eye: [24.0, -60.0, 22.0],
        target: [24.0, -90.0, 22.0],
        up: [0.0, 0.0, 1.0],
        fov_y: 30.0,
    };
    let blank = |scene: &mut Scene| {
        let points = scene.transfer_function.points.iter_mut().flatten();
        points.for_each(|point| point.opacity = 0.0);
    };
    for subject in [
        seen_from(looks_away),
        seen_from(Camera::default()).with(blank),
    ] {
        let picture = subject.picture(&device);
        let expected = subject
            .with(|scene| scene.march.beams = false)
            .picture(&device);
        assert_eq!(differing(&picture, &expected), 0);
        assert_eq!(shown(&picture), 0.0);
        if device.device().device_type == "cpu" {
            assert!(picture.samples.iter().all(|&samples| samples == 0));
        }
    }
    assert_valid(&device);
}

/// A camera so near that pixels are less than a voxel apart.
fn near() -> Camera {
    Camera::Orthographic {
        eye: [100.0, -70.0, 60.0],
        target: [24.0, 26.0, 22.0],
        up: [0.0, 0.0, 1.0],
        height: 34.0,
    }
}

/// The same volume in floats, of which beams know nothing finer than skip cells.
fn in_floats(subject: &Subject) -> Subject {
    let volume = &subject.volume;
    let Voxels::U8(voxels) = volume.voxels() else {
        panic!("8-bit voxels");
    };
    let voxels = Voxels::F32(voxels.iter().map(|&v| f32::from(v)).collect());
    let world_from_ix = volume.world_from_ix();
    let volume = Volume::new(voxels, volume.size(), world_from_ix, Rescale::default());
    Subject {
        volume: Arc::new(volume.unwrap()),
        scene: subject.scene.clone(),
    }
}

#[test]
fn cells_between_voxels_spare_samples_and_change_no_bit() {
    let device = device(|_| {});
    let processor = device.device().device_type == "cpu";
    for (what, change) in CHANGES {
        let subject = seen_from(near()).with(change);
        let expected = subject
            .with(|scene| scene.march.beams = false)
            .picture(&device);
        assert!(shown(&expected) > 10.0, "{what}");
        let picture = subject.picture(&device);
        assert_eq!(differing(&picture, &expected), 0, "{what}");
        let taken = |picture: &Picture| picture.samples.iter().sum::<u32>();
        let [taken, coarsely] = [&picture, &in_floats(&subject).picture(&device)].map(taken);
        // Rays of more than 2048 segments have bits for several at a time.
        let singly = processor && what != "2000 segments";
        let spared = f64::from(taken) < 0.9 * f64::from(coarsely);
        assert_eq!(spared, singly, "{what}: {taken} samples, {coarsely}");
    }
    assert_valid(&device);
}

/// In blocks of which every skip cell shows something beams look up nothing finer.
#[test]
fn beams_through_whole_blocks_change_no_bit() {
    let device = device(|_| {});
    let balls = balls();
    let Voxels::U8(voxels) = balls.voxels() else {
        panic!("8-bit voxels");
    };
    // With one voxel that shows something in every skip cell of a part of it.
    let mut voxels = voxels.clone();
    for (i, value) in (0..).zip(voxels.iter_mut()) {
        let [x, y, z] = [i % EDGE, i / EDGE % EDGE, i / (EDGE * EDGE)];
        if x < 24 && [x, y, z].iter().all(|at| at % 4 == 2) {
            *value = 255;
        }
    }
    let volume = Volume::axis_aligned(Voxels::U8(voxels), [EDGE; 3], balls.spacing()).unwrap();
    let volume = Arc::new(volume);
    let along_y = Camera::Orthographic {
        eye: [12.0, -90.0, 22.0],
        target: [12.0, 26.0, 22.0],
        up: [0.0, 0.0, 1.0],
        height: 30.0,
    };
    for camera in [along_y, near()] {
        for (what, change) in CHANGES {
            let subject = Subject {
                volume: Arc::clone(&volume),
                ..seen_from(camera.clone())
            };
            let subject = subject.with(change);
            let expected = subject
                .with(|scene| scene.march.beams = false)
                .picture(&device);
            assert!(shown(&expected) > 10.0, "{what}");
            let picture = subject.picture(&device);
            assert_eq!(differing(&picture, &expected), 0, "{what}");
        }
    }
    assert_valid(&device);
}

/// Another transfer function shows other cells; what is dear asks for them where others do not.
#[test]
fn edits_look_cells_up_anew() {
    let device = device(|_| {});
    let plain = seen_from(near());
    let dense = plain.with(|scene| {
        scene.transfer_function.points = Some(vec![
            point(0.0, [0.1, 0.1, 0.1], 0.0),
            point(2.0, [0.2, 0.5, 0.9], 0.01),
            point(255.0, [0.9, 0.8, 0.4], 0.5),
        ]);
    });
    let shaded = plain.with(|scene| scene.lighting.shading = Shading::Diffuse);
    let cubic = plain.with(|scene| scene.march.interpolation = Interpolation::Bspline);
    let without = plain.with(|scene| scene.march.beams = false);
    let mut session = plain.session(&device);
    for (step, subject) in [
        &plain, &dense, &shaded, &cubic, &plain, &without, &dense, &plain,
    ]
    .into_iter()
    .enumerate()
    {
        let settings = Settings::of_scene(&subject.scene, &subject.volume).unwrap();
        session.set_settings(settings).unwrap();
        let picture = session.frame().unwrap();
        let expected = subject.picture(&device);
        assert_eq!(differing(&picture, &expected), 0, "edit {step}");
        assert_eq!(picture.samples, expected.samples, "edit {step}");
    }
    assert_valid(&device);
}

/// Where nothing shows a picture is what its image was cleared to, not what was drawn there before; with depths and without.
#[test]
fn nothing_shows_through_from_the_picture_before() {
    let device = device(|_| {});
    let near = Camera::Orthographic {
        eye: [24.0, -90.0, 22.0],
        target: [24.0, 26.0, 22.0],
        up: [0.0, 0.0, 1.0],
        height: 30.0,
    };
    for projection in [RayProjection::Composite, RayProjection::Xray] {
        let far = seen_from(Camera::default()).with(|scene| scene.march.projection = projection);
        let expected = far.picture(&device);
        let view = far.scene.camera.view(&far.volume, far.scene.image.size);
        let mut session = far
            .with(|scene| scene.camera = near.clone())
            .session(&device);
        let before = session.frame().unwrap();
        assert!(differing(&before, &expected) > 500);
        session.set_view(view.unwrap());
        session.timed_frame().unwrap();
        let samples = session.stats().unwrap().samples.taken;
        let picture = session.frame().unwrap();
        assert_eq!(differing(&picture, &expected), 0, "{projection:?}");
        let counted: f64 = picture.samples.iter().map(|&n| f64::from(n)).sum();
        assert_eq!(samples as f64, counted, "{projection:?}");
    }
    assert_valid(&device);
}

/// Along the long diagonal of a sheared volume rays are longer than its edges tell.
#[test]
fn bits_reach_to_the_far_corner_of_sheared_volumes() {
    let device = device(|_| {});
    let axes = DMat3::from_cols(DVec3::X, DVec3::Y, DVec3::new(0.0, 0.8, 0.9));
    let world_from_ix = DAffine3::from_mat3_translation(axes, DVec3::ZERO);
    let voxels = (0..EDGE.pow(3))
        .map(|i| [i % EDGE, i / EDGE % EDGE, i / (EDGE * EDGE)])
        .map(|p| if p.iter().all(|&i| i > 45) { 255 } else { 0 })
        .collect();
    let volume = Volume::new(
        Voxels::U8(voxels),
        [EDGE; 3],
        world_from_ix,
        Rescale::default(),
    )
    .unwrap();
    let corner = world_from_ix.transform_point3(DVec3::splat(f64::from(EDGE - 1)));
    let camera = Camera::Orthographic {
        eye: (-0.5 * corner).to_array(),
        target: corner.to_array(),
        up: [0.0, 0.0, 1.0],
        height: 30.0,
    };
    let points = vec![
        point(60.0, [0.2, 0.5, 0.9], 0.0),
        point(255.0, [0.9, 0.8, 0.4], 0.5),
    ];
    // 126 segments by the lengths of the edges, a word and a bit less than two in truth.
    let subject =
        Subject::new(volume, camera, [40, 30], 1.0, points).with(|scene| scene.march.step = 0.75);
    let picture = subject.picture(&device);
    let expected = subject
        .with(|scene| scene.march.beams = false)
        .picture(&device);
    assert!(shown(&expected) > 1.0);
    assert_eq!(differing(&picture, &expected), 0);
    assert_valid(&device);
}
