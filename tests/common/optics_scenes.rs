//! Scenes that differ in sampling, transfer function and light.

use glam::{DAffine3, DVec3};
use umbravox::scene::{AmbientOcclusion, ColorManagement, DirectionSet, Shading};
use umbravox::volume::{Rescale, Volume, VoxelType};

use super::fields::{blobs, placed, radial, ramp, sampled, value_noise};
use super::{TestScene, glowing, orthographic, perspective, point, rise, tents, test_scene};

const UNIT: DAffine3 = DAffine3::IDENTITY;

pub(crate) fn scenes() -> Vec<TestScene> {
    let mut scenes = sampling();
    scenes.extend(surfaces());
    scenes.extend(ambient_light());
    scenes
}

/// Volume of 8-bit blobs on a grid of its own.
pub(super) fn u8_blobs(size: [u32; 3], world_from_ix: DAffine3) -> Volume {
    sampled(
        VoxelType::U8,
        size,
        world_from_ix,
        Rescale::default(),
        [0.0, 255.0],
        blobs,
    )
}

/// Volume of float blobs, 0 to 1.
pub(super) fn f32_blobs(size: [u32; 3], world_from_ix: DAffine3) -> Volume {
    sampled(
        VoxelType::F32,
        size,
        world_from_ix,
        Rescale::default(),
        [0.0, 1.0],
        blobs,
    )
}

/// Steps, early termination and unusual transfer functions.
fn sampling() -> Vec<TestScene> {
    let plain = Rescale::default();
    let mut scenes = Vec::new();

    let noise = |p| value_noise(p, 9.0, 5);
    let volume = sampled(
        VoxelType::U16,
        [25, 27, 31],
        UNIT,
        plain,
        [0.0, 65_535.0],
        noise,
    );
    let camera = perspective(&volume, [1.0, -0.9, 0.7], 2.8, 29.0);
    scenes.push(test_scene(
        "fine_steps",
        volume,
        camera,
        1.0,
        rise(2e4, 6e4, 0.4),
        |scene| {
            scene.march.step = 0.25;
        },
    ));

    let volume = u8_blobs([37, 40, 33], UNIT);
    let camera = perspective(&volume, [-0.3, -0.9, 0.2], 3.0, 26.0);
    scenes.push(test_scene(
        "coarse_steps",
        volume,
        camera,
        2.0,
        rise(10.0, 250.0, 0.4),
        |scene| {
            scene.march.step = 2.0;
        },
    ));

    let volume = u8_blobs([30, 30, 30], UNIT);
    let camera = perspective(&volume, [0.5, 0.8, 0.3], 2.8, 26.0);
    scenes.push(test_scene(
        "early_termination",
        volume,
        camera,
        1.0,
        rise(40.0, 160.0, 0.7),
        |scene| {
            scene.march.early_termination = 0.95;
            scene.march.step = 0.7;
        },
    ));

    let volume = sampled(
        VoxelType::I8,
        [19, 17, 23],
        UNIT,
        plain,
        [12.0, 12.0],
        radial,
    );
    let camera = perspective(&volume, [0.5, -0.8, 0.45], 3.2, 26.0);
    let medium = vec![point(12.0, [0.8, 0.5, 0.3], 0.1)];
    scenes.push(test_scene(
        "homogeneous",
        volume,
        camera,
        1.0,
        medium,
        |scene| {
            scene.march.early_termination = 1.0;
            scene.march.step = 0.9;
        },
    ));

    // Colours jump only where nothing is visible.
    let volume = sampled(
        VoxelType::I16,
        [26, 24, 22],
        UNIT,
        plain,
        [-1000.0, 1000.0],
        radial,
    );
    let camera = perspective(&volume, [0.6, -0.5, 0.9], 2.8, 26.0);
    let mut jump = rise(-300.0, 300.0, 0.2);
    jump.extend([
        point(500.0, [1.0, 0.9, 0.7], 0.0),
        point(500.0, [0.0, 0.2, 0.1], 0.0),
        point(700.0, [0.1, 0.9, 0.3], 0.5),
    ]);
    scenes.push(test_scene(
        "jump_where_transparent",
        volume,
        camera,
        1.0,
        jump,
        |_| {},
    ));

    let negative = Rescale {
        slope: -0.25,
        intercept: 300.0,
    };
    let volume = sampled(
        VoxelType::U16,
        [24, 29, 21],
        UNIT,
        negative,
        [2000.0, 400.0],
        blobs,
    );
    let camera = perspective(&volume, [0.1, -1.0, 0.6], 2.8, 26.0);
    scenes.push(test_scene(
        "negative_rescale_slope",
        volume,
        camera,
        1.0,
        rise(-150.0, 180.0, 0.4),
        |_| {},
    ));

    let volume = f32_blobs([27, 33, 30], UNIT);
    let camera = perspective(&volume, [-0.8, -0.5, 0.3], 2.8, 26.0);
    let glow = vec![
        glowing(0.1, [0.2, 0.4, 0.8], 0.0, [0.0; 3]),
        glowing(0.5, [0.3, 0.3, 0.3], 0.1, [0.9, 0.3, 0.0]),
        glowing(1.0, [0.1, 0.1, 0.1], 0.4, [0.1, 1.4, 0.6]),
    ];
    scenes.push(test_scene(
        "emission_display_colors",
        volume,
        camera,
        1.0,
        glow,
        |scene| {
            scene.image.color_management = ColorManagement::None;
        },
    ));
    scenes
}

