//! Scenes with labels that hide and colour, on the volume's grid and on others, for each projection and classification.
//!
//! A label changes abruptly between two voxels: no sample of these pictures comes so close to such a place that rounding decides.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{DAffine3, DVec3};
use umbravox::scene::{
    Classification, Interpolation, Isosurface, LabelSource, RayProjection, Scene, Shading,
};
use umbravox::volume::{LabelMap, Rescale, Volume, VoxelType};

use super::fields::{placed, sampled, value_noise};
use super::optics_scenes::{f32_blobs, small_sphere, u8_blobs};
use super::{TestScene, glowing, perspective, rise, test_scene};

const UNIT: DAffine3 = DAffine3::IDENTITY;

pub(crate) fn scenes() -> Vec<TestScene> {
    let mut scenes = composites();
    scenes.extend(projections());
    scenes.extend(in_ambient_light());
    scenes
}

/// Labels 0 to 3 in patches.
fn patches(size: [u32; 3], world_from_ix: DAffine3) -> LabelMap {
    let patch = |p| (value_noise(p, 3.0, 5) * 4.0).floor() / 3.0;
    let stored = [0.0, 3.0];
    let rescale = Rescale::default();
    labels(sampled(
        VoxelType::U8,
        size,
        world_from_ix,
        rescale,
        stored,
        patch,
    ))
}

/// A label of its own for each voxel.
fn mosaic(size: [u32; 3], world_from_ix: DAffine3) -> LabelMap {
    let last = DVec3::from_array(size.map(f64::from)) - 1.0;
    let count = size.iter().product::<u32>();
    let tile = |p: DVec3| {
        let [i, j, k] = (p * last).round().to_array();
        let [nx, ny, _] = size.map(f64::from);
        (i + nx * (j + ny * k)) / f64::from(count)
    };
    let stored = [0.0, count.into()];
    let rescale = Rescale::default();
    labels(sampled(
        VoxelType::U16,
        size,
        world_from_ix,
        rescale,
        stored,
        tile,
    ))
}

fn labels(volume: Volume) -> LabelMap {
    LabelMap::new(&volume).expect("whole numbers")
}

/// A coarse grid around the middle of a volume, turned; corners of the volume stick out.
fn around(volume: &Volume, size: [u32; 3]) -> DAffine3 {
    let extent = volume.size().map(f64::from);
    let spacing = std::array::from_fn(|a| 0.93 * extent[a] / f64::from(size[a]));
    let turned = placed(spacing, [0.4, 1.0, -0.3], 24.0, [0.0; 3]);
    let middle = |size: [u32; 3]| 0.5 * (DVec3::from_array(size.map(f64::from)) - 1.0);
    let from = volume
        .world_from_ix()
        .transform_point3(middle(volume.size()));
    DAffine3::from_translation(from - turned.transform_point3(middle(size))) * turned
}

fn with(volume: Volume, map: LabelMap) -> Volume {
    volume
        .with_labels(Some(Arc::new(map)))
        .expect("they lie in one place")
}

fn hiding(labels: &[i32]) -> LabelSource {
    LabelSource {
        hide: Some(labels.to_vec()),
        ..LabelSource::new("labels-in-memory")
    }
}

fn composites() -> Vec<TestScene> {
    let mut scenes = Vec::new();
    let mut add = |name, map: fn(&Volume) -> LabelMap, adjust: &dyn Fn(&mut Scene)| {
        let volume = u8_blobs([29, 25, 33], UNIT);
        let map = map(&volume);
        let volume = with(volume, map);
        let camera = perspective(&volume, [0.5, 0.9, 0.4], 2.8, 26.0);
        let points = rise(20.0, 240.0, 0.5);
        scenes.push(test_scene(name, volume, camera, 4.0, points, adjust));
    };
    let same: fn(&Volume) -> LabelMap = |v| patches(v.size(), v.world_from_ix());
    let other: fn(&Volume) -> LabelMap = |v| patches([11, 9, 12], around(v, [11, 9, 12]));
    let many: fn(&Volume) -> LabelMap = |v| mosaic([9, 10, 8], around(v, [9, 10, 8]));
    add("labels_hidden", same, &|scene| {
        scene.volume.labels = Some(LabelSource {
            colors: Some(BTreeMap::new()),
            ..hiding(&[1])
        });
    });
    add("labels_in_two_colors", other, &|scene| {
        scene.volume.labels = Some(LabelSource {
            colors: Some([(0, [0.9, 0.8, 0.1]), (2, [0.1, 0.9, 0.4])].into()),
            tint: 0.6,
            ..hiding(&[])
        });
        scene.march.classification = Some(Classification::Post);
        scene.lighting.shading = Shading::Diffuse;
    });
    add("labels_before_interpolation", other, &|scene| {
        scene.volume.labels = Some(hiding(&[3]));
        scene.march.classification = Some(Classification::Pre);
    });
    add("labels_as_a_mosaic", many, &|scene| {
        scene.volume.labels = Some(hiding(&[0, 100, 300, 301, 302, 500]));
        scene.march.interpolation = Interpolation::Bspline;
    });
    add("xray_of_labels", other, &|scene| {
        scene.volume.labels = Some(LabelSource {
            show: Some(vec![1, 2]),
            ..LabelSource::new("labels-in-memory")
        });
        scene.march.projection = RayProjection::Xray;
    });
    scenes
}

