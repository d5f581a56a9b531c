//! Labels follow edits, and change nothing where they neither hide nor colour.

use std::sync::Arc;

use umbravox::embed::Settings;
use umbravox::headless::Session;
use umbravox::scene::{LabelSource, LabelStyle, Labels};
use umbravox::volume::{LabelMap, Volume, Voxels};

use crate::random::subject;
use crate::sessions::{Subject, assert_valid, device, point, shown};

/// A random scene with light whose volume has two labels beside the background, in slabs along its longest axis.
fn labelled() -> Subject {
    let start = (0..)
        .map(subject)
        .find(|s| s.scene.ambient_occlusion.is_some() && s.volume.voxels().len() > 4000)
        .expect("one of the first dozens")
        .with(|scene| {
            scene.march.jitter = false;
            scene.transfer_function.points = Some(vec![
                point(0.3, [0.2, 0.4, 0.9], 0.0),
                point(0.7, [0.9, 0.8, 0.3], 0.5),
            ]);
        });
    let volume = (*start.volume).clone();
    let map = slabs(&volume, [0, 3, 8]);
    Subject {
        volume: Arc::new(volume.with_labels(Some(map)).unwrap()),
        ..start
    }
}

/// Thirds of the voxels in the order of the file, each with a label.
fn slabs(volume: &Volume, labels: [u8; 3]) -> Arc<LabelMap> {
    let count = volume.voxels().len();
    let voxels = (0..count).map(|at| labels[3 * at / count]).collect();
    let placement = volume.world_from_ix();
    let grid = Volume::new(
        Voxels::U8(voxels),
        volume.size(),
        placement,
        Default::default(),
    );
    Arc::new(LabelMap::new(&grid.unwrap()).unwrap())
}

fn source() -> LabelSource {
    LabelSource {
        colors: Some(Default::default()),
        ..LabelSource::new("in-memory")
    }
}

fn complete(session: &mut Session) {
    while session.refine_light().unwrap() {}
}

#[test]
fn edits_of_labels_give_the_bytes_of_a_fresh_session() {
    let device = device(|_| {});
    let plain = labelled();
    let mut session = plain.session(&device);
    let unlabelled = session.frame().unwrap();
    let mut pictures = vec![unlabelled.clone()];
    let edits: [(&str, Option<LabelSource>); 6] = [
        ("neither hidden nor coloured", Some(source())),
        (
            "one hidden",
            Some(LabelSource {
                hide: Some(vec![3]),
                ..source()
            }),
        ),
        (
            "another hidden",
            Some(LabelSource {
                show: Some(vec![0, 3]),
                ..source()
            }),
        ),
        (
            "coloured",
            Some(LabelSource {
                colors: Some([(0, [0.0, 1.0, 0.0]), (8, [1.0, 0.0, 0.0])].into()),
                ..source()
            }),
        ),
        ("a colour for each", Some(LabelSource::new("in-memory"))),
        ("none", None),
    ];
    for (name, labels) in edits {
        let current = plain.with(|scene| scene.volume.labels = labels);
        let settings = Settings::of_scene(&current.scene, &current.volume).unwrap();
        session.set_settings(settings).unwrap();
        complete(&mut session);
        let mut fresh = current.session(&device);
        let (edited, expected) = (session.frame().unwrap(), fresh.frame().unwrap());
        assert!(shown(&expected) > 1.0, "{name}");
        assert!(edited == expected, "{name}: pictures differ");
        let [edited, expected] = [&mut session, &mut fresh].map(|s| s.light_volume().unwrap().rgba);
        assert!(edited == expected, "{name}: light differs");
        pictures.push(session.frame().unwrap());
    }
    assert!(pictures[1] == unlabelled && pictures[6] == unlabelled);
    for (i, one) in pictures[1..6].iter().enumerate() {
        let others = &pictures[i + 2..6];
        assert!(others.iter().all(|other| other != one), "each edit shows");
    }
    assert_valid(&device);
}

/// A host's own segmentation, without a scene, as a user paints it.
#[test]
fn settings_take_another_map_at_any_time() {
    let device = device(|_| {});
    let subject = labelled();
    let mut session = subject.session(&device);
    let hidden = LabelStyle {
        shown: false,
        ..LabelStyle::PLAIN
    };
    let with = |settings: &Settings, labels: [u8; 3]| {
        let map = slabs(&subject.volume, labels);
        let styles = vec![LabelStyle::PLAIN, hidden, hidden];
        Settings {
            labels: Some(Labels::new(map, styles).unwrap()),
            ..settings.clone()
        }
    };
    let mut seen = Vec::new();
    for labels in [[1, 2, 0], [0, 1, 2], [1, 1, 2]] {
        let settings = with(session.settings(), labels);
        if labels == [1, 1, 2] {
            // Everything is hidden.
            session.set_settings(settings).unwrap();
            assert_eq!(shown(&session.frame().unwrap()), 0.0);
            break;
        }
        session.set_settings(settings).unwrap();
        seen.push(shown(&session.frame().unwrap()));
    }
    assert!(
        seen[0] > 0.1 && seen[1] > 0.1 && seen[0] != seen[1],
        "{seen:?}"
    );
    let map = slabs(&subject.volume, [0, 1, 2]);
    let error = Labels::new(map, vec![LabelStyle::PLAIN]).unwrap_err();
    assert_eq!(error.to_string(), "volume.labels: 1 styles for 3 labels");
    assert_valid(&device);
}

#[test]
fn labels_that_are_not_at_hand_are_refused() {
    let device = device(|_| {});
    let subject = labelled().with(|scene| scene.volume.labels = Some(source()));
    let bare = (*subject.volume).clone().with_labels(None).unwrap();
    let error = device.load(Arc::new(bare), &subject.scene).map(|_| ());
    assert!(
        error
            .unwrap_err()
            .to_string()
            .starts_with("volume.labels: the volume has none"),
    );
}
