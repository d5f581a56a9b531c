//! What a host gets wrong: the message says what, and nothing is recorded.

use ash::vk;
use glam::DMat4;
use glam::dcamera::rh::proj::vulkan::perspective;
use umbravox::embed::{Background, DepthRange, FrameCamera, FrameInput, ImageUse, SceneDepth};
use umbravox::gpu::HostMemory;

use crate::host::{ATTACHMENT, Host, HostImage, Look, SAMPLED, Stage, record};
use crate::pictures::{alone, difference, over, scenery};
use crate::scenes::{SIZE, spheres};

const RGBA32F: vk::Format = vk::Format::R32G32B32A32_SFLOAT;

/// What is done to a frame's input, and what the message has to say.
struct Fault {
    name: &'static str,
    spoil: Box<dyn Fn(&mut FrameInput)>,
    message: Vec<&'static str>,
}

fn fault(
    name: &'static str,
    message: &[&'static str],
    spoil: impl Fn(&mut FrameInput) + 'static,
) -> Fault {
    Fault {
        name,
        spoil: Box::new(spoil),
        message: message.to_vec(),
    }
}

fn matrices(view_from_world: DMat4, clip_from_view: DMat4) -> FrameCamera {
    FrameCamera::Matrices {
        view_from_world,
        clip_from_view,
        depth: DepthRange::Normal,
    }
}

fn undefined(image_use: &mut ImageUse) {
    image_use.layout = vk::ImageLayout::UNDEFINED;
}

fn faults(depth: SceneDepth) -> Vec<Fault> {
    let singular = ["camera", "must be finite and invertible"];
    let projection = perspective(1.0, 1.0, 1.0, 100.0);
    vec![
        fault("frame 0", &["frame index", "frame 0", "must grow"], |i| {
            i.index = 0;
        }),
        fault("an earlier frame", &["frame index", "must grow"], |i| {
            i.index -= 2;
        }),
        fault("completed too early", &["frame index", "completed"], |i| {
            i.completed = i.index;
        }),
        fault("singular view", &singular, move |i| {
            i.camera = matrices(DMat4::ZERO, projection);
        }),
        fault("singular projection", &singular, |i| {
            i.camera = matrices(DMat4::IDENTITY, DMat4::ZERO);
        }),
        fault("not a number", &singular, move |i| {
            i.camera = matrices(DMat4::from_cols_array(&[f64::NAN; 16]), projection);
        }),
        fault(
            "depth without matrices",
            &["depth", "needs a camera given by matrices"],
            move |i| i.depth = Some(depth),
        ),
        fault(
            "undefined depth",
            &["depth.entry.layout", "UNDEFINED"],
            move |i| {
                i.camera = matrices(DMat4::IDENTITY, projection);
                i.depth = Some(depth);
                i.depth.iter_mut().for_each(|d| undefined(&mut d.entry));
            },
        ),
        fault(
            "a format that cannot be read",
            &["target.format", "R16G16B16A16_UNORM", "R8G8B8A8_UNORM"],
            |i| i.target.format = vk::Format::R16G16B16A16_UNORM,
        ),
        fault(
            "blending over nothing",
            &["target.entry.layout", "UNDEFINED"],
            |i| undefined(&mut i.target.entry),
        ),
        fault(
            "no layout at the end",
            &["target.exit.layout", "UNDEFINED"],
            |i| undefined(&mut i.target.exit),
        ),
        fault("no pixels", &["target.size_px", "no pixels"], |i| {
            i.target.size_px[1] = 0;
        }),
    ]
}

#[test]
fn bad_input_is_named_and_records_nothing() {
    let subject = spheres();
    let volume = alone(&subject, SIZE);
    let scene = scenery(SIZE);
    let host = Host::new();
    let context = host.context(HostMemory::GpuAllocator);
    let mut renderer = subject.renderer(&context);
    let depth_image = HostImage::depth(&host, SIZE);
    let depth = SceneDepth {
        image: depth_image.image,
        view: depth_image.view,
        aspects: depth_image.aspect,
        entry: ATTACHMENT,
        exit: ATTACHMENT,
    };
    let mut stage = Stage::new(&host, RGBA32F, SIZE);
    stage.set_contents(&scene);
    let look = Look {
        camera: FrameCamera::View(subject.view(SIZE)),
        background: Background::Target,
        encode_srgb: false,
    };
    for fault in faults(depth) {
        let frame = stage.begin();
        let input = stage.input(&frame, &look, 0, 1);
        let mut spoiled = input;
        (fault.spoil)(&mut spoiled);
        let error = record(&mut renderer, &frame, &spoiled).unwrap_err();
        let shown = error.to_string();
        println!("{}: {shown}", fault.name);
        for part in &fault.message {
            assert!(shown.contains(part), "{}: {shown}", fault.name);
        }
        assert!(error.is_bad_input(), "{}: {error:?}", fault.name);
        let picture = stage.read(&frame, ATTACHMENT);
        assert!(
            difference(&picture, &scene) < 1e-6,
            "{}: the picture is the host's",
            fault.name
        );

        // The host may mend its input and record the same frame.
        let frame = stage.begin();
        let input = stage.input(&frame, &look, 0, 1);
        let mut spoiled = input;
        (fault.spoil)(&mut spoiled);
        record(&mut renderer, &frame, &spoiled).unwrap_err();
        record(&mut renderer, &frame, &input).unwrap();
        let picture = stage.read(&frame, SAMPLED);
        assert!(
            difference(&picture, &over(&volume, &scene)) < 1e-5,
            "{}: mended",
            fault.name
        );
    }
    stage.destroy();
    drop((renderer, context));
    depth_image.destroy(&host);
    host.finish();
}