fn projections() -> Vec<TestScene> {
    let mut scenes = Vec::new();
    for (name, projection) in [
        ("maximum_of_labels", RayProjection::Maximum),
        ("minimum_of_labels", RayProjection::Minimum),
        ("mean_of_labels", RayProjection::Mean),
    ] {
        let volume = sampled(
            VoxelType::I16,
            [21, 24, 19],
            placed([0.9, 1.0, 1.3], [0.5, -0.4, 1.0], 33.0, [7.0, 1.0, -4.0]),
            Rescale::default(),
            [-1000.0, 1000.0],
            |p| value_noise(p, 5.0, 71),
        );
        let map = patches([7, 6, 5], around(&volume, [7, 6, 5]));
        let volume = with(volume, map);
        let camera = perspective(&volume, [0.7, -1.0, 0.5], 2.8, 26.0);
        let points = vec![
            glowing(-900.0, [0.6, 0.1, 0.1], 0.1, [0.2, 0.0, 0.1]),
            glowing(0.0, [0.2, 0.8, 0.3], 0.5, [0.0; 3]),
            glowing(900.0, [0.9, 0.8, 1.0], 0.9, [0.3, 0.4, 0.0]),
        ];
        scenes.push(test_scene(name, volume, camera, 1.0, points, |scene| {
            scene.march.projection = projection;
            scene.volume.labels = Some(hiding(&[2]));
        }));
    }
    let volume = f32_blobs([33, 30, 36], UNIT);
    let map = patches([13, 11, 12], around(&volume, [13, 11, 12]));
    let volume = with(volume, map);
    let camera = perspective(&volume, [0.6, -1.0, 0.4], 2.8, 26.0);
    let points = rise(0.1, 0.8, 0.5);
    let surface = |value, opacity| Isosurface {
        value,
        color: Some([0.9, 0.7, 0.5]),
        opacity,
    };
    scenes.push(test_scene(
        "isosurfaces_of_labels",
        volume,
        camera,
        1.0,
        points,
        |scene| {
            scene.march.projection = RayProjection::Isosurface;
            scene.march.isosurfaces = vec![surface(0.35, 0.7), surface(0.6, 1.0)];
            scene.lighting.shading = Shading::Diffuse;
            scene.volume.labels = Some(LabelSource {
                tint: 0.8,
                ..hiding(&[1])
            });
        },
    ));
    scenes
}

/// What is hidden casts no shadow and does not shine. Light takes millions of samples, some of them next to a border between
/// labels: this one runs through empty space.
pub(super) fn in_ambient_light() -> Vec<TestScene> {
    let disc = |p: DVec3, x: f64| {
        let r = (p - DVec3::new(x, 0.5, 0.5)) / DVec3::new(0.08, 0.15, 0.15);
        (-0.5 * r.length_squared()).exp()
    };
    let volume = sampled(
        VoxelType::F32,
        [26, 28, 25],
        UNIT,
        Rescale::default(),
        [0.0, 1.0],
        |p| disc(p, 0.25) + disc(p, 0.75),
    );
    let map = labels(sampled(
        VoxelType::U8,
        [14, 5, 3],
        placed([1.9, 5.3, 9.0], [0.0, 0.0, 1.0], 0.0, [0.3, 2.1, 3.2]),
        Rescale::default(),
        [0.0, 2.0],
        |p| if p.x < 0.5 { 0.5 } else { 1.0 },
    ));
    let volume = with(volume, map);
    let camera = perspective(&volume, [-0.9, -0.5, 0.6], 2.8, 22.0);
    let points = vec![
        glowing(0.1, [0.1, 0.3, 0.9], 0.0, [0.0; 3]),
        glowing(0.3, [0.9, 0.4, 0.2], 0.3, [0.2, 0.1, 0.0]),
        glowing(0.6, [1.0, 0.9, 0.7], 0.8, [0.0, 0.1, 0.3]),
    ];
    vec![test_scene(
        "labels_in_ambient_light",
        volume,
        camera,
        1.0,
        points,
        |scene| {
            scene.volume.labels = Some(LabelSource {
                colors: Some([(1, [0.9, 0.7, 0.3])].into()),
                tint: 0.5,
                ..hiding(&[2])
            });
            scene.ambient_occlusion = Some(small_sphere(16));
            scene.ambient_occlusion.as_mut().expect("given").emission = true;
        },
    )]
}
