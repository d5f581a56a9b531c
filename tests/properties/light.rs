//! Edits give what a fresh session gives; the camera never touches the light.

use umbravox::embed::Settings;
use umbravox::headless::Session;
use umbravox::scene::{AmbientOcclusion, Camera, Interpolation, Scene, Shading};
use umbravox::volume::{Volume, Voxels};

use crate::random::subject;
use crate::sessions::{Subject, assert_valid, device, point, shown};

type Edit = fn(&mut Scene);

/// A random scene with light.
fn lit() -> Subject {
    let seeds = 0..;
    seeds
        .map(subject)
        .find(|s| {
            let whole = s.volume.size().iter().all(|&n| n >= 17);
            whole && s.scene.ambient_occlusion.is_some() && s.scene.storage.data_reduction == 1.0
        })
        .expect("one of the first dozens")
        .with(|scene| {
            scene.march.jitter = false;
            scene.transfer_function.points = Some(vec![
                point(0.3, [0.2, 0.4, 0.9], 0.0),
                point(0.7, [0.9, 0.8, 0.3], 0.5),
            ]);
        })
}

fn complete(session: &mut Session) {
    while session.refine_light().unwrap() {}
}

fn traced(session: &mut Session) -> u32 {
    session.stats().unwrap().lao.expect("light is on").rays
}

#[test]
fn edits_give_the_bytes_of_a_fresh_session() {
    let device = device(|_| {});
    let start = lit();
    let mut session = start.session(&device);
    let mut current = start.clone();
    let edits: [(&str, Edit); 9] = [
        ("more is transparent", |s| {
            s.transfer_function.points.as_mut().expect("explicit")[0].value = 0.5;
        }),
        ("less is transparent", |s| {
            s.transfer_function.points.as_mut().expect("explicit")[0].value = 0.1;
        }),
        ("a jump", |s| {
            let points = s.transfer_function.points.as_mut().expect("explicit");
            points.insert(1, point(0.1, [1.0; 3], 0.8));
        }),
        ("emission", |s| {
            s.transfer_function.points.as_mut().expect("explicit")[0].emission = [0.0, 0.3, 0.1];
        }),
        ("coarser levels", |s| s.storage.data_reduction = 6.0),
        ("no light", |s| s.ambient_occlusion = None),
        ("other light", |s| {
            s.ambient_occlusion = Some(AmbientOcclusion {
                rays: 2,
                radius: 5.0,
                ..Default::default()
            });
        }),
        ("finest levels", |s| s.storage.data_reduction = 1.0),
        ("shading", |s| {
            s.lighting.shading = Shading::Diffuse;
            s.march.interpolation = Interpolation::Nearest;
            s.march.step = 0.7;
        }),
    ];
    for (name, edit) in edits {
        current = current.with(edit);
        // Interrupted, so that what is left over of the light before would show.
        session.refine_light().unwrap();
        let settings = Settings::of_scene(&current.scene, &current.volume).unwrap();
        session.set_settings(settings).unwrap();
        complete(&mut session);
        let mut fresh = current.session(&device);
        let (edited, expected) = (session.frame().unwrap(), fresh.frame().unwrap());
        assert!(shown(&expected) > 1.0, "{name}");
        assert!(edited == expected, "{name}: pictures differ");
        if current.scene.ambient_occlusion.is_some() {
            let (edited, expected) = (
                session.light_volume().unwrap(),
                fresh.light_volume().unwrap(),
            );
            assert!(edited.rgba == expected.rgba, "{name}: light differs");
        }
    }
    assert_valid(&device);
}

/// Work on the host grows with the volume, not with the step.
#[test]
fn steps_of_any_length_are_lit() {
    let device = device(|_| {});
    let lit = |step: f64| {
        let volume = Volume::axis_aligned(Voxels::U8(vec![200; 20 * 20 * 20]), [20; 3], [1.0; 3]);
        let points = vec![point(0.0, [1.0; 3], 0.0), point(255.0, [1.0; 3], 0.9)];
        let subject = Subject::new(volume.unwrap(), Camera::default(), [16, 16], 1.0, points);
        let subject = subject.with(|scene| {
            scene.march.step = step;
            scene.ambient_occlusion = Some(AmbientOcclusion {
                rays: 2,
                ..Default::default()
            });
        });
        shown(&subject.picture(&device))
    };
    assert!(lit(1e3) > 10.0);
    // What this long a step shows rounds to nothing; it took hours.
    assert!(lit(1e9) < 10.0);
    assert_valid(&device);
}

#[test]
fn only_what_changes_the_light_restarts_it() {
    let device = device(|_| {});
    let start = lit().with(|s| {
        s.ambient_occlusion = Some(AmbientOcclusion {
            rays: 4,
            ..Default::default()
        });
    });
    let view = start
        .scene
        .camera
        .view(&start.volume, start.scene.image.size)
        .unwrap();
    let mut session = device.load(start.volume.clone(), &start.scene).unwrap();
    // Half-way.
    for _ in 0..2 {
        assert!(session.refine_light().unwrap());
    }
    session.set_view(view.orbited(&start.volume, 30.0));
    session.frame().unwrap();
    assert_eq!(traced(&mut session), 2);
    // To the end, and back to where it was.
    complete(&mut session);
    assert_eq!(traced(&mut session), 4);
    for degrees in [-80.0, 10.0, 0.0] {
        session.set_view(view.orbited(&start.volume, degrees));
        session.frame().unwrap();
        assert!(!session.refine_light().unwrap(), "the camera moved");
        assert_eq!(traced(&mut session), 4);
    }
    assert!(session.frame().unwrap() == start.picture(&device));

    let mut change = |name: &str, restarts: bool, edit: fn(&mut Settings)| {
        complete(&mut session);
        let mut settings = session.settings().clone();
        edit(&mut settings);
        session.set_settings(settings).unwrap();
        let expected = if restarts { 0 } else { 4 };
        assert_eq!(traced(&mut session), expected, "{name}");
    };
    change("step", false, |s| s.march.step = 0.8);
    change("termination", false, |s| s.march.early_termination = 0.9);
    change("skipping", false, |s| s.march.empty_space_skipping = false);
    change("shading", false, |s| s.lighting.shading = Shading::Diffuse);
    change("bias", false, |s| {
        s.ambient_occlusion.as_mut().expect("on").bias = 0.3;
    });
    change("more memory", false, |s| {
        s.storage.memory_budget_mib = 4096.0
    });
    change("transfer function", true, |s| {
        s.curve.points[1].optical.opacity = 0.7;
    });
    change("levels", true, |s| s.storage.data_reduction = 8.0);
    change("radius", true, |s| {
        s.ambient_occlusion.as_mut().expect("on").radius = 4.0;
    });
    assert_valid(&device);
}
