//! The door for engines: volumes recorded into the host's own command buffer.
//!
//! The host owns instance, device, queue, command buffers, submission and the target image. The library records; it never
//! submits, waits, or creates anything global. Ask [`Requirements`] before creating the device, make a [`Context`] with
//! [`Context::from_host`], a [`Renderer`] for each volume, and call [`Renderer::record`] once a frame:
//!
//! ```no_run
//! # fn f(host: umbravox::embed::HostDevice, volume: std::sync::Arc<umbravox::volume::Volume>,
//! #      settings: umbravox::embed::Settings, cmd: ash::vk::CommandBuffer, input: umbravox::embed::FrameInput)
//! # -> umbravox::Result<()> {
//! use umbravox::embed::{Context, Renderer};
//! // SAFETY: the handles are alive and belong together; see `Context::from_host`.
//! let context = unsafe { Context::from_host(host) }?;
//! let mut renderer = Renderer::new(&context, volume, settings)?;
//! // every frame, while `cmd` is recording, outside a render pass:
//! // SAFETY: see `Renderer::record`.
//! let report = unsafe { renderer.record(cmd, &input) }?;
//! # Ok(()) }
//! ```
#![expect(
    unsafe_code,
    reason = "turns the host's raw handles into our own types; this file is the boundary"
)]

use ash::vk;
use glam::DMat4;

use crate::error::{Error, Result};
use crate::gpu::{
    HostTransition, HostUse, Image, OwnedRecording, Recorder, transition_host_images,
};
use crate::pass::picture::PictureVariant;
use crate::renderer::{self, Frame, FrameDepth, FrameTarget, RayBasis, Work, ix_from_clip};
use crate::scene::View;

pub use crate::gpu::memory::{
    HostMemory, MappedPointer, MemoryBackend, MemoryBlock, MemoryLocation, MemoryRequest,
};
pub use crate::gpu::{Capabilities, Context, HostDevice, Requirements};
pub use crate::renderer::{DepthRange, FrameReport, Renderer, Settings};

/// How an image of the host is used before or after the recorded commands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ImageUse {
    /// Pipeline stages; of entry: those that must have finished, of exit: those that wait for us. May be empty.
    pub stage: vk::PipelineStageFlags,
    /// Memory accesses in those stages.
    pub access: vk::AccessFlags,
    /// Layout.
    pub layout: vk::ImageLayout,
}

/// The host's picture. Needs `STORAGE` usage; only the first mip level and layer are written.
#[derive(Clone, Copy, Debug)]
pub struct Target {
    /// The image, for layout transitions.
    pub image: vk::Image,
    /// A 2D view of it.
    pub view: vk::ImageView,
    /// Format of the view. Blending over the target's contents needs `R8G8B8A8_UNORM`, `R16G16B16A16_SFLOAT` or
    /// `R32G32B32A32_SFLOAT`.
    pub format: vk::Format,
    /// Width and height, pixels.
    pub size_px: [u32; 2],
    /// Use before. `UNDEFINED` discards the contents.
    pub entry: ImageUse,
    /// Use after.
    pub exit: ImageUse,
    /// What lies behind the volume.
    pub background: Background,
    /// Write (and blend) sRGB-encoded values: for `UNORM` images that are shown as they are. Light is computed linearly.
    pub encode_srgb: bool,
}

/// What lies behind the volume.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Background {
    /// The target's own contents: the volume is composited over them.
    Target,
    /// A linear colour; alpha becomes 1.
    Color([f32; 3]),
    /// Nothing: the target receives premultiplied colour and opacity.
    Transparent,
}

/// The host's depth image, at which rays end. Needs `SAMPLED` usage; read in `DEPTH_STENCIL_READ_ONLY_OPTIMAL`.
#[derive(Clone, Copy, Debug)]
pub struct SceneDepth {
    /// The image, for layout transitions.
    pub image: vk::Image,
    /// A 2D view of its depth aspect, of the target's size.
    pub view: vk::ImageView,
    /// All aspects of the image's format (depth, and stencil where there is one).
    pub aspects: vk::ImageAspectFlags,
    /// Use before.
    pub entry: ImageUse,
    /// Use after.
    pub exit: ImageUse,
}

/// The camera of a frame.
#[derive(Clone, Copy, Debug)]
pub enum FrameCamera {
    /// The host's matrices, Vulkan conventions: y of clip space points down, depth is 0 to 1. Right- or left-handed,
    /// perspective (off-centre and infinite too; rays start at the eye) or orthographic (rays start at the near plane).
    Matrices {
        /// World (mm, LPS) to view.
        view_from_world: DMat4,
        /// View to clip, not jittered.
        clip_from_view: DMat4,
        /// How depth grows.
        depth: DepthRange,
    },
    /// A scene's view; cannot be combined with a depth image.
    View(View),
}

