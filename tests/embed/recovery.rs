//! Memory that runs out while a frame is recorded: the next frames mend it, whether the host submits what was recorded or
//! throws it away.

use ash::vk;
use umbravox::Error;
use umbravox::embed::{Background, FrameCamera, Renderer};
use umbravox::gpu::HostMemory;

use crate::backends::Dedicated;
use crate::host::{Host, Look, SAMPLED, Stage, record};
use crate::pictures::{alone, difference};
use crate::scenes::{SIZE, Subject, ball};

const RGBA32F: vk::Format = vk::Format::R32G32B32A32_SFLOAT;
const FLOAT_TOLERANCE: f64 = 1e-5;

/// What the host does with the frame that failed.
#[derive(Clone, Copy, Debug)]
enum Then {
    Submit,
    Discard,
}

fn look(subject: &Subject) -> Look {
    Look {
        camera: FrameCamera::View(subject.view(SIZE)),
        background: Background::Transparent,
        encode_srgb: false,
    }
}

/// Records a frame for which `refused` gets no memory.
fn fail(
    stage: &mut Stage<'_>,
    look: &Look,
    renderer: &mut Renderer,
    memory: &Dedicated,
    refused: &str,
    then: Then,
) {
    memory.refuse(Some(refused));
    let frame = stage.begin();
    let input = stage.input(&frame, look, 0, 1);
    let error = record(renderer, &frame, &input).unwrap_err();
    memory.refuse(None);
    assert!(
        matches!(&error, Error::OutOfMemory { what, .. } if what == refused),
        "{error}"
    );
    match then {
        Then::Submit => stage.submit(&frame),
        Then::Discard => stage.discard(&frame),
    }
}

#[test]
fn frames_that_fail_are_mended_by_the_next() {
    let subject = ball();
    let expected = alone(&subject, SIZE);
    let host = Host::new();
    let memory = Dedicated::new(&host);
    let context = host.context(HostMemory::Custom(memory.clone()));
    let look = look(&subject);
    let mut stage = Stage::new(&host, RGBA32F, SIZE);
    for refused in [
        "umbravox.frame.uniforms",
        "umbravox.upload.bricks",
        "umbravox.upload.index",
        "umbravox.upload.transfer",
    ] {
        for then in [Then::Submit, Then::Discard] {
            let mut renderer = subject.renderer(&context);
            fail(&mut stage, &look, &mut renderer, &memory, refused, then);
            let picture = stage.draw(&look, &mut [&mut renderer]);
            let worst = difference(&picture, &expected);
            assert!(worst < FLOAT_TOLERANCE, "{refused}, {then:?}: {worst:e}");
        }
    }
    let newest = stage.destroy();
    // SAFETY: the stage has waited for all its frames.
    unsafe { context.collect(newest) };
    assert_eq!((context.allocated_bytes(), memory.live()), (0, 0));
    drop(context);
    host.finish();
}

/// The light is half done when an edit of the transfer function fails to reach the device.
#[test]
fn a_failed_edit_is_mended_by_the_next_frame() {
    let before = ball();
    let mut after = ball();
    if let Some(points) = &mut after.scene.transfer_function.points {
        // Other places show something, so that light needs other lists.
        points[0].value = 0.0;
        points[1].opacity = 0.9;
    }
    let expected = alone(&after, SIZE);
    for then in [Then::Submit, Then::Discard] {
        let host = Host::new();
        let memory = Dedicated::new(&host);
        let context = host.context(HostMemory::Custom(memory.clone()));
        let mut renderer = before.renderer(&context);
        let look = look(&before);
        let mut stage = Stage::new(&host, RGBA32F, SIZE);
        for _ in 0..3 {
            let frame = stage.begin();
            let input = stage.input(&frame, &look, 0, 1);
            record(&mut renderer, &frame, &input).unwrap();
            stage.submit(&frame);
        }
        // Settings that cannot be had leave the old ones in force.
        memory.refuse(Some("umbravox.trace"));
        assert!(renderer.set_settings(after.settings()).is_err());
        assert_eq!(renderer.settings(), &before.settings());
        memory.refuse(None);
        renderer.set_settings(after.settings()).unwrap();
        let refused = "umbravox.upload.transfer";
        fail(&mut stage, &look, &mut renderer, &memory, refused, then);
        let picture = stage.draw(&look, &mut [&mut renderer]);
        let worst = difference(&picture, &expected);
        assert!(worst < FLOAT_TOLERANCE, "{then:?}: {worst:e}");
        // The picture stays when nothing changes.
        let frame = stage.begin();
        let input = stage.input(&frame, &look, 0, 1);
        assert!(record(&mut renderer, &frame, &input).unwrap().is_complete());
        assert!(stage.read(&frame, SAMPLED) == picture);
        stage.destroy();
        drop((renderer, context));
        host.finish();
    }
}