/// Surfaces, shells and gradient shading.
fn surfaces() -> Vec<TestScene> {
    let plain = Rescale::default();
    let mut scenes = Vec::new();

    let volume = f32_blobs([35, 32, 37], UNIT);
    let camera = perspective(&volume, [0.6, -1.0, 0.3], 2.8, 26.0);
    let opaque = vec![
        point(0.3, [0.9, 0.7, 0.6], 0.0),
        point(0.4, [1.0, 0.95, 0.9], 0.999),
    ];
    scenes.push(test_scene(
        "opaque_surface",
        volume,
        camera,
        0.5,
        opaque,
        |scene| {
            scene.march.step = 0.3;
        },
    ));

    let volume = sampled(
        VoxelType::F32,
        [34, 36, 33],
        UNIT,
        plain,
        [0.0, 1.0],
        radial,
    );
    let camera = perspective(&volume, [0.5, -0.9, 0.5], 2.6, 29.0);
    let shells = tents(&[
        (0.5, 0.02, [0.2, 0.5, 1.0], 0.4),
        (0.62, 0.02, [0.3, 1.0, 0.4], 0.5),
        (0.8, 0.03, [1.0, 0.5, 0.2], 0.8),
    ]);
    scenes.push(test_scene(
        "thin_shells",
        volume,
        camera,
        1.0,
        shells,
        |scene| {
            scene.march.step = 0.25;
        },
    ));

    let turned = placed([1.0, 0.8, 1.3], [0.2, 1.0, 0.4], 50.0, [3.0, 2.0, 1.0]);
    let volume = f32_blobs([29, 34, 25], turned);
    let camera = perspective(&volume, [0.9, -0.7, 0.4], 2.8, 26.0);
    scenes.push(test_scene(
        "diffuse_headlight",
        volume,
        camera,
        1.0,
        rise(0.1, 0.7, 0.6),
        |scene| {
            scene.lighting.shading = Shading::Diffuse;
        },
    ));

    let volume = sampled(
        VoxelType::U16,
        [31, 26, 28],
        UNIT,
        plain,
        [0.0, 65_535.0],
        blobs,
    );
    let camera = orthographic(&volume, [-0.7, -0.8, 0.5], 1.6);
    scenes.push(test_scene(
        "diffuse_directional",
        volume,
        camera,
        1.0,
        rise(8e3, 5e4, 0.6),
        |scene| {
            scene.lighting.shading = Shading::Diffuse;
            scene.lighting.direction = Some([-2.0, -0.5, 1.0]);
            scene.lighting.ambient = 0.15;
            scene.lighting.diffuse = 0.9;
        },
    ));

    // Gradients at the faces of the field, where differences are one-sided.
    let slanted = |p| 0.8 * ramp(p, DVec3::new(0.4, 1.0, -0.7)) + 0.2 * value_noise(p, 3.0, 2);
    let volume = sampled(
        VoxelType::F32,
        [18, 17, 16],
        UNIT,
        plain,
        [0.0, 1.0],
        slanted,
    );
    let camera = perspective(&volume, [0.9, 0.7, 0.8], 2.8, 29.0);
    scenes.push(test_scene(
        "diffuse_at_the_faces",
        volume,
        camera,
        1.0,
        rise(-0.5, 1.0, 0.5),
        |scene| {
            scene.lighting.shading = Shading::Diffuse;
            scene.lighting.direction = Some([0.1, 0.3, 1.0]);
        },
    ));
    scenes
}

/// Ambient occlusion settings small enough for a test.
pub(super) fn small_sphere(rays: u32) -> AmbientOcclusion {
    AmbientOcclusion {
        rays,
        radius: 7.0,
        ..Default::default()
    }
}