/// One frame of the host.
#[derive(Clone, Copy, Debug)]
pub struct FrameInput {
    /// Number of this frame on the host's clock; grows, starts above 0. All renderers of a context share the clock.
    pub index: u64,
    /// The newest frame that the device is known to have finished.
    pub completed: u64,
    /// Camera.
    pub camera: FrameCamera,
    /// Where the picture goes.
    pub target: Target,
    /// Opaque geometry.
    pub depth: Option<SceneDepth>,
    /// Bytes of bricks to upload at most in this frame (at least one brick is). [`FrameInput::UPLOAD_BUDGET`] is a start.
    pub upload_budget: usize,
}

impl FrameInput {
    /// A moderate upload budget, bytes.
    pub const UPLOAD_BUDGET: usize = 64 << 20;
}

impl Renderer {
    /// Records one frame: pending uploads, one direction of ambient occlusion, the picture.
    ///
    /// On entry and exit images are as [`Target`] and [`SceneDepth`] state; all other synchronization is inside.
    ///
    /// # Errors
    /// [`Error::Invalid`] for matrices that cannot be inverted, a target that cannot be blended over, layouts that lose what
    /// is needed, or frame numbers that do not grow: nothing was recorded. [`Error::OutOfMemory`] and others: the command
    /// buffer is still valid, and leaves the images of `input` as `exit` says, but holds an unknown part of the frame.
    /// Submit it or reset it; the next frame uploads and traces everything again. A frame that failed may be recorded once
    /// more.
    ///
    /// # Safety
    /// - `cmd` is in the recording state, outside a render pass, on the queue family of the context's [`HostDevice`].
    /// - Command buffers are submitted in the order in which frames are recorded, each frame's before the next's.
    /// - The device has finished every frame with an index up to `input.completed`, of all renderers of the context.
    /// - Images and views of `input` are valid until the frame has finished, have the usage stated, and are as `entry` says
    ///   when execution reaches these commands.
    pub unsafe fn record(
        &mut self,
        cmd: vk::CommandBuffer,
        input: &FrameInput,
    ) -> Result<FrameReport> {
        check(input)?;
        let ix_from_world = self.loaded().store().volume.world_from_ix().inverse();
        let size_px = input.target.size_px;
        let (rays, clip) = match input.camera {
            FrameCamera::View(view) => (RayBasis::from_view(&view, size_px), None),
            FrameCamera::Matrices {
                view_from_world,
                clip_from_view,
                depth,
            } => (
                RayBasis::from_matrices(view_from_world, clip_from_view, depth, size_px)
                    .ok_or_else(|| {
                        Error::invalid("camera", "the matrices must be finite and invertible")
                    })?,
                Some((
                    ix_from_clip(ix_from_world, view_from_world, clip_from_view),
                    depth,
                )),
            ),
        };
        let depth = match (input.depth, clip) {
            (None, _) => None,
            (Some(_), None) => {
                return Err(Error::invalid(
                    "depth",
                    "a depth image needs a camera given by matrices",
                ));
            }
            (Some(image), Some((ix_from_clip, range))) => Some(FrameDepth {
                view: image.view,
                layout: vk::ImageLayout::DEPTH_STENCIL_READ_ONLY_OPTIMAL,
                range,
                ix_from_clip,
            }),
        };
        let target = &input.target;
        let frame = Frame {
            rays,
            target: FrameTarget {
                own: None,
                view: target.view,
                format: target.format,
                size_px,
                encode_srgb: target.encode_srgb,
                blend: target.background == Background::Target,
                background: match target.background {
                    Background::Color([r, g, b]) => [r, g, b, 1.0],
                    Background::Target | Background::Transparent => [0.0; 4],
                },
            },
            depth,
            aux: None,
            through: None,
            exposure: self.settings().exposure.exp2() as f32,
            number: input.index as u32,
            upload_budget: input.upload_budget,
        };
        // SAFETY: by this function's contract.
        unsafe { self.context().collect(input.completed) };
        self.begin_frame(input.index, input.completed, |context, slots, loaded| {
            // SAFETY: by this function's contract.
            unsafe { transition_host_images(context, cmd, &entering(input)) };
            let slot = slots.acquire(context, input.index, input.completed);
            let recorded = slot.and_then(|slot| {
                // SAFETY: by this function's contract.
                let mut recorder = unsafe { Recorder::new(context, cmd, slot) };
                renderer::record(context, &mut recorder, loaded, &frame, Work::Everything)
            });
            // After an error too: the host gets its images back as it expects them.
            // SAFETY: by this function's contract; the images are used as was recorded above.
            unsafe { transition_host_images(context, cmd, &leaving(input)) };
            recorded
        })
    }
}

