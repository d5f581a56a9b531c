//! Scenes that differ in voxel type, grid, placement and camera.

use glam::{DAffine3, DMat3, DVec3};
use umbravox::scene::Camera;
use umbravox::volume::{Rescale, VoxelType};

use super::fields::{blobs, checker, marschner_lobb, placed, radial, ramp, sampled, value_noise};
use super::{TestScene, orthographic, perspective, point, rise, tents, test_scene};

const UNIT: DAffine3 = DAffine3::IDENTITY;

pub(crate) fn scenes() -> Vec<TestScene> {
    let plain = Rescale::default();
    let mut scenes = Vec::new();

    let volume = sampled(
        VoxelType::U8,
        [37, 21, 50],
        UNIT,
        plain,
        [0.0, 255.0],
        blobs,
    );
    let camera = perspective(&volume, [0.7, -1.0, 0.4], 3.0, 25.0);
    scenes.push(test_scene(
        "u8_blobs_perspective",
        volume,
        camera,
        1.0,
        rise(30.0, 220.0, 0.4),
        |_| {},
    ));

    let turned = placed([1.0; 3], [1.0, 2.0, -0.5], 37.0, [5.0, -8.0, 3.0]);
    let noise = |p| value_noise(p, 4.0, 7);
    let volume = sampled(
        VoxelType::I8,
        [17; 3],
        turned,
        plain,
        [-128.0, 127.0],
        noise,
    );
    let camera = perspective(&volume, [-1.0, -0.6, 0.3], 2.6, 34.0);
    scenes.push(test_scene(
        "i8_noise_turned",
        volume,
        camera,
        1.0,
        rise(-60.0, 90.0, 0.5),
        |_| {},
    ));

    let volume = sampled(
        VoxelType::U16,
        [33; 3],
        UNIT,
        plain,
        [100.0, 60_000.0],
        marschner_lobb,
    );
    let camera = orthographic(&volume, [0.3, -0.5, 0.8], 2.0);
    let surface = tents(&[(30_000.0, 6_000.0, [0.9, 0.8, 0.5], 0.8)]);
    scenes.push(test_scene(
        "u16_marschner_lobb_orthographic",
        volume,
        camera,
        1.0,
        surface,
        |_| {},
    ));

    let anisotropic = placed(
        [0.7, 0.9, 1.6],
        [0.0, 0.0, 1.0],
        0.0,
        [-120.0, -95.0, 310.0],
    );
    let hounsfield = Rescale {
        slope: 1.0,
        intercept: -1024.0,
    };
    let volume = sampled(
        VoxelType::I16,
        [37, 30, 22],
        anisotropic,
        hounsfield,
        [0.0, 3000.0],
        blobs,
    );
    let camera = perspective(&volume, [0.2, -1.0, 0.1], 2.6, 24.0);
    scenes.push(test_scene(
        "i16_hounsfield_anisotropic",
        volume,
        camera,
        1.0,
        rise(-200.0, 1200.0, 0.3),
        |_| {},
    ));

    let along_x = |p| ramp(p, DVec3::X);
    let volume = sampled(
        VoxelType::F32,
        [18, 33, 16],
        UNIT,
        plain,
        [-1.0, 1.0],
        along_x,
    );
    let camera = orthographic(&volume, [-1.0, 0.0, 0.0], 2.1);
    scenes.push(test_scene(
        "f32_ramp_axis_aligned",
        volume,
        camera,
        1.0,
        rise(-1.0, 1.0, 0.2),
        |scene| {
            scene.march.step = 1.0;
        },
    ));

    let corners = |p| value_noise(p, 1.0, 3);
    let volume = sampled(VoxelType::U8, [2; 3], UNIT, plain, [0.0, 255.0], corners);
    let camera = perspective(&volume, [1.0, -1.3, 0.8], 3.0, 29.0);
    scenes.push(test_scene(
        "two_voxels_an_axis",
        volume,
        camera,
        0.2,
        rise(20.0, 250.0, 0.3),
        |scene| {
            scene.march.step = 0.25;
        },
    ));

    let volume = sampled(
        VoxelType::I16,
        [33, 16, 18],
        UNIT,
        plain,
        [-1000.0, 1000.0],
        radial,
    );
    let camera = orthographic(&volume, [1.0, 1.0, -0.4], 1.8);
    scenes.push(test_scene(
        "block_borders",
        volume,
        camera,
        1.0,
        rise(-400.0, 800.0, 0.25),
        |_| {},
    ));

    let mirrored = DAffine3::from_mat3_translation(
        DMat3::from_diagonal(DVec3::new(-0.8, -0.8, 1.1)),
        DVec3::new(40.0, 60.0, -20.0),
    );
    let volume = sampled(
        VoxelType::U16,
        [20, 31, 19],
        mirrored,
        plain,
        [0.0, 4095.0],
        blobs,
    );
    let camera = perspective(&volume, [0.5, 1.0, 0.6], 2.8, 29.0);
    scenes.push(test_scene(
        "two_axes_flipped",
        volume,
        camera,
        1.0,
        rise(400.0, 3500.0, 0.4),
        |_| {},
    ));

    let left_handed = DAffine3::from_mat3(DMat3::from_cols(
        DVec3::new(0.0, 1.2, 0.0),
        DVec3::new(1.0, 0.0, 0.0),
        DVec3::new(0.0, 0.0, 0.9),
    ));
    let noise = |p| value_noise(p, 5.0, 11);
    let volume = sampled(
        VoxelType::F32,
        [17, 23, 29],
        left_handed,
        plain,
        [0.0, 1e-3],
        noise,
    );
    let camera = orthographic(&volume, [0.4, -0.2, 0.9], 1.9);
    scenes.push(test_scene(
        "axes_swapped",
        volume,
        camera,
        1.0,
        rise(3e-4, 9e-4, 0.3),
        |_| {},
    ));

    let sheared = DAffine3::from_mat3_translation(
        DMat3::from_cols(
            DVec3::new(1.0, 0.1, 0.0),
            DVec3::new(0.35, 0.9, 0.05),
            DVec3::new(-0.2, 0.3, 1.4),
        ),
        DVec3::new(-3.0, 7.0, 2.0),
    );
    let volume = sampled(
        VoxelType::U8,
        [28, 22, 19],
        sheared,
        plain,
        [10.0, 240.0],
        blobs,
    );
    let camera = perspective(&volume, [-0.6, -1.0, 0.7], 3.0, 26.0);
    scenes.push(test_scene(
        "sheared",
        volume,
        camera,
        1.0,
        rise(40.0, 200.0, 0.4),
        |_| {},
    ));

    let volume = sampled(
        VoxelType::I16,
        [37, 21, 50],
        UNIT,
        plain,
        [-500.0, 1500.0],
        blobs,
    );
    let camera = Camera::Perspective {
        eye: [11.3, 9.1, 24.7],
        target: [25.0, 11.0, 30.0],
        up: [0.0, 0.0, 1.0],
        fov_y: 95.0,
    };
    scenes.push(test_scene(
        "eye_inside_perspective",
        volume,
        camera,
        2.0,
        rise(-450.0, 1200.0, 0.2),
        |_| {},
    ));

    let noise = |p| value_noise(p, 6.0, 23);
    let volume = sampled(
        VoxelType::U8,
        [33, 33, 18],
        UNIT,
        plain,
        [0.0, 255.0],
        noise,
    );
    let camera = Camera::Orthographic {
        eye: [16.2, 15.1, 8.3],
        target: [30.0, 23.0, 11.0],
        up: [0.0, 0.0, 1.0],
        height: 20.0,
    };
    scenes.push(test_scene(
        "eye_inside_orthographic",
        volume,
        camera,
        2.0,
        rise(60.0, 230.0, 0.2),
        |_| {},
    ));

    // A thin plate seen along its length: rays enter and leave at flat angles, many through the rims.
    let volume = sampled(
        VoxelType::U16,
        [48, 48, 3],
        UNIT,
        plain,
        [0.0, 1000.0],
        radial,
    );
    let camera = orthographic(&volume, [0.9, -0.44, 0.035], 0.25);
    scenes.push(test_scene(
        "grazing_plate",
        volume,
        camera,
        10.0,
        rise(-200.0, 1000.0, 0.3),
        |_| {},
    ));

    let tiny = placed(
        [1e-3, 1.2e-3, 0.9e-3],
        [0.3, 0.2, 1.0],
        20.0,
        [0.01, -0.02, 0.005],
    );
    let volume = sampled(
        VoxelType::U8,
        [19, 18, 21],
        tiny,
        plain,
        [0.0, 255.0],
        blobs,
    );
    let camera = perspective(&volume, [1.0, -0.7, 0.5], 3.0, 26.0);
    scenes.push(test_scene(
        "micrometre_spacing",
        volume,
        camera,
        1e-3,
        rise(30.0, 200.0, 0.4),
        |_| {},
    ));

    let huge = placed(
        [1e3, 0.8e3, 1.5e3],
        [0.3, -0.2, 1.0],
        -35.0,
        [2e4, 1e4, -3e4],
    );
    let volume = sampled(
        VoxelType::I8,
        [22, 25, 17],
        huge,
        plain,
        [-100.0, 100.0],
        blobs,
    );
    let camera = perspective(&volume, [-0.4, -0.7, 0.5], 3.0, 26.0);
    scenes.push(test_scene(
        "metre_spacing",
        volume,
        camera,
        1e3,
        rise(-70.0, 60.0, 0.4),
        |_| {},
    ));

    let volume = sampled(
        VoxelType::F32,
        [24, 20, 26],
        UNIT,
        plain,
        [-3e5, 7e5],
        radial,
    );
    let camera = perspective(&volume, [0.8, -0.3, 0.6], 25.0, 3.6);
    scenes.push(test_scene(
        "telephoto_large_values",
        volume,
        camera,
        1.0,
        rise(0.0, 6e5, 0.2),
        |_| {},
    ));

    // Rays run along z at quarter voxels and samples lie at quarters too: never near a half.
    let size = [33, 16, 18];
    let squares = move |p| checker(p, size);
    let volume = sampled(VoxelType::U8, size, UNIT, plain, [50.0, 200.0], squares);
    let camera = Camera::Orthographic {
        eye: [16.0, 8.0, -10.0],
        target: [16.0, 8.0, 0.0],
        up: [0.0, 1.0, 0.0],
        height: 20.0,
    };
    let two = vec![
        point(60.0, [0.2, 0.5, 1.0], 0.1),
        point(190.0, [1.0, 0.6, 0.1], 0.4),
    ];
    scenes.push(test_scene(
        "nearest_checker",
        volume,
        camera,
        2.0,
        two.clone(),
        |scene| {
            scene.march.interpolation = umbravox::scene::Interpolation::Nearest;
        },
    ));

    let squares = move |p| checker(p, size);
    let volume = sampled(VoxelType::U8, size, UNIT, plain, [50.0, 200.0], squares);
    let camera = perspective(&volume, [0.3, 0.5, 1.0], 2.4, 34.0);
    scenes.push(test_scene(
        "linear_checker",
        volume,
        camera,
        2.0,
        two,
        |_| {},
    ));

    // The nearest voxel may be another one after rounding; neighbours differ by little.
    let soft = |p| ramp(p, DVec3::new(0.6, -0.3, 0.8));
    let volume = sampled(VoxelType::F32, [40, 33, 37], UNIT, plain, [0.0, 1.0], soft);
    let camera = perspective(&volume, [0.9, -0.8, 0.5], 3.0, 26.0);
    scenes.push(test_scene(
        "nearest_smooth",
        volume,
        camera,
        4.0,
        rise(-0.2, 1.4, 0.1),
        |scene| {
            scene.march.interpolation = umbravox::scene::Interpolation::Nearest;
        },
    ));
    scenes
}
