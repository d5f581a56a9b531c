//! The life of a host: two volumes in one command buffer, three frames in flight, a window that is resized, edits and moves
//! of the camera while frames are in flight, one volume dropped in mid-flight while the other goes on, and an orderly end.

use ash::vk;
use umbravox::embed::{Background, Context, Renderer};
use umbravox::gpu::HostMemory;
use umbravox::headless::{Headless, Session};
use umbravox::scene::View;

use crate::camera::{DepthKind, HostCamera};
use crate::host::{Host, Look, SAMPLED, Stage, record};
use crate::pictures::{alone, difference, over, scenery};
use crate::scenes::{SIZE, Subject, ball, spheres};

const RGBA8: vk::Format = vk::Format::R8G8B8A8_UNORM;
const RGBA16F: vk::Format = vk::Format::R16G16B16A16_SFLOAT;
const RGBA32F: vk::Format = vk::Format::R32G32B32A32_SFLOAT;
const FLOAT_TOLERANCE: f64 = 1e-5;

/// Renderers move to the thread that records; contexts are shared between threads.
#[test]
fn threads_may_share_contexts_and_take_renderers() {
    fn shared<T: Send + Sync>() {}
    fn moved<T: Send>() {}
    shared::<Context>();
    moved::<Renderer>();
    moved::<Headless>();
    moved::<Session>();
}

fn look(view: &View, size: [u32; 2]) -> Look {
    Look {
        camera: HostCamera::new(view, size, DepthKind::Reversed, [1.0, 2000.0]).frame_camera(),
        background: Background::Target,
        encode_srgb: false,
    }
}

/// Both volumes seen by one camera.
fn pair() -> (Subject, Subject) {
    let (spheres, mut ball) = (spheres(), ball());
    ball.scene.camera = spheres.scene.camera.clone();
    (spheres, ball)
}

#[test]
fn two_volumes_blend_in_one_command_buffer() {
    let (spheres, mut ball) = pair();
    let view = spheres.view(SIZE);
    let scene = scenery(SIZE);
    let as_seen = |subject: &Subject| -> Vec<[f64; 4]> {
        let picture = subject.headless_picture(view, SIZE);
        picture.rgba.iter().map(|p| p.map(f64::from)).collect()
    };
    ball.scene.march.early_termination = 1.0;
    let expected = over(&as_seen(&spheres), &over(&as_seen(&ball), &scene));
    let host = Host::new();
    let context = host.context(HostMemory::GpuAllocator);
    let mut back = ball.renderer(&context);
    let mut front = spheres.renderer(&context);
    let mut stage = Stage::new(&host, RGBA32F, SIZE);
    stage.set_contents(&scene);
    let picture = stage.draw(&look(&view, SIZE), &mut [&mut back, &mut front]);
    let worst = difference(&picture, &expected);
    println!("two volumes: {worst:.1e}");
    assert!(worst <= FLOAT_TOLERANCE, "{worst:e}");
    stage.destroy();
    drop((front, back, context));
    host.finish();
}

