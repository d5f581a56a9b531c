//! Devices, scenes and pictures for the tests.

use std::sync::Arc;

use glam::DVec3;
use umbravox::headless::{Headless, Options, Session};
use umbravox::picture::Picture;
use umbravox::scene::{
    Camera, ControlPoint, Image, Lighting, March, Scene, Storage, TransferFunction, VolumeSource,
};
use umbravox::volume::Volume;

/// A device with validation.
pub(crate) fn device(adjust: impl FnOnce(&mut Options)) -> Headless {
    let mut options = Options {
        validation: true,
        pipeline_cache: false,
        ..Default::default()
    };
    adjust(&mut options);
    Headless::new(&options).expect("a Vulkan device and the validation layer are installed")
}

/// The layers said nothing.
pub(crate) fn assert_valid(device: &Headless) {
    assert_eq!(device.validation_messages(), [""; 0]);
}

/// A volume with its scene.
#[derive(Clone)]
pub(crate) struct Subject {
    pub(crate) volume: Arc<Volume>,
    pub(crate) scene: Scene,
}

impl Subject {
    /// Emission and absorption only; rays never end early.
    pub(crate) fn new(
        volume: Volume,
        camera: Camera,
        size: [u32; 2],
        unit_distance: f64,
        points: Vec<ControlPoint>,
    ) -> Self {
        Self {
            volume: Arc::new(volume),
            scene: Scene {
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
            },
        }
    }

    /// With a part of the scene changed.
    pub(crate) fn with(&self, change: impl FnOnce(&mut Scene)) -> Self {
        let mut changed = self.clone();
        change(&mut changed.scene);
        changed
    }

    /// A session whose light is complete.
    pub(crate) fn session(&self, device: &Headless) -> Session {
        let mut session = device.load(Arc::clone(&self.volume), &self.scene).unwrap();
        while session.refine_light().unwrap() {}
        session
    }

    pub(crate) fn picture(&self, device: &Headless) -> Picture {
        self.session(device).frame().unwrap()
    }
}

/// Middle and bounding radius of the field, mm.
pub(crate) fn bounds(volume: &Volume) -> (DVec3, f64) {
    let last = DVec3::from_array(volume.size().map(|n| f64::from(n - 1)));
    let world_from_ix = volume.world_from_ix();
    let middle = world_from_ix.transform_point3(0.5 * last);
    let corner = |i: u32| {
        let side = DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2));
        world_from_ix.transform_point3(side * last).distance(middle)
    };
    (middle, (0..8).map(corner).fold(0.0, f64::max))
}

/// Where a ray enters and leaves the field, mm; `None` where it misses.
pub(crate) fn span(volume: &Volume, (origin, direction): (DVec3, DVec3)) -> Option<[f64; 2]> {
    let ix_from_world = volume.world_from_ix().inverse();
    let o = ix_from_world.transform_point3(origin);
    let d = ix_from_world.transform_vector3(direction);
    let last = DVec3::from_array(volume.size().map(|n| f64::from(n - 1)));
    let (a, b) = (-o / d, (last - o) / d);
    let enter = a.min(b).max_element().max(0.0);
    let exit = a.max(b).min_element();
    (enter < exit).then_some([enter, exit])
}

pub(crate) fn point(value: f64, color: [f64; 3], opacity: f64) -> ControlPoint {
    ControlPoint {
        value,
        color,
        opacity,
        emission: [0.0; 3],
    }
}

/// Sum over all pixels of what a picture shows.
pub(crate) fn shown(picture: &Picture) -> f64 {
    picture.rgba.iter().map(|p| f64::from(p[3])).sum()
}
