//! Colours of the data follow edits and levels of detail, and change nothing but colour.

use std::path::PathBuf;
use std::sync::Arc;

use umbravox::embed::Settings;
use umbravox::picture::Picture;
use umbravox::scene::{
    ColorManagement, Interpolation, RayProjection, Scene, VolumeColor, linear_from_srgb,
};

use crate::random::subject;
use crate::sessions::{Subject, assert_valid, device, point, shown};

/// A random scene whose voxels have colours, in which nothing glows.
fn colored(color: impl Fn(usize) -> [u8; 3], adjust: impl Fn(&mut Scene)) -> Subject {
    let start = (0..)
        .map(subject)
        .find(|s| s.scene.ambient_occlusion.is_some() && s.volume.voxels().len() > 4000)
        .expect("one of the first dozens")
        .with(|scene| {
            scene.march.jitter = false;
            scene.march.projection = RayProjection::Composite;
            scene.transfer_function.points = Some(vec![
                point(0.3, [0.2, 0.4, 0.9], 0.0),
                point(0.7, [0.9, 0.8, 0.3], 0.5),
            ]);
            adjust(scene);
        });
    let volume = (*start.volume).clone();
    let colors = (0..volume.voxels().len()).map(|at| {
        let [r, g, b] = color(at);
        [r, g, b, 255]
    });
    let colors = colors.collect();
    Subject {
        volume: Arc::new(volume.with_colors(Some(colors)).unwrap()),
        ..start
    }
}

fn changing(at: usize) -> [u8; 3] {
    [at % 251, at / 7 % 256, at / 64 % 256].map(|c| c as u8)
}

#[test]
fn edits_of_colors_give_the_bytes_of_a_fresh_session() {
    let device = device(|_| {});
    let start = colored(changing, |_| {});
    let mut session = start.session(&device);
    let edits: [(VolumeColor, ColorManagement, f64); 5] = [
        (VolumeColor::TransferFunction, ColorManagement::Linear, 1.0),
        (VolumeColor::Data, ColorManagement::None, 1.0),
        (VolumeColor::Data, ColorManagement::None, 4.0),
        (VolumeColor::Data, ColorManagement::Linear, 4.0),
        (VolumeColor::Data, ColorManagement::Linear, 1.0),
    ];
    let mut pictures = vec![session.frame().unwrap()];
    for (color, management, reduction) in edits {
        let current = start.with(|scene| {
            scene.volume.color = Some(color);
            scene.image.color_management = management;
            scene.storage.data_reduction = reduction;
        });
        let settings = Settings::of_scene(&current.scene, &current.volume).unwrap();
        session.set_settings(settings).unwrap();
        while session.refine_light().unwrap() {}
        let (edited, fresh) = (
            session.frame().unwrap(),
            current.session(&device).frame().unwrap(),
        );
        assert!(shown(&fresh) > 1.0, "{color:?} {management:?} {reduction}");
        assert!(edited == fresh, "{color:?} {management:?} {reduction}");
        pictures.push(fresh);
    }
    assert!(pictures[0] == pictures[5], "the default is the data's");
    let alpha = |p: &Picture| -> Vec<u32> { p.rgba.iter().map(|c| c[3].to_bits()).collect() };
    assert!(alpha(&pictures[0]) == alpha(&pictures[1]), "opacity is not");
    assert!(pictures[0] != pictures[1]);
    assert_valid(&device);
}

/// However coarse the bricks, and whether or not the atlas is the volume.
#[test]
fn one_color_stays_itself_at_every_level() {
    let device = device(|_| {});
    let color = [200, 17, 90];
    for reduction in [1.0, 2.0, 8.0, 40.0] {
        let subject = colored(
            |_| color,
            |scene| {
                scene.ambient_occlusion = None;
                scene.lighting.shading = Default::default();
                scene.storage.data_reduction = reduction;
            },
        );
        let picture = subject.session(&device).frame().unwrap();
        assert!(shown(&picture) > 1.0);
        let linear = color.map(|c| linear_from_srgb(f64::from(c) / 255.0));
        for &[r, g, b, alpha] in &picture.rgba {
            for (channel, light) in [r, g, b].into_iter().zip(linear) {
                let wanted = light * f64::from(alpha);
                let difference = (f64::from(channel) - wanted).abs();
                assert!(difference < 1e-3, "{channel} is not {wanted}, {reduction}");
            }
        }
    }
    assert_valid(&device);
}

