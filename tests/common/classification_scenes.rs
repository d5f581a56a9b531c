//! Scenes that differ in reconstruction filter, order of classification and gradient estimator.
//!
//! Classification after interpolation sees the transfer function at points, so its scenes keep that continuous;
//! integration along segments does not, and may have jumps where they are seen. The nearest voxel may be another
//! one after rounding, so its scene has neighbours that differ by little.

use glam::{DAffine3, DVec3};
use umbravox::scene::{Classification, Gradient, Interpolation, Scene, Shading};
use umbravox::volume::{Rescale, VoxelType};

use super::fields::{marschner_lobb, placed, radial, ramp, sampled, value_noise};
use super::optics_scenes::{f32_blobs, small_sphere, u8_blobs};
use super::{TestScene, glowing, orthographic, perspective, point, rise, tents, test_scene};

const UNIT: DAffine3 = DAffine3::IDENTITY;

pub(crate) fn scenes() -> Vec<TestScene> {
    let mut scenes = after_interpolation();
    scenes.extend(before_interpolation());
    scenes.extend(along_segments());
    scenes.extend(cubic_filters());
    scenes.extend(gradients());
    scenes
}

fn after_interpolation() -> Vec<TestScene> {
    let post = |scene: &mut Scene| scene.march.classification = Some(Classification::Post);
    let mut scenes = Vec::new();

    let volume = u8_blobs([31, 36, 27], UNIT);
    let camera = perspective(&volume, [0.6, -0.9, 0.5], 2.8, 26.0);
    let points = rise(30.0, 220.0, 0.5);
    scenes.push(test_scene(
        "post_classified",
        volume,
        camera,
        1.0,
        points,
        post,
    ));

    let turned = placed([1.0, 0.8, 1.3], [0.2, 1.0, 0.4], 50.0, [3.0, 2.0, 1.0]);
    let volume = f32_blobs([25, 28, 23], turned);
    let camera = orthographic(&volume, [0.8, -0.7, 0.5], 1.6);
    let glow = vec![
        glowing(0.1, [0.2, 0.4, 0.8], 0.0, [0.0; 3]),
        glowing(0.5, [0.3, 0.3, 0.3], 0.2, [0.9, 0.3, 0.0]),
        glowing(1.0, [0.8, 0.1, 0.1], 0.5, [0.1, 1.4, 0.6]),
    ];
    scenes.push(test_scene(
        "post_classified_lit",
        volume,
        camera,
        1.0,
        glow,
        |scene| {
            post(scene);
            scene.lighting.shading = Shading::Diffuse;
            scene.ambient_occlusion = Some(small_sphere(12));
        },
    ));
    scenes
}

fn before_interpolation() -> Vec<TestScene> {
    let pre = |scene: &mut Scene| scene.march.classification = Some(Classification::Pre);
    let mut scenes = Vec::new();

    let noise = |p| value_noise(p, 5.0, 41);
    let volume = sampled(
        VoxelType::I16,
        [26, 23, 29],
        UNIT,
        Rescale::default(),
        [-900.0, 900.0],
        noise,
    );
    let camera = perspective(&volume, [0.7, -0.8, 0.4], 2.8, 26.0);
    let points = rise(-400.0, 700.0, 0.5);
    scenes.push(test_scene(
        "pre_classified",
        volume,
        camera,
        1.0,
        points,
        pre,
    ));

    let volume = u8_blobs([24, 27, 30], UNIT);
    let camera = orthographic(&volume, [0.3, 0.9, 0.5], 1.6);
    let glow = vec![
        glowing(20.0, [0.9, 0.2, 0.1], 0.0, [0.0; 3]),
        glowing(90.0, [0.1, 0.8, 0.3], 0.3, [0.0, 0.0, 0.7]),
        glowing(200.0, [0.9, 0.8, 0.2], 0.6, [0.4, 0.0, 0.0]),
    ];
    scenes.push(test_scene(
        "pre_classified_lit",
        volume,
        camera,
        1.0,
        glow,
        |scene| {
            pre(scene);
            scene.lighting.shading = Shading::Diffuse;
            scene.ambient_occlusion = Some(small_sphere(10));
        },
    ));

    let soft = |p| ramp(p, DVec3::new(0.5, 0.4, -0.8));
    let volume = sampled(
        VoxelType::F32,
        [36, 40, 33],
        UNIT,
        Rescale::default(),
        [0.0, 1.0],
        soft,
    );
    let camera = perspective(&volume, [0.8, -0.9, 0.4], 3.0, 26.0);
    let points = rise(-0.2, 1.4, 0.1);
    scenes.push(test_scene(
        "pre_classified_nearest",
        volume,
        camera,
        4.0,
        points,
        |scene| {
            pre(scene);
            scene.march.interpolation = Interpolation::Nearest;
        },
    ));
    scenes
}

