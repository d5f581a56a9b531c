//! Volumes with what they are drawn by, and their pictures by a device of the library's own.

use std::sync::Arc;

use glam::DVec3;
use umbravox::embed::{Context, Renderer, Settings};
use umbravox::headless::{Headless, Options};
use umbravox::picture::Picture;
use umbravox::scene::{
    AmbientOcclusion, Camera, ControlPoint, Image, Lighting, March, Scene, Shading, Storage,
    TransferFunction, View, VolumeSource,
};
use umbravox::volume::{Rescale, Volume, VoxelType};

use crate::fields::{blobs, placed, radial, sampled, value_noise};
use crate::host::validate_across_submissions;

/// Width and height of most pictures.
pub(crate) const SIZE: [u32; 2] = [44, 36];

/// A volume and its scene.
pub(crate) struct Subject {
    pub(crate) volume: Arc<Volume>,
    pub(crate) scene: Scene,
}

impl Subject {
    pub(crate) fn settings(&self) -> Settings {
        Settings::of_scene(&self.scene, &self.volume).unwrap()
    }

    pub(crate) fn view(&self, size: [u32; 2]) -> View {
        self.scene.camera.view(&self.volume, size).unwrap()
    }

    pub(crate) fn renderer(&self, context: &Arc<Context>) -> Renderer {
        Renderer::new(context, Arc::clone(&self.volume), self.settings()).unwrap()
    }

    /// The picture without a host, light complete.
    pub(crate) fn headless_picture(&self, view: View, size: [u32; 2]) -> Picture {
        validate_across_submissions();
        let options = Options {
            validation: true,
            pipeline_cache: false,
            ..Default::default()
        };
        let headless = Headless::new(&options).unwrap();
        let mut scene = self.scene.clone();
        scene.image.size = size;
        let mut session = headless.load(Arc::clone(&self.volume), &scene).unwrap();
        session.set_view(view);
        while session.refine_light().unwrap() {}
        let picture = session.frame().unwrap();
        assert_eq!(headless.validation_messages(), [""; 0]);
        picture
    }
}

pub(crate) fn subject(volume: Volume, camera: Camera, points: Vec<ControlPoint>) -> Subject {
    Subject {
        volume: Arc::new(volume),
        scene: Scene {
            volume: VolumeSource {
                path: "in-memory".into(),
                ..Default::default()
            },
            camera,
            image: Image::default(),
            transfer_function: TransferFunction {
                unit_distance: Some(1.0),
                points: Some(points),
                ..Default::default()
            },
            march: March::default(),
            lighting: Lighting::default(),
            ambient_occlusion: None,
            storage: Storage::default(),
        },
    }
}

pub(crate) fn point(value: f64, color: [f64; 3], opacity: f64, emission: [f64; 3]) -> ControlPoint {
    ControlPoint {
        value,
        color,
        opacity,
        emission,
        source: [0.0; 3],
    }
}

/// From transparent at `low` to `opacity` at `high`.
pub(crate) fn rise(low: f64, high: f64, opacity: f64) -> Vec<ControlPoint> {
    vec![
        point(low, [0.1, 0.2, 0.9], 0.0, [0.0; 3]),
        point(high, [1.0, 0.8, 0.5], opacity, [0.0; 3]),
    ]
}

/// Soft spheres in 8 bits, seen in perspective; nothing but emission and absorption.
pub(crate) fn spheres() -> Subject {
    let placement = placed([1.0; 3], [0.0, 0.0, 1.0], 20.0, [-14.0, -20.0, -9.0]);
    let plain = Rescale::default();
    let volume = sampled(
        VoxelType::U8,
        [34, 30, 26],
        placement,
        plain,
        [0.0, 255.0],
        blobs,
    );
    let camera = Camera::Auto {
        azimuth: 25.0,
        elevation: 15.0,
        zoom: 1.2,
        frame: Default::default(),
    };
    subject(volume, camera, rise(40.0, 200.0, 0.5))
}

/// A ball in 16 bits with anisotropic voxels, seen in parallel; shaded, with ambient occlusion and emission.
pub(crate) fn ball() -> Subject {
    let placement = placed(
        [1.0, 0.8, 1.9],
        [1.0, 0.3, 0.0],
        30.0,
        [-20.0, -10.0, -12.0],
    );
    let hounsfield = Rescale {
        slope: 1.0,
        intercept: -1024.0,
    };
    let volume = sampled(
        VoxelType::I16,
        [36, 33, 17],
        placement,
        hounsfield,
        [0.0, 2000.0],
        radial,
    );
    let middle = DVec3::from_array(volume.size().map(|n| 0.5 * f64::from(n - 1)));
    let target = volume.world_from_ix().transform_point3(middle);
    let camera = Camera::Orthographic {
        eye: (target + DVec3::new(40.0, -60.0, 25.0)).to_array(),
        target: target.to_array(),
        up: [0.0, 0.0, 1.0],
        height: 42.0,
    };
    let mut points = rise(-200.0, 900.0, 0.3);
    points[1].emission = [0.0, 0.1, 0.3];
    let mut ball = subject(volume, camera, points);
    ball.scene.lighting.shading = Shading::Diffuse;
    ball.scene.ambient_occlusion = Some(AmbientOcclusion {
        rays: 5,
        radius: 8.0,
        ..Default::default()
    });
    ball
}

/// Noise in floats, which texture units need not filter, with ambient occlusion.
pub(crate) fn noise() -> Subject {
    let field = |p| value_noise(p, 5.0, 11);
    let placement = placed([0.5; 3], [0.0, 1.0, 0.0], 0.0, [0.0; 3]);
    let plain = Rescale::default();
    let volume = sampled(
        VoxelType::F32,
        [33, 20, 25],
        placement,
        plain,
        [-1.0, 1.0],
        field,
    );
    let mut noise = subject(volume, Camera::default(), rise(0.0, 0.8, 0.6));
    noise.scene.ambient_occlusion = Some(AmbientOcclusion {
        rays: 4,
        ..Default::default()
    });
    noise
}

/// A homogeneous medium of one `color` and `opacity` over 1 mm, filling a box.
pub(crate) fn slab(camera: Camera, color: [f64; 3], opacity: f64) -> Subject {
    let placement = placed([1.0, 1.5, 0.75], [0.2, 0.1, 1.0], 25.0, [-9.0, -14.0, -8.0]);
    let plain = Rescale::default();
    let volume = sampled(
        VoxelType::F32,
        [20, 18, 21],
        placement,
        plain,
        [0.0, 1.0],
        |_| 0.5,
    );
    subject(volume, camera, vec![point(0.0, color, opacity, [0.0; 3])])
}
