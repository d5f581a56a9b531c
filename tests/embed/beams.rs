//! Beams change no bit of a host's frame: over what its target holds, up to its geometry, in every format.

use ash::vk;
use glam::DVec3;
use umbravox::embed::{Background, Renderer};
use umbravox::gpu::HostMemory;
use umbravox::scene::{Camera, Classification};
use umbravox::volume::{Volume, Voxels};

use crate::camera::{DepthKind, HostCamera};
use crate::host::{Host, Look, Stage};
use crate::pictures::scenery;
use crate::scenes::{SIZE, Subject, rise, subject};

const EDGE: u32 = 40;
/// Depth planes of the camera, mm from the eye.
const PLANES: [f64; 2] = [1.0, 300.0];

fn volume(width: u32, spacing: [f64; 3], shows: impl Fn(DVec3) -> bool) -> Volume {
    let voxels = (0..width * EDGE * EDGE)
        .map(|i| [i % width, i / width % EDGE, i / (width * EDGE)].map(f64::from))
        .map(|p| if shows(DVec3::from_array(p)) { 255 } else { 0 })
        .collect();
    Volume::axis_aligned(Voxels::U8(voxels), [width, EDGE, EDGE], spacing).unwrap()
}

/// A wall of one voxel across rays along x. Steps of 8.2 voxels have it between the last sample of one bit's four segments and the first
/// of the next, so that only a ray that the host's geometry ends just there samples it.
fn wall() -> Subject {
    let camera = Camera::Orthographic {
        eye: [-20.0, 19.0, 20.0],
        target: [20.0, 19.0, 20.0],
        up: [0.0, 0.0, 1.0],
        height: 50.0,
    };
    subject(
        volume(2 * EDGE, [1.0; 3], |p| p.x == 34.0),
        camera,
        rise(60.0, 255.0, 0.4),
    )
}

/// A wall of one voxel, askew, and a ball: most rays meet them for less than a long step.
fn thin() -> Subject {
    let volume = volume(EDGE, [1.0, 0.9, 1.2], |p| {
        let wall = (p.x + 0.3 * p.y - 22.0).abs() < 0.6 && p.z > 15.0;
        wall || p.distance(DVec3::new(9.0, 28.0, 8.0)) < 3.0
    });
    let camera = Camera::Perspective {
        eye: [-50.0, 5.0, 40.0],
        target: [18.0, 18.0, 22.0],
        up: [0.0, 0.0, 1.0],
        fov_y: 40.0,
    };
    subject(volume, camera, rise(60.0, 255.0, 0.4))
}

/// A scene, its step in voxels, and the distance of the nearest geometry, mm.
type Scene = (fn() -> Subject, f64, f64);

#[test]
fn beams_change_no_bit_of_a_hosts_frame() {
    let host = Host::new();
    let context = host.context(HostMemory::GpuAllocator);
    let formats = [
        vk::Format::R8G8B8A8_UNORM,
        vk::Format::R16G16B16A16_SFLOAT,
        vk::Format::R32G32B32A32_SFLOAT,
    ];
    let mut stage = Stage::new(&host, formats[0], SIZE);
    let behind = scenery(SIZE);
    let mut shown = 0;
    let scenes: [Scene; 3] = [(thin, 0.7, 45.0), (thin, 6.0, 45.0), (wall, 8.2, 50.0)];
    for (scene, step, nearest) in scenes {
        for classification in [
            Classification::Post,
            Classification::Pre,
            Classification::Preintegrated,
        ] {
            let mut subject = scene();
            subject.scene.march.step = step;
            subject.scene.march.classification = Some(classification);
            let view = subject.view(SIZE);
            let camera = HostCamera::new(&view, SIZE, DepthKind::Normal, PLANES);
            let mut by_beams = subject.renderer(&context);
            subject.scene.march.beams = false;
            let mut by_rays = subject.renderer(&context);
            let (origin, direction) = view.ray(SIZE.map(|n| 0.5 * f64::from(n)), SIZE);
            for case in 0..27 {
                let format = formats[case % 3];
                // Geometry at growing distances, and none.
                let distance = nearest + 0.9 * case as f64;
                let depth = match case {
                    26 => camera.cleared(),
                    _ => camera.depth_of(origin + direction * distance),
                };
                let look = Look {
                    camera: camera.frame_camera(),
                    background: if case % 4 == 3 {
                        Background::Transparent
                    } else {
                        Background::Target
                    },
                    encode_srgb: case % 2 == 0,
                };
                let nearer = camera.depth_of(origin + direction * 5.0);
                let mut draw = |renderer: &mut Renderer, depth| {
                    stage.resize(format, SIZE);
                    stage.set_contents(&behind);
                    stage.set_depth(&vec![depth; behind.len()]);
                    stage.draw(&look, &mut [renderer])
                };
                let empty = draw(&mut by_rays, nearer);
                let pictures = [&mut by_beams, &mut by_rays].map(|renderer| draw(renderer, depth));
                shown += usize::from(pictures[1] != empty);
                let differing = pictures[0].iter().zip(&pictures[1]);
                let differing = differing.filter(|(a, b)| a != b).count();
                assert_eq!(differing, 0, "step {step}, {classification:?}, case {case}");
            }
        }
    }
    assert!(shown > 50, "{shown} pictures show something");
    stage.destroy();
    drop(context);
    host.finish();
}