/// Local ambient occlusion, alone and with everything else.
pub(super) fn ambient_light() -> Vec<TestScene> {
    let plain = Rescale::default();
    let mut scenes = Vec::new();

    let volume = u8_blobs([35, 21, 33], UNIT);
    let camera = perspective(&volume, [0.6, -1.0, 0.4], 2.8, 26.0);
    scenes.push(test_scene(
        "ambient_occlusion",
        volume,
        camera,
        1.0,
        rise(50.0, 180.0, 0.6),
        |scene| {
            scene.ambient_occlusion = Some(small_sphere(16));
        },
    ));

    let glow = || {
        vec![
            glowing(0.2, [0.6, 0.5, 0.4], 0.0, [0.0; 3]),
            glowing(0.5, [0.7, 0.5, 0.4], 0.4, [0.0; 3]),
            glowing(0.9, [0.4, 0.4, 0.4], 0.6, [0.9, 0.5, 0.1]),
        ]
    };
    let turned = placed([0.9, 1.0, 1.2], [1.0, -0.4, 0.3], 65.0, [-10.0, 4.0, 8.0]);
    let volume = f32_blobs([26, 30, 23], turned);
    let camera = perspective(&volume, [0.8, 0.9, 0.2], 2.8, 26.0);
    scenes.push(test_scene(
        "emissive_tissue",
        volume,
        camera,
        1.0,
        glow(),
        |scene| {
            scene.ambient_occlusion = Some(small_sphere(20));
        },
    ));

    let volume = f32_blobs([30, 26, 23], turned);
    let camera = perspective(&volume, [0.8, 0.9, 0.2], 2.8, 26.0);
    scenes.push(test_scene(
        "emission_in_march_only",
        volume,
        camera,
        1.0,
        glow(),
        |scene| {
            scene.ambient_occlusion = Some(AmbientOcclusion {
                emission: false,
                ..small_sphere(12)
            });
        },
    ));

    let volume = f32_blobs([24, 28, 27], turned);
    let camera = perspective(&volume, [0.8, 0.9, 0.2], 2.8, 26.0);
    scenes.push(test_scene(
        "emission_in_light_only",
        volume,
        camera,
        1.0,
        glow(),
        |scene| {
            // (5.2 - 1) / 0.6 is above 7 in binary: no eighth sample.
            scene.ambient_occlusion = Some(AmbientOcclusion {
                radius: 5.2,
                offset: 1.0,
                step: 0.6,
                ..small_sphere(12)
            });
            scene.lighting.emission = false;
        },
    ));

    let volume = f32_blobs([24, 33, 28], UNIT);
    let camera = orthographic(&volume, [0.8, -0.9, 0.6], 1.6);
    scenes.push(test_scene(
        "weighted_icosahedron",
        volume,
        camera,
        1.0,
        rise(0.1, 0.8, 0.5),
        |scene| {
            scene.ambient_occlusion = Some(AmbientOcclusion {
                directions: DirectionSet::Icosahedron,
                weights: Some((0..12).map(|k| f64::from(k) / 11.0).collect()),
                offset: 0.5,
                step: 0.6,
                gamma: 1.7,
                bias: 0.1,
                ..small_sphere(12)
            });
        },
    ));

    let volume = sampled(
        VoxelType::I16,
        [22, 33, 27],
        UNIT,
        plain,
        [-800.0, 1200.0],
        blobs,
    );
    let camera = perspective(&volume, [-0.6, -0.8, 0.4], 2.8, 26.0);
    scenes.push(test_scene(
        "diffuse_and_ambient",
        volume,
        camera,
        1.0,
        rise(-500.0, 700.0, 0.7),
        |scene| {
            scene.lighting.shading = Shading::Diffuse;
            scene.lighting.direction = Some([0.3, -1.0, 0.8]);
            scene.ambient_occlusion = Some(AmbientOcclusion {
                explicit_directions: Some(vec![
                    [0.3, -1.0, 0.8],
                    [0.0, 0.1, 2.0],
                    [-0.7, -0.2, 0.4],
                ]),
                ..small_sphere(3)
            });
        },
    ));

    // Matter reaches the faces of the field, and light comes in through them.
    let turned = placed([1.0; 3], [0.5, 0.3, 1.0], 28.0, [0.0; 3]);
    let noise = |p| value_noise(p, 4.0, 31);
    let volume = sampled(
        VoxelType::U8,
        [21, 18, 24],
        turned,
        plain,
        [0.0, 255.0],
        noise,
    );
    let camera = perspective(&volume, [0.5, -0.9, 0.6], 2.8, 26.0);
    scenes.push(test_scene(
        "light_through_the_faces",
        volume,
        camera,
        1.0,
        rise(40.0, 220.0, 0.3),
        |scene| {
            scene.ambient_occlusion = Some(AmbientOcclusion {
                radius: 6.5,
                offset: 0.0,
                ..small_sphere(18)
            });
        },
    ));
    scenes
}