fn along_segments() -> Vec<TestScene> {
    let mut scenes = Vec::new();

    // Shells far thinner than a step, with a jump inside one of them.
    let volume = sampled(
        VoxelType::F32,
        [34, 31, 36],
        UNIT,
        Rescale::default(),
        [0.0, 1.0],
        radial,
    );
    let camera = perspective(&volume, [0.5, -0.9, 0.6], 2.6, 29.0);
    let mut points = tents(&[
        (0.5, 0.01, [0.2, 0.5, 1.0], 0.7),
        (0.7, 0.02, [0.3, 1.0, 0.4], 0.8),
    ]);
    points.extend([
        point(0.8, [1.0, 0.5, 0.2], 0.0),
        point(0.8, [1.0, 0.5, 0.2], 0.5),
        point(0.9, [0.3, 0.1, 0.9], 0.9),
    ]);
    scenes.push(test_scene(
        "preintegrated_shells",
        volume,
        camera,
        1.0,
        points,
        |scene| {
            scene.march.step = 1.5;
        },
    ));

    let volume = f32_blobs([28, 26, 31], UNIT);
    let camera = perspective(&volume, [-0.7, -0.9, 0.3], 2.8, 26.0);
    let glow = vec![
        glowing(0.2, [0.1, 0.3, 0.9], 0.0, [0.0; 3]),
        glowing(0.3, [0.9, 0.1, 0.2], 0.4, [0.0, 0.8, 0.2]),
        glowing(0.6, [0.9, 0.9, 0.2], 0.99, [0.5, 0.0, 0.0]),
    ];
    scenes.push(test_scene(
        "preintegrated_dense_lit",
        volume,
        camera,
        1.0,
        glow,
        |scene| {
            scene.march.classification = Some(Classification::Preintegrated);
            scene.march.step = 1.0;
            scene.lighting.shading = Shading::Diffuse;
            scene.ambient_occlusion = Some(small_sphere(12));
        },
    ));
    scenes
}

fn cubic_filters() -> Vec<TestScene> {
    let sheared = placed([0.9, 1.1, 1.4], [0.4, -0.2, 1.0], 25.0, [-4.0, 6.0, 1.0]);
    let mut scenes = Vec::new();
    for (name, interpolation, classification) in [
        ("bspline_post", Interpolation::Bspline, Classification::Post),
        (
            "bspline_preintegrated",
            Interpolation::Bspline,
            Classification::Preintegrated,
        ),
        (
            "catmull_rom_post",
            Interpolation::CatmullRom,
            Classification::Post,
        ),
        (
            "catmull_rom_preintegrated",
            Interpolation::CatmullRom,
            Classification::Preintegrated,
        ),
    ] {
        // Matter reaches the faces, where border voxels repeat.
        let noise = |p| value_noise(p, 6.0, 53);
        let volume = sampled(
            VoxelType::U8,
            [19, 17, 16],
            sheared,
            Rescale::default(),
            [0.0, 255.0],
            noise,
        );
        let camera = perspective(&volume, [0.8, -0.9, 0.6], 2.8, 29.0);
        let points = rise(60.0, 220.0, 0.4);
        scenes.push(test_scene(name, volume, camera, 1.0, points, |scene| {
            scene.march.interpolation = interpolation;
            scene.march.classification = Some(classification);
        }));
    }

    let volume = sampled(
        VoxelType::U16,
        [33; 3],
        UNIT,
        Rescale::default(),
        [0.0, 65_535.0],
        marschner_lobb,
    );
    let camera = orthographic(&volume, [0.3, -0.5, 0.8], 1.8);
    let points = tents(&[(32_000.0, 6_000.0, [0.9, 0.8, 0.5], 0.8)]);
    scenes.push(test_scene(
        "catmull_rom_diffuse",
        volume,
        camera,
        1.0,
        points,
        |scene| {
            scene.march.interpolation = Interpolation::CatmullRom;
            scene.lighting.shading = Shading::Diffuse;
            scene.lighting.gradient = Gradient::CatmullRom;
        },
    ));
    scenes
}

/// Each estimator in the same anisotropic, turned volume, whose matter reaches the faces.
fn gradients() -> Vec<TestScene> {
    let turned = placed([0.8, 1.0, 1.5], [1.0, 0.4, -0.6], 40.0, [2.0, -3.0, 5.0]);
    [
        ("gradient_four_point", Gradient::FourPoint),
        ("gradient_regression", Gradient::Regression),
        ("gradient_sobel", Gradient::Sobel),
        ("gradient_bspline", Gradient::Bspline),
        ("gradient_catmull_rom", Gradient::CatmullRom),
    ]
    .into_iter()
    .map(|(name, gradient)| {
        let slanted = |p| 0.6 * ramp(p, DVec3::new(0.4, 1.0, -0.7)) + 0.4 * value_noise(p, 4.0, 61);
        let volume = sampled(
            VoxelType::F32,
            [18, 20, 15],
            turned,
            Rescale::default(),
            [0.0, 1.0],
            slanted,
        );
        let camera = perspective(&volume, [0.9, 0.7, 0.8], 2.8, 29.0);
        test_scene(name, volume, camera, 1.0, rise(0.1, 0.9, 0.6), |scene| {
            scene.lighting.shading = Shading::Diffuse;
            scene.lighting.gradient = gradient;
            scene.lighting.direction = Some([0.4, 0.3, 1.0]);
        })
    })
    .collect()
}
