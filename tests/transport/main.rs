//! The optical models on the device: against the f64 reference, and against the pictures of Mitsuba 3 in tests/data/transport.
//! What each picture differed by is printed (`--nocapture`).

#[path = "../common/transport_scenes.rs"]
mod transport_scenes;
#[path = "../common/z_test.rs"]
mod z_test;

mod furnace;
mod light;
mod multiple;
mod single;
mod straight;

use std::sync::Arc;

use glam::DVec3;
use rayon::prelude::*;
use umbravox::headless::{Headless, Options};
use umbravox::picture::Picture;
use umbravox::reference::Ray;
use umbravox::reference::transport::{Estimate, RayLight};
use umbravox::scene::{Scene, View};
use umbravox::volume::Volume;

/// A device with validation: any message of the layers is an error.
fn headless() -> Headless {
    let options = Options {
        validation: true,
        ..Default::default()
    };
    Headless::new(&options).expect("a Vulkan device and the validation layer are installed")
}

/// One picture of a scene, and no message of the validation layer.
fn picture(headless: &Headless, volume: &Arc<Volume>, scene: &Scene) -> Picture {
    let mut session = headless.load(Arc::clone(volume), scene).expect("a session");
    while session.refine_light().expect("light") {}
    let picture = session.frame().expect("a picture");
    assert_eq!(headless.validation_messages(), Vec::<String>::new());
    picture
}

/// One picture as the mean that it is, of no variance.
fn without_noise(picture: &Picture) -> Estimate {
    let color = |&[r, g, b, _]: &[f32; 4]| DVec3::new(r.into(), g.into(), b.into());
    Estimate {
        size: picture.size,
        mean: picture.rgba.iter().map(color).collect(),
        variance: vec![DVec3::ZERO; picture.rgba.len()],
    }
}

/// What rays through the middles of the pixels bring, by rows.
fn rays(
    view: &View,
    [width, height]: [u32; 2],
    light: impl Fn(Ray) -> RayLight + Sync,
) -> Vec<RayLight> {
    (0..width * height)
        .into_par_iter()
        .map(|at| {
            let pixel = [at % width, at / width].map(|c| f64::from(c) + 0.5);
            let (origin, direction) = view.ray(pixel, [width, height]);
            light(Ray { origin, direction })
        })
        .collect()
}

/// How far a picture is from what it should show, as shares of the largest value there.
struct Difference {
    largest: f64,
    mean: f64,
}

impl Difference {
    fn between(found: impl Iterator<Item = DVec3>, expected: impl Iterator<Item = DVec3>) -> Self {
        let [mut largest, mut sum, mut brightest] = [0.0_f64; 3];
        let mut count = 0.0;
        for (found, expected) in found.zip(expected) {
            let difference = (found - expected).abs();
            largest = largest.max(difference.max_element());
            sum += difference.element_sum() / 3.0;
            brightest = brightest.max(expected.max_element());
            count += 1.0;
        }
        assert!(brightest > 0.0, "nothing is lit");
        Self {
            largest: largest / brightest,
            mean: sum / count / brightest,
        }
    }

    /// Of the light that the volume adds.
    fn of_radiance(picture: &Picture, expected: &[RayLight]) -> Self {
        let found = without_noise(picture).mean;
        Self::between(found.into_iter(), expected.iter().map(|e| e.radiance))
    }

    /// Prints it, and panics when a pixel is further off than `largest`.
    fn assert_below(&self, largest: f64, what: &str) {
        let percent = |share: f64| format!("{:.3} %", 100.0 * share);
        let found = format!(
            "{what}: {} at most, {} in the mean",
            percent(self.largest),
            percent(self.mean)
        );
        println!("{found}");
        assert!(
            self.largest <= largest,
            "{found}; {} allowed",
            percent(largest)
        );
    }
}
