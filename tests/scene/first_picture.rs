//! Camera, light and storage of volumes that come without a scene.

use std::path::Path;
use std::sync::Arc;

use glam::{DAffine3, DVec3};
use umbravox::scene::{
    Camera, ColorManagement, FirstPicture, Interpolation, Override, Projection, View,
};
use umbravox::volume::{Rescale, Volume, Voxels};

/// A bright box, given by its first and last voxel, in a dark volume of 60 x 50 x 40 voxels of 1 x 1 x 2 mm.
fn box_in_the_dark(first: [u32; 3], last: [u32; 3]) -> Arc<Volume> {
    let size = [60, 50, 40];
    let voxels = (0..60 * 50 * 40u32).map(|at| {
        let place = [at % 60, at / 60 % 50, at / 3000];
        let inside = (0..3).all(|a| (first[a]..=last[a]).contains(&place[a]));
        // Not a label map: values differ from voxel to voxel.
        if inside {
            900 + (at * 7919 % 100) as u16
        } else {
            (at * 10_473 % 50) as u16
        }
    });
    let placement = DAffine3 {
        matrix3: glam::DMat3::from_diagonal(DVec3::new(1.0, 1.0, 2.0)),
        translation: DVec3::new(-500.0, 20.0, 80.0),
    };
    let voxels = Voxels::U16(voxels.collect());
    Arc::new(Volume::new(voxels, size, placement, Rescale::default()).unwrap())
}

fn first(volume: &Arc<Volume>, overrides: &[&str]) -> FirstPicture {
    let overrides: Vec<Override> = overrides
        .iter()
        .map(|o| Override::parse(o).unwrap())
        .collect();
    FirstPicture::of(Path::new("a.nrrd"), Arc::clone(volume), &overrides).unwrap()
}

fn view(picture: &FirstPicture) -> View {
    let scene = &picture.scene;
    let curve = scene
        .transfer_function
        .curve(&picture.volume, ColorManagement::Linear)
        .unwrap();
    scene.view(&picture.volume, &curve).unwrap()
}

/// Where a point lies in the picture, -1 to 1 from edge to edge.
fn projected(view: &View, size: [u32; 2], point_ws: DVec3) -> [f64; 2] {
    let Projection::Perspective { fov_y } = view.projection else {
        panic!("{view:?}");
    };
    let from_eye = point_ws - view.eye;
    let depth = from_eye.dot(view.forward);
    assert!(depth > 0.0, "behind the eye");
    let y = from_eye.dot(view.up) / depth / (0.5 * fov_y).tan();
    let x = from_eye.dot(view.right) / depth / (0.5 * fov_y).tan();
    [x * f64::from(size[1]) / f64::from(size[0]), y]
}

fn corners(volume: &Volume, first: [u32; 3], last: [u32; 3]) -> Vec<DVec3> {
    (0..8)
        .map(|corner| {
            let pick = |a: usize| {
                f64::from(if corner >> a & 1 == 0 {
                    first[a]
                } else {
                    last[a]
                })
            };
            volume
                .world_from_ix()
                .transform_point3(DVec3::new(pick(0), pick(1), pick(2)))
        })
        .collect()
}

#[test]
fn what_is_visible_fills_the_picture() {
    let (low, high) = ([40, 5, 22], [52, 14, 33]);
    let volume = box_in_the_dark(low, high);
    for size in [[300, 300], [400, 200], [120, 360]] {
        for angles in [
            ["camera.azimuth=0", "camera.elevation=0"],
            ["camera.azimuth=-140", "camera.elevation=65"],
        ] {
            let set = format!("image.size=[{},{}]", size[0], size[1]);
            let picture = first(&volume, &[&set, angles[0], angles[1]]);
            let places: Vec<[f64; 2]> = corners(&volume, low, high)
                .into_iter()
                .map(|corner| projected(&view(&picture), size, corner))
                .collect();
            let farthest = places.iter().flatten().fold(0.0f64, |m, c| m.max(c.abs()));
            assert!(
                farthest <= 1.0,
                "{size:?} {angles:?}: {farthest} is outside"
            );
            assert!(
                farthest >= 0.7,
                "{size:?} {angles:?}: {farthest} leaves much empty"
            );
        }
    }
}