/// A ball of one colour in voxels of alpha 0, which files leave black.
fn ball_file(color: [u8; 3]) -> (tempfile::TempDir, PathBuf) {
    const EDGE: i32 = 40;
    let mut file = format!(
        "NRRD0004\ntype: uchar\ndimension: 4\nsizes: 4 {EDGE} {EDGE} {EDGE}\n\
         kinds: RGBA-color domain domain domain\nencoding: raw\n\n"
    )
    .into_bytes();
    for at in 0..EDGE.pow(3) {
        let from_centre = [at % EDGE, at / EDGE % EDGE, at / EDGE / EDGE].map(|c| (c - 19).pow(2));
        let [r, g, b] = color;
        let inside = from_centre.iter().sum::<i32>() < 12 * 12;
        file.extend(if inside { [r, g, b, 255] } else { [0; 4] });
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("ball.nrrd");
    std::fs::write(&path, file).unwrap();
    (folder, path)
}

#[test]
fn what_is_transparent_stains_no_border() {
    let device = device(|_| {});
    let color = [200, 17, 90];
    let linear = color.map(|c| linear_from_srgb(f64::from(c) / 255.0));
    let (_folder, path) = ball_file(color);
    let volume = Arc::new(umbravox::io::read(&path, &Default::default()).unwrap());
    for (interpolation, reduction) in [
        (Interpolation::Linear, 1.0),
        (Interpolation::Linear, 8.0),
        (Interpolation::Bspline, 1.0),
    ] {
        let mut scene = Scene::for_volume(&path, &[]).unwrap();
        scene.image.size = [48; 2];
        scene.transfer_function.points = Some(vec![
            point(0.0, [0.1, 0.9, 0.1], 0.0),
            point(255.0, [0.1, 0.9, 0.1], 0.6),
        ]);
        scene.ambient_occlusion = None;
        scene.lighting.shading = Default::default();
        scene.march.interpolation = interpolation;
        scene.storage.data_reduction = reduction;
        let mut session = device.load(volume.clone(), &scene).unwrap();
        let picture = session.frame().unwrap();
        let faint = |alpha: f32| (0.02..0.3).contains(&alpha);
        let border = picture.rgba.iter().filter(|p| faint(p[3])).count();
        assert!(border > 10, "{border}");
        for &[r, g, b, alpha] in &picture.rgba {
            for (channel, light) in [r, g, b].into_iter().zip(linear) {
                let wanted = light * f64::from(alpha);
                let difference = (f64::from(channel) - wanted).abs();
                assert!(
                    difference < 1e-3,
                    "{channel} is not {wanted}: {interpolation:?}, {reduction}"
                );
            }
        }
    }
    assert_valid(&device);
}

#[test]
fn colors_that_are_not_there_are_refused() {
    let device = device(|_| {});
    let subject = colored(changing, |scene| {
        scene.volume.color = Some(VolumeColor::Data);
    });
    let bare = (*subject.volume).clone().with_colors(None).unwrap();
    let error = device.load(Arc::new(bare.clone()), &subject.scene);
    let error = error.map(|_| ()).unwrap_err().to_string();
    assert!(error.starts_with("volume.color: \"data\" needs"), "{error}");
    // And by a host that gives settings.
    let settings = Settings::of_scene(&subject.scene, &subject.volume).unwrap();
    let plain = subject.with(|scene| scene.volume.color = None);
    let mut session = device.load(Arc::new(bare), &plain.scene).unwrap();
    assert!(session.set_settings(settings.clone()).is_err());
    let mut mean = settings;
    mean.march.projection = RayProjection::Mean;
    assert!(mean.validate().is_err());
}
