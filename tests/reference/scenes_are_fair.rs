//! The scenes that renderers are compared on: varied, visible, and insensitive to rounding.

use std::collections::HashSet;

use glam::{DAffine3, DQuat, DVec3};
use umbravox::reference::{LightGrid, Picture, Setup, light, march};
use umbravox::scene::{
    AmbientOcclusion, Curve, Labels, Projection, RayProjection, Scene, Surface, View,
};
use umbravox::volume::{Volume, VoxelType};

use crate::scenes::{TestScene, all};

fn labels_of(volume: &Volume, scene: &Scene) -> Option<Labels> {
    Labels::of_scene(scene, volume).unwrap()
}

fn light_of(volume: &Volume, scene: &Scene, curve: &Curve) -> Option<LightGrid> {
    let settings = scene.ambient_occlusion.as_ref()?;
    let labels = labels_of(volume, scene);
    Some(light(volume, curve, settings, labels.as_ref()))
}

fn picture_of(
    volume: &Volume,
    scene: &Scene,
    view: &View,
    curve: &Curve,
    surfaces: &[Surface],
) -> Picture {
    let light = light_of(volume, scene, curve);
    let labels = labels_of(volume, scene);
    march(&Setup {
        labels: labels.as_ref(),
        ..Setup::new(volume, scene, view, curve, surfaces, light.as_ref())
    })
}

fn reference(s: &TestScene) -> Picture {
    picture_of(&s.volume, &s.scene, &s.view, &s.curve, &s.surfaces)
}

fn largest_difference(a: &Picture, b: &Picture) -> f64 {
    let channels = a.rgba.iter().flatten().zip(b.rgba.iter().flatten());
    channels.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// A rotation and scaling of the world, `x -> factor * turn * x + offset`.
struct Similarity {
    turn: DQuat,
    factor: f64,
    offset: DVec3,
}

impl Similarity {
    fn direction(&self, d: [f64; 3]) -> [f64; 3] {
        (self.turn * DVec3::from_array(d)).to_array()
    }

    /// The same scene in the moved world, with the volume's voxels untouched.
    fn apply(&self, s: &TestScene) -> (Volume, Scene, View, Curve) {
        let scale = DAffine3::from_scale_rotation_translation(
            DVec3::splat(self.factor),
            self.turn,
            self.offset,
        );
        let volume = Volume::new(
            s.volume.voxels().clone(),
            s.volume.size(),
            scale * s.volume.world_from_ix(),
            s.volume.rescale(),
        )
        .and_then(|volume| volume.with_colors(s.volume.colors().map(<[_]>::to_vec)))
        .unwrap();
        let view = View {
            eye: scale.transform_point3(s.view.eye),
            right: self.turn * s.view.right,
            up: self.turn * s.view.up,
            forward: self.turn * s.view.forward,
            projection: match s.view.projection {
                Projection::Orthographic { height } => Projection::Orthographic {
                    height: height * self.factor,
                },
                perspective => perspective,
            },
        };
        let mut scene = s.scene.clone();
        scene.lighting.direction = scene.lighting.direction.map(|d| self.direction(d));
        scene.ambient_occlusion = scene.ambient_occlusion.map(|ao| {
            let dirs = ao.weighted_directions().into_iter();
            AmbientOcclusion {
                explicit_directions: Some(dirs.map(|(d, _)| self.direction(d)).collect()),
                ..ao
            }
        });
        let mut curve = s.curve.clone();
        curve.unit_distance *= self.factor;
        (volume, scene, view, curve)
    }
}

#[test]
fn scenes_vary() {
    let scenes = all();
    let names: HashSet<&str> = scenes.iter().map(|s| s.name).collect();
    assert_eq!(names.len(), scenes.len(), "names are unique");
    assert!(scenes.len() >= 24);
    for voxel_type in VoxelType::ALL {
        let count = scenes
            .iter()
            .filter(|s| s.volume.voxels().voxel_type() == voxel_type)
            .count();
        assert!(count >= 2, "{} scenes of {}", count, voxel_type.name());
    }
    let with_light = scenes
        .iter()
        .filter(|s| s.scene.ambient_occlusion.is_some());
    assert!(with_light.count() >= 4);
    let parallel = |s: &&TestScene| matches!(s.view.projection, Projection::Orthographic { .. });
    assert!(scenes.iter().filter(parallel).count() >= 4);
}

#[test]
fn scenes_are_visible_and_finite() {
    for s in all() {
        let picture = reference(&s);
        let mut channels = picture.rgba.iter().flatten();
        assert!(channels.all(|c| c.is_finite() && *c >= 0.0), "{}", s.name);
        assert!(picture.rgba.iter().all(|p| p[3] <= 1.0), "{}", s.name);
        let visible = picture.rgba.iter().filter(|p| p[3] > 0.1).count();
        let share = visible as f64 / picture.rgba.len() as f64;
        assert!(
            share > 0.14,
            "{}: {share} of the picture is visible",
            s.name
        );
        if s.scene.march.projection == RayProjection::Xray {
            continue; // Black, and as opaque as the depth is large.
        }
        let brightest = picture.rgba.iter().map(|p| p[0]).fold(0.0, f64::max);
        assert!(brightest > 0.15, "{}: brightest red {brightest}", s.name);
    }
}

/// What rounding to f32 does to a camera and to directions must not show.
#[test]
fn scenes_are_insensitive_to_rounding() {
    for s in all() {
        let nudge = Similarity {
            turn: DQuat::from_axis_angle(DVec3::new(0.36, 0.48, 0.8), 1e-7),
            factor: 1.0,
            offset: DVec3::new(0.7, -1.1, 0.9) * (2e-6 * s.volume.min_spacing()),
        };
        let (_, scene, view, _) = nudge.apply(&s);
        let nudged = picture_of(&s.volume, &scene, &view, &s.curve, &s.surfaces);
        let difference = largest_difference(&nudged, &reference(&s)) * 255.0;
        assert!(difference < 0.02, "{}: {difference}/255", s.name);
    }
}

/// Turning, moving and scaling the world, volume, camera and lights together, changes no pixel.
#[test]
fn pictures_do_not_depend_on_the_frame_of_reference() {
    let motion = Similarity {
        turn: DQuat::from_axis_angle(DVec3::new(0.48, -0.6, 0.64), 1.1),
        factor: 2.5,
        offset: DVec3::new(30.0, -20.0, 5.0),
    };
    // A nearest voxel, or label, may change with the last bit of a position.
    let smooth = |s: &TestScene| s.scene.march.interpolation.is_continuous() && s.labels.is_none();
    for s in all().into_iter().filter(smooth) {
        let (volume, scene, view, curve) = motion.apply(&s);
        let moved = picture_of(&volume, &scene, &view, &curve, &s.surfaces);
        let still = reference(&s);
        let difference = largest_difference(&moved, &still);
        assert!(difference < 1e-11, "{}: {difference:e}", s.name);
        for (a, b) in moved.depth.iter().zip(&still.depth) {
            let same = (a / motion.factor - b).abs() < 1e-7 * b || a == b;
            assert!(same, "{}: depth {a} after scaling, {b} before", s.name);
        }
    }
}
