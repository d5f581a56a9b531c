//! Scenes of voxels that are colours: with each classification, in light, with labels, and colours used as they are.

use std::sync::Arc;

use glam::{DAffine3, DVec3};
use umbravox::scene::{
    Classification, ColorManagement, Interpolation, LabelSource, Scene, Shading,
};
use umbravox::volume::{LabelMap, Rescale, Volume, VoxelType};

use super::fields::{placed, sampled, value_noise};
use super::optics_scenes::{small_sphere, u8_blobs};
use super::{TestScene, glowing, orthographic, perspective, rise, test_scene};

const UNIT: DAffine3 = DAffine3::IDENTITY;

/// Blobs in colours that change over a few voxels.
fn colored(size: [u32; 3], world_from_ix: DAffine3) -> Volume {
    let channel = |seed: u32| {
        let field = |p: DVec3| value_noise(p, 6.0, seed);
        sampled(
            VoxelType::U8,
            size,
            UNIT,
            Rescale::default(),
            [0.0, 255.0],
            field,
        )
    };
    let channels = [channel(3), channel(4), channel(5)];
    let volume = u8_blobs(size, world_from_ix);
    let colors = (0..volume.voxels().len()).map(|at| {
        let [r, g, b] = [0, 1, 2].map(|c: usize| channels[c].voxels().get(at) as u8);
        [r, g, b, 255]
    });
    let colors = colors.collect();
    volume.with_colors(Some(colors)).expect("as many as voxels")
}

pub(crate) fn scenes() -> Vec<TestScene> {
    let mut scenes = Vec::new();
    let mut add = |name, volume: Volume, camera, adjust: &dyn Fn(&mut Scene)| {
        let points = rise(20.0, 240.0, 0.5);
        scenes.push(test_scene(name, volume, camera, 4.0, points, adjust));
    };
    let volume = || colored([29, 25, 33], UNIT);
    let camera = perspective(&volume(), [0.5, 0.9, 0.4], 2.8, 26.0);
    add("colors_of_the_data", volume(), camera.clone(), &|scene| {
        scene.march.classification = Some(Classification::Post);
    });
    add("colors_between_ends", volume(), camera.clone(), &|scene| {
        scene.march.classification = Some(Classification::Preintegrated);
        scene.lighting.shading = Shading::Diffuse;
    });
    add(
        "colors_before_interpolation",
        volume(),
        camera.clone(),
        &|scene| {
            scene.march.classification = Some(Classification::Pre);
        },
    );
    add("colors_as_they_are", volume(), camera.clone(), &|scene| {
        scene.image.color_management = ColorManagement::None;
        scene.march.interpolation = Interpolation::Bspline;
    });
    let turned = placed([0.9, 1.0, 1.3], [0.5, -0.4, 1.0], 33.0, [7.0, 1.0, -4.0]);
    let oblique = colored([21, 24, 19], turned);
    let along = orthographic(&oblique, [0.3, -1.0, 0.2], 1.6);
    add("nearest_colors", oblique, along, &|scene| {
        scene.march.interpolation = Interpolation::Nearest;
    });
    let halves = sampled(
        VoxelType::U8,
        [29, 25, 33],
        UNIT,
        Rescale::default(),
        [0.0, 2.0],
        |p| if p.x < 0.5 { 0.5 } else { 1.0 },
    );
    let map = LabelMap::new(&halves).expect("whole numbers");
    let labelled = volume()
        .with_labels(Some(Arc::new(map)))
        .expect("they lie in one place");
    add("labels_on_colors", labelled, camera, &|scene| {
        scene.volume.labels = Some(LabelSource {
            colors: Some([(1, [0.9, 0.8, 0.1])].into()),
            tint: 0.4,
            ..LabelSource::new("labels-in-memory")
        });
    });
    scenes.push(lit());
    scenes
}

/// Light falls on the data's colours; emission stays the transfer function's.
fn lit() -> TestScene {
    let volume = colored([26, 28, 25], UNIT);
    let camera = perspective(&volume, [-0.9, -0.5, 0.6], 2.8, 22.0);
    let points = vec![
        glowing(60.0, [0.1, 0.3, 0.9], 0.0, [0.0; 3]),
        glowing(120.0, [0.9, 0.4, 0.2], 0.3, [0.2, 0.1, 0.0]),
        glowing(220.0, [1.0, 0.9, 0.7], 0.8, [0.0, 0.1, 0.3]),
    ];
    test_scene("colors_in_light", volume, camera, 1.0, points, |scene| {
        scene.ambient_occlusion = Some(small_sphere(16));
    })
}