#[test]
fn a_session_of_a_host() {
    let (spheres, ball) = pair();
    let mut edited = spheres.settings();
    edited.curve.points[1].optical.opacity = 0.9;
    let host = Host::new();
    let context = host.context(HostMemory::GpuAllocator);
    let mut size = SIZE;
    let mut stage = Stage::new(&host, RGBA8, size);
    let mut front = Some(spheres.renderer(&context));
    let mut back = Some(ball.renderer(&context));
    let mut view = spheres.view(size);
    for step in 0..48 {
        view = view.orbited(&spheres.volume, 7.0);
        match step {
            // The window changes its size, and shows other formats.
            8 | 16 | 17 | 30 => {
                size = [20 + 3 * step, 60 - step];
                stage.resize([RGBA8, RGBA16F, RGBA32F][step as usize % 3], size);
                stage.set_contents(&scenery(size));
                stage.set_depth(&vec![0.001; (size[0] * size[1]) as usize]);
            }
            // Edits of the transfer function, of levels, of shading, all while frames are in flight.
            12 | 13 => {
                let front = front.as_mut().expect("not dropped yet");
                let settings = if step == 12 {
                    edited.clone()
                } else {
                    spheres.settings()
                };
                front.set_settings(settings).unwrap();
            }
            20 => {
                let back = back.as_mut().expect("not dropped yet");
                let mut settings = back.settings().clone();
                settings.storage.data_reduction = 8.0;
                back.set_settings(settings).unwrap();
            }
            22 => {
                let back = back.as_mut().expect("not dropped yet");
                let mut settings = ball.settings();
                settings.ambient_occlusion = None;
                back.set_settings(settings).unwrap();
            }
            25 => {
                let back = back.as_mut().expect("not dropped yet");
                back.set_settings(ball.settings()).unwrap();
            }
            // One volume goes while its frames are in flight, the other stays.
            34 => front = None,
            // And one comes, before the other goes.
            40 => front = Some(spheres.renderer(&context)),
            44 => back = None,
            _ => {}
        }
        let frame = stage.begin();
        let mut volumes: Vec<_> = back.iter_mut().chain(front.iter_mut()).collect();
        let look = Look {
            background: if step < 8 {
                Background::Color([0.1, 0.2, 0.3])
            } else {
                Background::Target
            },
            ..look(&view, size)
        };
        let count = volumes.len();
        for (place, volume) in volumes.iter_mut().enumerate() {
            let input = stage.input(&frame, &look, place, count);
            record(volume, &frame, &input).unwrap();
        }
        stage.submit(&frame);
    }
    let mut front = front.expect("it came again");
    let seen: Vec<_> = front.pass_times().iter().map(|(name, _)| *name).collect();
    assert!(seen.contains(&"march"), "{seen:?}");
    assert_eq!(front.last_pass(), Some("march"));

    // What is left draws as if nothing had happened.
    let view = spheres.view(SIZE);
    stage.resize(RGBA32F, SIZE);
    stage.set_contents(&scenery(SIZE));
    let frame = stage.begin();
    let input = stage.input(&frame, &look(&view, SIZE), 0, 1);
    assert!(record(&mut front, &frame, &input).unwrap().is_complete());
    let picture = stage.read(&frame, SAMPLED);
    let worst = difference(&picture, &over(&alone(&spheres, SIZE), &scenery(SIZE)));
    assert!(worst <= FLOAT_TOLERANCE, "{worst:e}");

    drop(front);
    let newest = stage.destroy();
    assert!(context.allocated_bytes() > 0);
    // SAFETY: the stage has waited for all its frames.
    unsafe { context.collect(newest) };
    assert_eq!(context.allocated_bytes(), 0);
    drop(context);
    host.finish();
}

/// Memory is bounded while edits and frames go on: what frames no longer need is destroyed while others are in flight.
#[test]
fn memory_does_not_grow_with_frames() {
    let spheres = spheres();
    let host = Host::new();
    let context = host.context(HostMemory::GpuAllocator);
    let mut renderer = spheres.renderer(&context);
    let mut stage = Stage::new(&host, RGBA8, SIZE);
    let look = Look {
        background: Background::Transparent,
        ..look(&spheres.view(SIZE), SIZE)
    };
    let mut most = [0; 2];
    for step in 0..60 {
        let mut settings = spheres.settings();
        settings.curve.points[1].optical.opacity = 0.3 + 0.01 * f64::from(step % 7);
        renderer.set_settings(settings).unwrap();
        let frame = stage.begin();
        let input = stage.input(&frame, &look, 0, 1);
        record(&mut renderer, &frame, &input).unwrap();
        stage.submit(&frame);
        let half = &mut most[step as usize / 30];
        *half = context.allocated_bytes().max(*half);
    }
    assert!(most[0] > 0 && most[1] <= most[0], "{most:?}");
    stage.destroy();
    drop((renderer, context));
    host.finish();
}
