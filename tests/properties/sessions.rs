//! Devices, scenes and pictures for the tests.

use std::sync::Arc;

use umbravox::conformance::synthetic::scene;
use umbravox::headless::{Headless, Options, Session};
use umbravox::picture::Picture;
use umbravox::scene::{Camera, ControlPoint, Scene};
use umbravox::volume::Volume;

pub(crate) use umbravox::conformance::synthetic::{bounds, point, span};

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
            scene: scene(camera, size, unit_distance, points),
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

/// Sum over all pixels of what a picture shows.
pub(crate) fn shown(picture: &Picture) -> f64 {
    picture.rgba.iter().map(|p| f64::from(p[3])).sum()
}

/// Of one channel of one pixel.
pub(crate) fn largest_difference(one: &Picture, other: &Picture) -> f32 {
    let pixels = one.rgba.iter().flatten().zip(other.rgba.iter().flatten());
    pixels.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}
