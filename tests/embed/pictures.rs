//! Pictures in the host's frame against those of the library's own device.

use ash::vk;
use umbravox::embed::{Background, FrameCamera};
use umbravox::gpu::HostMemory;
use umbravox::scene::{
    Light, Lighting, OpticalModel, PhaseFunction, Scattering, ScatteringMethod, View,
    srgb_from_linear,
};

use crate::camera::{DepthKind, HostCamera};
use crate::host::{Host, Look, Stage};
use crate::scenes::{SIZE, Subject, ball, noise, spheres};

/// Depth planes of the cameras, mm from the eye.
const PLANES: [f64; 2] = [0.5, 4000.0];
/// What 32-bit floats may differ by.
const FLOAT_TOLERANCE: f64 = 1e-5;
/// And where rays are computed from another eye: a rounding of positions is one of places in the pre-integrated table.
const OTHER_EYE_TOLERANCE: f64 = 2e-5;
/// One step of an 8-bit picture.
const BYTE_TOLERANCE: f64 = 1.0 / 255.0;
/// Half a step of a 16-bit float, relative.
const HALF_ROUNDING: f64 = 1.0 / 2048.0;

const RGBA8: vk::Format = vk::Format::R8G8B8A8_UNORM;
const RGBA16F: vk::Format = vk::Format::R16G16B16A16_SFLOAT;
const RGBA32F: vk::Format = vk::Format::R32G32B32A32_SFLOAT;

/// Largest difference of a channel.
pub(crate) fn difference(a: &[[f64; 4]], b: &[[f64; 4]]) -> f64 {
    assert_eq!(a.len(), b.len());
    let channels = a.iter().flatten().zip(b.iter().flatten());
    channels.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// The picture of a volume alone.
pub(crate) fn alone(subject: &Subject, size: [u32; 2]) -> Vec<[f64; 4]> {
    let picture = subject.headless_picture(subject.view(size), size);
    let as_f64 = |pixel: &[f32; 4]| pixel.map(f64::from);
    let pixels: Vec<_> = picture.rgba.iter().map(as_f64).collect();
    let seen = pixels.iter().filter(|p| p[3] > 0.01).count();
    assert!(seen > pixels.len() / 20, "{seen} pixels show something");
    pixels
}

/// `C + (1 - A) behind`.
pub(crate) fn over(front: &[[f64; 4]], behind: &[[f64; 4]]) -> Vec<[f64; 4]> {
    let pairs = front.iter().zip(behind);
    pairs
        .map(|(f, b)| std::array::from_fn(|i| f[i] + (1.0 - f[3]) * b[i]))
        .collect()
}

/// A scene of the host: a colour for every pixel, opaque.
pub(crate) fn scenery(size: [u32; 2]) -> Vec<[f64; 4]> {
    let [width, height] = size.map(f64::from);
    let pixels = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (f64::from(x), f64::from(y))));
    pixels
        .map(|(x, y)| [x / width, 0.5 + 0.5 * (0.7 * x).sin(), y / height, 1.0])
        .collect()
}

fn with_rgb(pixels: &[[f64; 4]], f: impl Fn(f64) -> f64) -> Vec<[f64; 4]> {
    let each = |&[r, g, b, a]: &[f64; 4]| [f(r), f(g), f(b), a];
    pixels.iter().map(each).collect()
}

#[test]
fn every_way_of_giving_the_camera_gives_the_headless_picture() {
    for (name, subject) in [("u8", spheres()), ("i16", ball()), ("f32", noise())] {
        let expected = alone(&subject, SIZE);
        let view = subject.view(SIZE);
        let host = Host::new();
        let context = host.context(HostMemory::GpuAllocator);
        let mut renderer = subject.renderer(&context);
        let mut stage = Stage::new(&host, RGBA32F, SIZE);
        let matrices = [DepthKind::Normal, DepthKind::Reversed]
            .map(|kind| HostCamera::new(&view, SIZE, kind, PLANES).frame_camera());
        for camera in [FrameCamera::View(view)].into_iter().chain(matrices) {
            let look = Look {
                camera,
                background: Background::Transparent,
                encode_srgb: false,
            };
            let picture = stage.draw(&look, &mut [&mut renderer]);
            let worst = difference(&picture, &expected);
            println!("{name}: {worst:.1e}");
            assert!(worst <= FLOAT_TOLERANCE, "{name}: {worst:e}");
        }
        stage.destroy();
        drop((renderer, context));
        host.finish();
    }
}