/// What can be told before anything is recorded.
fn check(input: &FrameInput) -> Result<()> {
    let Target {
        format,
        size_px,
        background,
        ..
    } = input.target;
    if size_px.contains(&0) {
        let message = format!("{size_px:?} has no pixels");
        return Err(Error::invalid("target.size_px", message));
    }
    let blends = background == Background::Target;
    if blends && !PictureVariant::BLENDABLE.contains(&format) {
        let valid = PictureVariant::BLENDABLE;
        let message = format!("{format:?} cannot be blended over; {valid:?} can");
        return Err(Error::invalid("target.format", message));
    }
    let known = |at: &str, layout: vk::ImageLayout, why: &str| {
        let nothing = [vk::ImageLayout::UNDEFINED, vk::ImageLayout::PREINITIALIZED];
        if nothing.contains(&layout) {
            return Err(Error::invalid(at, format!("{layout:?} {why}")));
        }
        Ok(())
    };
    if blends {
        let why = "discards the contents that are to be blended over";
        known("target.entry.layout", input.target.entry.layout, why)?;
    }
    let why = "is no layout that an image can be left in";
    known("target.exit.layout", input.target.exit.layout, why)?;
    if let Some(depth) = &input.depth {
        let lost = "discards the depths that rays are to end at";
        known("depth.entry.layout", depth.entry.layout, lost)?;
        known("depth.exit.layout", depth.exit.layout, why)?;
    }
    Ok(())
}

/// `none` stands for no stage at all, which barriers of Vulkan 1.2 cannot name.
fn host_use(image_use: ImageUse, none: vk::PipelineStageFlags) -> HostUse {
    let ImageUse {
        stage,
        access,
        layout,
    } = image_use;
    HostUse {
        stage: if stage.is_empty() { none } else { stage },
        access,
        layout,
    }
}

/// The use of the target while we record: read too where it is blended over.
fn marched(target: &Target) -> HostUse {
    let read = match target.background {
        Background::Target => vk::AccessFlags::SHADER_READ,
        Background::Color(_) | Background::Transparent => vk::AccessFlags::empty(),
    };
    HostUse {
        stage: vk::PipelineStageFlags::COMPUTE_SHADER,
        access: read | vk::AccessFlags::SHADER_WRITE,
        layout: vk::ImageLayout::GENERAL,
    }
}

/// The use of the host's depth while we record.
const DEPTH_SAMPLED: HostUse = HostUse {
    stage: vk::PipelineStageFlags::COMPUTE_SHADER,
    access: vk::AccessFlags::SHADER_READ,
    layout: vk::ImageLayout::DEPTH_STENCIL_READ_ONLY_OPTIMAL,
};

/// Takes over the host's images.
fn entering(input: &FrameInput) -> Vec<HostTransition> {
    let none = vk::PipelineStageFlags::TOP_OF_PIPE;
    let target = &input.target;
    let mut transitions = vec![HostTransition {
        image: target.image,
        aspects: vk::ImageAspectFlags::COLOR,
        from: host_use(target.entry, none),
        to: marched(target),
    }];
    transitions.extend(input.depth.map(|depth| HostTransition {
        image: depth.image,
        aspects: depth.aspects,
        from: host_use(depth.entry, none),
        to: DEPTH_SAMPLED,
    }));
    transitions
}

/// Gives them back.
fn leaving(input: &FrameInput) -> Vec<HostTransition> {
    let none = vk::PipelineStageFlags::BOTTOM_OF_PIPE;
    let target = &input.target;
    let mut transitions = vec![HostTransition {
        image: target.image,
        aspects: vk::ImageAspectFlags::COLOR,
        from: marched(target),
        to: host_use(target.exit, none),
    }];
    transitions.extend(input.depth.map(|depth| HostTransition {
        image: depth.image,
        aspects: depth.aspects,
        from: DEPTH_SAMPLED,
        to: host_use(depth.exit, none),
    }));
    transitions
}

/// Records a frame of `headless`: the target and the light are our own images.
pub(crate) fn record_owned(
    renderer: &mut Renderer,
    recording: &OwnedRecording,
    frame: &Frame<'_>,
    work: Work,
) -> Result<FrameReport> {
    let (index, completed) = (recording.index(), recording.index() - 1);
    // SAFETY: `OwnedDevice::submit` waits for each frame before the next is recorded.
    unsafe { renderer.context().collect(completed) };
    renderer.begin_frame(index, completed, |context, slots, loaded| {
        let slot = slots.acquire(context, index, completed)?;
        // SAFETY: `OwnedDevice::submit` hands out a command buffer that is recording, on the context's queue family, and
        // submits in order.
        let mut recorder = unsafe { Recorder::new(context, recording.command_buffer(), slot) };
        let recorded = renderer::record(context, &mut recorder, loaded, frame, work);
        if recorded.is_err() {
            let ours = frame.target.own.into_iter().chain(frame.aux);
            ours.for_each(Image::forget);
        }
        recorded
    })
}

/// The code in the README, which is compiled with the documentation's.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
