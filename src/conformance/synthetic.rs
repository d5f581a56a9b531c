//! Volumes, scenes and rays to check with.

use std::sync::Arc;

use glam::{DAffine3, DMat3, DQuat, DVec3};

use crate::error::Result;
use crate::headless::{Headless, Session};
use crate::picture::Picture;
use crate::scene::{
    Camera, ControlPoint, Image, Lighting, March, Scene, Storage, TransferFunction, View,
    VolumeSource,
};
use crate::volume::{Rescale, Volume, Voxels};

/// A placement: axes of the given spacing (mm), turned by `degrees` about `axis`, voxel (0,0,0) at `origin`.
pub fn placed(spacing: [f64; 3], axis: [f64; 3], degrees: f64, origin: [f64; 3]) -> DAffine3 {
    let turn = DQuat::from_axis_angle(DVec3::from_array(axis).normalize(), degrees.to_radians());
    DAffine3::from_mat3_translation(
        DMat3::from_quat(turn) * DMat3::from_diagonal(DVec3::from_array(spacing)),
        DVec3::from_array(origin),
    )
}

/// A volume of 32-bit floats from a function of the voxel index.
pub(super) fn sampled(
    size: [u32; 3],
    world_from_ix: DAffine3,
    field: impl Fn(DVec3) -> f64,
) -> Result<Volume> {
    let [nx, ny, nz] = size;
    let voxels = (0..nz).flat_map(|k| (0..ny).flat_map(move |j| (0..nx).map(move |i| [i, j, k])));
    let values = voxels.map(|ix| field(DVec3::from_array(ix.map(f64::from))) as f32);
    Volume::new(
        Voxels::F32(values.collect()),
        size,
        world_from_ix,
        Rescale::default(),
    )
}

/// Voxel index of the last voxel.
pub(super) fn last_ix(volume: &Volume) -> DVec3 {
    DVec3::from_array(volume.size().map(|n| f64::from(n - 1)))
}

/// Middle and bounding radius of the field, mm.
pub fn bounds(volume: &Volume) -> (DVec3, f64) {
    let last = last_ix(volume);
    let world_from_ix = volume.world_from_ix();
    let middle = world_from_ix.transform_point3(0.5 * last);
    let corner = |i: u32| {
        let side = DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2));
        world_from_ix.transform_point3(side * last).distance(middle)
    };
    (middle, (0..8).map(corner).fold(0.0, f64::max))
}

/// Where a ray (origin, unit direction) enters and leaves the field, mm; `None` where it misses.
pub fn span(volume: &Volume, (origin, direction): (DVec3, DVec3)) -> Option<[f64; 2]> {
    let ix_from_world = volume.world_from_ix().inverse();
    let o = ix_from_world.transform_point3(origin);
    let d = ix_from_world.transform_vector3(direction);
    let (a, b) = (-o / d, (last_ix(volume) - o) / d);
    let enter = a.min(b).max_element().max(0.0);
    let exit = a.max(b).min_element();
    (enter < exit).then_some([enter, exit])
}

/// Perspective and parallel, from a direction askew to all axes; the field fills most of the picture.
pub fn cameras(volume: &Volume) -> [Camera; 2] {
    let (middle, radius) = bounds(volume);
    let eye = (middle + DVec3::new(0.5, -0.7, 0.4).normalize() * (3.0 * radius)).to_array();
    let (target, up) = (middle.to_array(), [0.0, 0.0, 1.0]);
    let (fov_y, height) = (40.0, 2.1 * radius);
    [
        Camera::Perspective {
            eye,
            target,
            up,
            fov_y,
        },
        Camera::Orthographic {
            eye,
            target,
            up,
            height,
        },
    ]
}

/// Rays through the middles of all pixels, row by row.
pub fn rays(view: &View, size: [u32; 2]) -> impl Iterator<Item = (DVec3, DVec3)> {
    let pixels = (0..size[1]).flat_map(move |y| (0..size[0]).map(move |x| [x, y]));
    pixels.map(move |px| view.ray(px.map(|p| f64::from(p) + 0.5), size))
}

/// A control point that emits nothing.
pub fn point(value: f64, color: [f64; 3], opacity: f64) -> ControlPoint {
    ControlPoint {
        value,
        color,
        opacity,
        emission: [0.0; 3],
        source: [0.0; 3],
    }
}

/// Emission and absorption only; rays never end early.
pub fn scene(
    camera: Camera,
    size: [u32; 2],
    unit_distance: f64,
    points: Vec<ControlPoint>,
) -> Scene {
    Scene {
        volume: VolumeSource {
            path: "in-memory".into(),
            ..Default::default()
        },
        camera,
        image: Image {
            size,
            ..Default::default()
        },
        transfer_function: TransferFunction {
            unit_distance: Some(unit_distance),
            points: Some(points),
            ..Default::default()
        },
        march: March {
            early_termination: 1.0,
            ..Default::default()
        },
        lighting: Lighting::default(),
        ambient_occlusion: None,
        storage: Storage::default(),
    }
}

/// A volume with its scene.
#[derive(Clone)]
pub(super) struct Subject {
    pub(super) volume: Arc<Volume>,
    pub(super) scene: Scene,
}

impl Subject {
    /// Seen by the first of [`cameras`].
    pub(super) fn new(
        volume: Volume,
        size: [u32; 2],
        unit: f64,
        points: Vec<ControlPoint>,
    ) -> Self {
        let [camera, _] = cameras(&volume);
        Self {
            scene: scene(camera, size, unit, points),
            volume: Arc::new(volume),
        }
    }

    /// With a part of the scene changed.
    pub(super) fn with(&self, change: impl FnOnce(&mut Scene)) -> Self {
        let mut changed = self.clone();
        change(&mut changed.scene);
        changed
    }

    /// A session whose light is complete.
    pub(super) fn session(&self, device: &Headless) -> Result<Session> {
        let mut session = device.load(Arc::clone(&self.volume), &self.scene)?;
        while session.refine_light()? {}
        Ok(session)
    }

    pub(super) fn picture(&self, device: &Headless) -> Result<Picture> {
        self.session(device)?.frame()
    }

    /// Pictures by both [`cameras`] and with every step (voxels), and the rays of their pixels.
    pub(super) fn each_picture(
        &self,
        device: &Headless,
        steps: &[f64],
        mut look: impl FnMut(f64, &Picture, &[(DVec3, DVec3)]),
    ) -> Result<()> {
        let mut session = self.session(device)?;
        let size = self.scene.image.size;
        for camera in cameras(&self.volume) {
            let view = camera.view(&self.volume, size)?;
            session.set_view(view);
            let rays: Vec<_> = rays(&view, size).collect();
            for &step in steps {
                let mut settings = session.settings().clone();
                settings.march.step = step;
                session.set_settings(settings)?;
                look(step, &session.frame()?, &rays);
            }
        }
        Ok(())
    }
}

/// Largest difference of any channel of any pixel.
pub(super) fn difference(a: &Picture, b: &Picture) -> f64 {
    let channels = a.rgba.iter().flatten().zip(b.rgba.iter().flatten());
    channels
        .map(|(a, b)| f64::from((a - b).abs()))
        .fold(0.0, f64::max)
}