/// Hosts put the eye of an orthographic camera anywhere, and the near plane behind it: rays start where geometry is drawn.
#[test]
fn parallel_rays_start_at_the_near_plane() {
    let subject = ball();
    let expected = alone(&subject, SIZE);
    let view = subject.view(SIZE);
    let host = Host::new();
    let context = host.context(HostMemory::GpuAllocator);
    let mut renderer = subject.renderer(&context);
    let mut stage = Stage::new(&host, RGBA32F, SIZE);
    let inside = View {
        eye: view.eye + view.forward * 76.0,
        ..view
    };
    for kind in [DepthKind::Normal, DepthKind::Reversed] {
        let look = Look {
            camera: HostCamera::new(&inside, SIZE, kind, [-500.0, 500.0]).frame_camera(),
            background: Background::Transparent,
            encode_srgb: false,
        };
        let picture = stage.draw(&look, &mut [&mut renderer]);
        let worst = difference(&picture, &expected);
        assert!(worst <= OTHER_EYE_TOLERANCE, "{kind:?}: {worst:e}");
    }
    stage.destroy();
    drop((renderer, context));
    host.finish();
}

#[test]
fn backgrounds_and_formats_keep_their_meaning() {
    let subject = spheres();
    let color = [0.2, 0.5, 0.05];
    let volume = alone(&subject, SIZE);
    let scene = scenery(SIZE);
    let host = Host::new();
    let context = host.context(HostMemory::GpuAllocator);
    let mut renderer = subject.renderer(&context);
    let mut stage = Stage::new(&host, RGBA8, SIZE);
    for format in [RGBA8, RGBA16F, RGBA32F] {
        for (background, behind) in [
            (Background::Transparent, vec![[0.0; 4]; scene.len()]),
            (
                Background::Color(color.map(|c| c as f32)),
                vec![[color[0], color[1], color[2], 1.0]; scene.len()],
            ),
            (Background::Target, scene.clone()),
        ] {
            // Bytes are display values.
            let encode_srgb = format == RGBA8;
            stage.resize(format, SIZE);
            if background == Background::Target {
                let linear = |c| if encode_srgb { srgb_from_linear(c) } else { c };
                stage.set_contents(&with_rgb(&behind, linear));
            }
            let look = Look {
                camera: FrameCamera::View(subject.view(SIZE)),
                background,
                encode_srgb,
            };
            let picture = stage.draw(&look, &mut [&mut renderer]);
            let mut expected = over(&volume, &behind);
            let tolerance = match format {
                RGBA8 => {
                    expected = with_rgb(&expected, srgb_from_linear);
                    BYTE_TOLERANCE
                }
                RGBA16F => {
                    // Once for what was there, once for what is there now.
                    2.0 * HALF_ROUNDING
                }
                _ => FLOAT_TOLERANCE,
            };
            let worst = difference(&picture, &expected);
            println!("{format:?}, {background:?}: {worst:.1e}");
            assert!(worst <= tolerance, "{format:?}, {background:?}: {worst:e}");
        }
    }
    stage.destroy();
    drop((renderer, context));
    host.finish();
}

/// Light volumes of the optical models are solved in the host's frames, and paths summed there.
#[test]
fn optical_models_are_the_same_in_a_hosts_frames() {
    let light = Light::Directional {
        direction: [0.3, -1.0, 0.6],
        irradiance: [3.0, 2.5, 2.0],
    };
    let ordinates = Scattering {
        resolution: Some(8),
        directions: 24,
        tolerance: 0.0,
        iterations: Some(6),
        ..Default::default()
    };
    let paths = Scattering {
        method: ScatteringMethod::MonteCarlo,
        samples: 5,
        ..Default::default()
    };
    for (model, scattering) in [
        (OpticalModel::Absorption, Scattering::default()),
        (OpticalModel::ShadowedScattering, Scattering::default()),
        (OpticalModel::MultipleScattering, ordinates),
        (OpticalModel::MultipleScattering, paths),
    ] {
        let mut subject = ball();
        subject.scene.ambient_occlusion = None;
        subject.scene.march.classification = None;
        subject.scene.lighting = Lighting {
            model,
            lights: if model.scatters() {
                vec![light.clone()]
            } else {
                Vec::new()
            },
            phase: PhaseFunction::HenyeyGreenstein {
                g: if model.scatters() { 0.4 } else { 0.0 },
            },
            scattering,
            ..Default::default()
        };
        let expected = alone(&subject, SIZE);
        let host = Host::new();
        let context = host.context(HostMemory::GpuAllocator);
        let mut renderer = subject.renderer(&context);
        let mut stage = Stage::new(&host, RGBA32F, SIZE);
        let look = Look {
            camera: FrameCamera::View(subject.view(SIZE)),
            background: Background::Transparent,
            encode_srgb: false,
        };
        let picture = stage.draw(&look, &mut [&mut renderer]);
        let worst = difference(&picture, &expected);
        println!("{model:?}: {worst:.1e}");
        assert!(worst <= FLOAT_TOLERANCE, "{model:?}: {worst:e}");
        stage.destroy();
        drop((renderer, context));
        host.finish();
    }
}