#[test]
fn superior_is_up_and_anterior_in_front() {
    let volume = box_in_the_dark([10, 10, 10], [50, 40, 30]);
    let picture = first(&volume, &[]);
    let view = view(&picture);
    assert!(view.up.z > 0.9 && view.forward.y > 0.7, "{view:?}");
    assert!(matches!(
        picture.scene.camera,
        Camera::Auto {
            elevation: 20.0,
            ..
        }
    ));
}

#[test]
fn flat_volumes_are_looked_at_from_above() {
    let volume = box_in_the_dark([2, 2, 18], [57, 47, 20]);
    assert!(matches!(
        first(&volume, &[]).scene.camera,
        Camera::Auto {
            elevation: 50.0,
            ..
        }
    ));
}

#[test]
fn light_reaches_as_far_as_the_object_is_large() {
    let radius = |last: [u32; 3]| {
        let picture = first(&box_in_the_dark([2, 2, 2], last), &[]);
        picture.scene.ambient_occlusion.expect("on").radius
    };
    assert_eq!(radius([12, 12, 7]), 6.0, "the least");
    assert!(radius([57, 47, 37]) > 6.0);
}

#[test]
fn overrides_have_the_last_word() {
    let volume = box_in_the_dark([10, 10, 10], [50, 40, 30]);
    let picture = first(
        &volume,
        &[
            "ambient_occlusion=null",
            "storage.data_reduction=3",
            "transfer_function.preset=mr-angio",
        ],
    );
    assert_eq!(picture.scene.ambient_occlusion, None);
    assert_eq!(picture.scene.storage.data_reduction, 3.0);
    assert_eq!(
        picture.scene.transfer_function.preset.as_deref(),
        Some("mr-angio")
    );
    let camera =
        r#"camera={"type":"orthographic","eye":[0,-9,0],"target":[0,0,0],"up":[0,0,1],"height":5}"#;
    let by_keys = [
        "camera.type=orthographic",
        "camera.eye=[0,-9,0]",
        "camera.target=[0,0,0]",
        "camera.up=[0,0,1]",
        "camera.height=5",
    ];
    assert_eq!(
        first(&volume, &[camera]).scene.camera,
        first(&volume, &by_keys).scene.camera
    );
}

#[test]
fn labels_are_not_interpolated() {
    let voxels = (0..24u32.pow(3))
        .map(|at| u8::from(at % 24 > 12) * 5)
        .collect();
    let volume = Volume::axis_aligned(Voxels::U8(voxels), [24; 3], [1.0; 3]).unwrap();
    let picture = first(&Arc::new(volume), &[]);
    assert_eq!(picture.scene.march.interpolation, Interpolation::Nearest);
    assert_eq!(picture.scene.storage.data_reduction, 1.0);
}

#[test]
fn scenes_frame_the_whole_volume_unless_told() {
    let (low, high) = ([40, 5, 22], [52, 14, 33]);
    let volume = box_in_the_dark(low, high);
    let mut scene = first(&volume, &[]).scene;
    let curve = scene
        .transfer_function
        .curve(&volume, ColorManagement::Linear)
        .unwrap();
    let visible = scene.view(&volume, &curve).unwrap();
    scene.camera = Camera::default();
    let whole = scene.view(&volume, &curve).unwrap();
    assert_eq!(whole, scene.camera.view(&volume, scene.image.size).unwrap());
    let middle = corners(&volume, low, high).iter().sum::<DVec3>() / 8.0;
    assert!(visible.eye.distance(middle) < 0.5 * whole.eye.distance(middle));
}
