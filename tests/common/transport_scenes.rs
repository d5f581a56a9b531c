//! Scenes of scattering media in tests/data/transport, and what another renderer makes of them:
//! tests/data/generate/transport.py says how they came to be.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::DVec3;
use umbravox::io::{self, ReadOptions};
use umbravox::reference::transport::{self, Estimate, Illumination, Medium};
use umbravox::scene::{Curve, Scene, View};
use umbravox::volume::{Volume, Voxels};

/// Scattered once.
pub(crate) const SINGLE: [&str; 4] = [
    "box_directional_single",
    "box_point_single_forward",
    "cloud_rayleigh_single",
    "cloud_lambert_single",
];

/// Scattered any number of times; and the paths of every pixel that make means of blocks normal. Forward peaks towards a
/// light are met seldom, and count much.
pub(crate) const MULTIPLE: [(&str, u32); 7] = [
    ("box_thin_backward", 32),
    ("box_thick_constant", 32),
    ("box_forward", 256),
    ("cloud_sun", 128),
    ("cloud_chromatic", 64),
    ("blobs_sky", 32),
    ("blobs_spot", 32),
];
/// Edge of those blocks, pixels.
pub(crate) const BLOCK: u32 = 8;

/// A scene, ready for any renderer.
pub(crate) struct TransportScene {
    pub(crate) scene: Scene,
    pub(crate) volume: Arc<Volume>,
    pub(crate) curve: Curve,
    pub(crate) view: View,
    /// What Mitsuba 3 estimates: scattered radiance.
    pub(crate) expected: Estimate,
    surroundings: Option<Arc<Surroundings>>,
}

type Surroundings = dyn Fn(DVec3) -> DVec3 + Send + Sync;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/transport")
}

impl TransportScene {
    pub(crate) fn load(name: &str) -> Self {
        let scene = Scene::read(&folder().join(format!("{name}.json")), &[]).expect("a scene");
        let options = ReadOptions::from(&scene.volume);
        let volume = Arc::new(io::volume_of(&scene.volume, &options).expect("a volume"));
        let colors = scene.image.color_management;
        let curve = scene
            .transfer_function
            .curve(&volume, colors)
            .expect("a curve");
        let view = scene
            .camera
            .view(&volume, scene.image.size)
            .expect("a view");
        let environment = scene.lighting.environment.as_ref();
        let surroundings = environment.map(|environment| match environment.radiance {
            Some(radiance) => {
                let radiance = DVec3::from_array(radiance);
                Arc::new(move |_: DVec3| radiance) as Arc<Surroundings>
            }
            None => Arc::new(sky),
        });
        let [mean, variance] = ["mean", "variance"].map(|what| {
            let path = folder().join(format!("{name}.{what}.npy"));
            pixels(&path, scene.image.size)
        });
        Self {
            expected: Estimate {
                size: scene.image.size,
                mean,
                variance,
            },
            scene,
            volume,
            curve,
            view,
            surroundings,
        }
    }

    /// The same volume, seen from the same place in another scene; `expected` and the light from all around stay.
    #[allow(dead_code, reason = "not every test program changes scenes")]
    pub(crate) fn with(&self, scene: Scene) -> Self {
        let colors = scene.image.color_management;
        let curve = scene.transfer_function.curve(&self.volume, colors);
        Self {
            volume: Arc::clone(&self.volume),
            curve: curve.expect("a curve"),
            view: self.view,
            expected: self.expected.clone(),
            surroundings: self.surroundings.clone(),
            scene,
        }
    }

    pub(crate) fn medium(&self) -> Medium<'_> {
        Medium::new(&self.volume, &self.curve, &self.scene.lighting).expect("a medium")
    }

    pub(crate) fn illumination(&self) -> Illumination<'_> {
        let surroundings = self.surroundings.as_deref();
        Illumination {
            lights: &self.scene.lighting.lights,
            surroundings: surroundings.map(|s| -> transport::Surroundings<'_> { s }),
            phase: &self.scene.lighting.phase,
        }
    }
}

/// The function that `sky.exr` was sampled from, as in the script.
fn sky(towards: DVec3) -> DVec3 {
    let [horizon, zenith, sun] = [
        DVec3::new(0.5, 0.45, 0.4),
        DVec3::new(0.2, 0.35, 0.8),
        DVec3::new(2.0, 1.6, 1.0),
    ];
    let height = (0.5 + 0.5 * towards.z).powi(2);
    let glare = (4.0 * (towards.dot(DVec3::new(0.6, -0.48, 0.64)) - 1.0)).exp();
    horizon + (zenith - horizon) * height + sun * glare
}

/// A picture stored as [row, column, channel].
fn pixels(path: &Path, [width, height]: [u32; 2]) -> Vec<DVec3> {
    let stored = io::read(path, &ReadOptions::default()).expect("a picture");
    assert_eq!(stored.size(), [3, width, height], "{}", path.display());
    let Voxels::F32(values) = stored.voxels() else {
        panic!("{} is not of 32-bit floats", path.display());
    };
    let pixel = |v: &[f32]| DVec3::new(v[0].into(), v[1].into(), v[2].into());
    values.chunks_exact(3).map(pixel).collect()
}
