//! Scenes that differ in projection: one value a ray, optical depth, and isosurfaces.
//!
//! The classified value of a ray changes as smoothly as the field. An isosurface ends at its silhouette, where a ray
//! may hit or miss after rounding: surfaces are round and few, so that no ray of these pictures comes that close.

use glam::DAffine3;
use umbravox::scene::{
    Classification, Gradient, Interpolation, Isosurface, RayProjection, Scene, Shading,
};
use umbravox::volume::{Rescale, VoxelType};

use super::fields::{placed, radial, sampled, value_noise};
use super::optics_scenes::{f32_blobs, small_sphere, u8_blobs};
use super::{TestScene, glowing, orthographic, perspective, rise, test_scene};

const UNIT: DAffine3 = DAffine3::IDENTITY;

pub(crate) fn scenes() -> Vec<TestScene> {
    let mut scenes = one_value();
    scenes.extend(xray());
    scenes.extend(isosurfaces());
    scenes
}

fn one_value() -> Vec<TestScene> {
    let turned = placed([0.9, 1.0, 1.3], [0.5, -0.4, 1.0], 33.0, [7.0, 1.0, -4.0]);
    [
        (
            "maximum",
            RayProjection::Maximum,
            Interpolation::Linear,
            true,
        ),
        (
            "maximum_bspline",
            RayProjection::Maximum,
            Interpolation::Bspline,
            false,
        ),
        (
            "minimum",
            RayProjection::Minimum,
            Interpolation::Linear,
            true,
        ),
        (
            "minimum_catmull_rom",
            RayProjection::Minimum,
            Interpolation::CatmullRom,
            true,
        ),
        ("mean", RayProjection::Mean, Interpolation::Linear, true),
    ]
    .into_iter()
    .map(|(name, projection, interpolation, emission)| {
        let noise = |p| value_noise(p, 5.0, 71);
        let volume = sampled(
            VoxelType::I16,
            [21, 24, 19],
            turned,
            Rescale::default(),
            [-1000.0, 1000.0],
            noise,
        );
        let camera = perspective(&volume, [0.7, -1.0, 0.5], 2.8, 26.0);
        let points = vec![
            glowing(-900.0, [0.6, 0.1, 0.1], 0.1, [0.2, 0.0, 0.1]),
            glowing(0.0, [0.2, 0.8, 0.3], 0.5, [0.0; 3]),
            glowing(900.0, [0.9, 0.8, 1.0], 0.9, [0.3, 0.4, 0.0]),
        ];
        test_scene(name, volume, camera, 1.0, points, |scene| {
            scene.march.projection = projection;
            scene.march.interpolation = interpolation;
            scene.lighting.emission = emission;
        })
    })
    .collect()
}

fn xray() -> Vec<TestScene> {
    [
        ("xray", None, 0.5),
        ("xray_post", Some(Classification::Post), 0.7),
        ("xray_pre", Some(Classification::Pre), 0.5),
    ]
    .into_iter()
    .map(|(name, classification, step)| {
        let volume = u8_blobs([29, 25, 33], UNIT);
        let camera = perspective(&volume, [0.5, 0.9, 0.4], 2.8, 26.0);
        test_scene(name, volume, camera, 4.0, rise(20.0, 240.0, 0.5), |scene| {
            scene.march.projection = RayProjection::Xray;
            scene.march.classification = classification;
            scene.march.step = step;
        })
    })
    .collect()
}

fn isosurface(value: f64, color: Option<[f64; 3]>, opacity: f64) -> Isosurface {
    Isosurface {
        value,
        color,
        opacity,
    }
}

fn show(scene: &mut Scene, isosurfaces: Vec<Isosurface>) {
    scene.march.projection = RayProjection::Isosurface;
    scene.march.isosurfaces = isosurfaces;
    scene.lighting.shading = Shading::Diffuse;
}

fn isosurfaces() -> Vec<TestScene> {
    let mut scenes = Vec::new();
    let one = || vec![isosurface(0.35, Some([0.9, 0.7, 0.5]), 1.0)];

    let volume = f32_blobs([33, 30, 36], UNIT);
    let camera = perspective(&volume, [0.6, -1.0, 0.4], 2.8, 26.0);
    let points = rise(0.1, 0.8, 0.5);
    scenes.push(test_scene(
        "isosurface",
        volume,
        camera,
        1.0,
        points,
        |scene| show(scene, one()),
    ));

    // Unsorted, one in the colour of the transfer function; met from inside and outside, several in one segment.
    let volume = sampled(
        VoxelType::F32,
        [25, 27, 24],
        UNIT,
        Rescale::default(),
        [0.0, 1.0],
        radial,
    );
    let camera = orthographic(&volume, [0.5, -0.8, 0.6], 1.5);
    let points = rise(0.1, 0.9, 0.5);
    scenes.push(test_scene(
        "isosurfaces_translucent",
        volume,
        camera,
        1.0,
        points,
        |scene| {
            show(
                scene,
                vec![
                    isosurface(0.71, None, 0.5),
                    isosurface(0.42, Some([0.3, 0.8, 0.9]), 0.3),
                    isosurface(0.74, Some([0.9, 0.3, 0.2]), 0.6),
                ],
            );
            scene.march.step = 1.2;
        },
    ));

    let turned = placed([1.0, 0.9, 1.2], [0.3, 1.0, 0.2], 35.0, [4.0, 0.0, -2.0]);
    for (name, interpolation, gradient) in [
        (
            "isosurface_bspline",
            Interpolation::Bspline,
            Gradient::Bspline,
        ),
        (
            "isosurface_catmull_rom",
            Interpolation::CatmullRom,
            Gradient::Sobel,
        ),
    ] {
        let volume = f32_blobs([23, 26, 21], turned);
        let camera = perspective(&volume, [0.8, -0.9, 0.3], 2.8, 26.0);
        scenes.push(test_scene(
            name,
            volume,
            camera,
            1.0,
            rise(0.1, 0.8, 0.5),
            |scene| {
                show(scene, one());
                scene.march.interpolation = interpolation;
                scene.lighting.gradient = gradient;
            },
        ));
    }

    let volume = f32_blobs([26, 28, 25], UNIT);
    let camera = perspective(&volume, [-0.5, -0.9, 0.6], 2.8, 26.0);
    let points = rise(0.1, 0.6, 0.8);
    scenes.push(test_scene(
        "isosurface_in_ambient_light",
        volume,
        camera,
        1.0,
        points,
        |scene| {
            show(scene, one());
            scene.ambient_occlusion = Some(small_sphere(16));
        },
    ));
    scenes
}
