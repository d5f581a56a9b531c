//! A picture being drawn: the host's scene, and volumes over it.

use ash::vk;
use half::f16;
use umbravox::embed::{
    Background, FrameCamera, FrameInput, FrameReport, ImageUse, Renderer, SceneDepth, Target,
};

use super::{Frame, Frames, Host, HostBuffer, HostImage, decode};

/// Frames on their way at once.
const IN_FLIGHT: usize = 3;
/// More than any volume of these tests needs to be complete.
const MOST_FRAMES: usize = 100;

/// As the host's own passes draw into the picture.
pub(crate) const ATTACHMENT: ImageUse = ImageUse {
    stage: vk::PipelineStageFlags::COLOR_ATTACHMENT_OUTPUT,
    access: vk::AccessFlags::COLOR_ATTACHMENT_WRITE,
    layout: vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL,
};
/// As the host's own passes use depth.
pub(crate) const DEPTH_ATTACHMENT: ImageUse = ImageUse {
    stage: vk::PipelineStageFlags::from_raw(
        vk::PipelineStageFlags::EARLY_FRAGMENT_TESTS.as_raw()
            | vk::PipelineStageFlags::LATE_FRAGMENT_TESTS.as_raw(),
    ),
    access: vk::AccessFlags::from_raw(
        vk::AccessFlags::DEPTH_STENCIL_ATTACHMENT_READ.as_raw()
            | vk::AccessFlags::DEPTH_STENCIL_ATTACHMENT_WRITE.as_raw(),
    ),
    layout: vk::ImageLayout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL,
};
/// Between two volumes.
const STORAGE: ImageUse = ImageUse {
    stage: vk::PipelineStageFlags::COMPUTE_SHADER,
    access: vk::AccessFlags::from_raw(
        vk::AccessFlags::SHADER_READ.as_raw() | vk::AccessFlags::SHADER_WRITE.as_raw(),
    ),
    layout: vk::ImageLayout::GENERAL,
};
/// Likewise.
const DEPTH_READ_ONLY: ImageUse = ImageUse {
    stage: vk::PipelineStageFlags::COMPUTE_SHADER,
    access: vk::AccessFlags::SHADER_READ,
    layout: vk::ImageLayout::DEPTH_STENCIL_READ_ONLY_OPTIMAL,
};
/// As a shader of the host reads the picture.
pub(crate) const SAMPLED: ImageUse = ImageUse {
    stage: vk::PipelineStageFlags::FRAGMENT_SHADER,
    access: vk::AccessFlags::SHADER_READ,
    layout: vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL,
};
/// Contents that nobody needs, once earlier frames have read them.
const DISCARDED: ImageUse = ImageUse {
    stage: vk::PipelineStageFlags::from_raw(
        vk::PipelineStageFlags::TRANSFER.as_raw()
            | vk::PipelineStageFlags::COLOR_ATTACHMENT_OUTPUT.as_raw(),
    ),
    access: vk::AccessFlags::COLOR_ATTACHMENT_WRITE,
    layout: vk::ImageLayout::UNDEFINED,
};

/// How volumes are put into the picture.
#[derive(Clone, Copy)]
pub(crate) struct Look {
    pub(crate) camera: FrameCamera,
    pub(crate) background: Background,
    pub(crate) encode_srgb: bool,
}

/// A target, with contents and a depth buffer where the host has them.
struct Canvas {
    target: HostImage,
    contents: Option<HostBuffer>,
    depth: Option<HostImage>,
}

impl Canvas {
    fn destroy(self, host: &Host) {
        self.target.destroy(host);
        if let Some(contents) = self.contents {
            contents.destroy(host);
        }
        if let Some(depth) = self.depth {
            depth.destroy(host);
        }
    }
}

/// The host's picture and the frames that draw it.
pub(crate) struct Stage<'h> {
    host: &'h Host,
    canvas: Canvas,
    /// Canvases of before, with the newest frame that uses them.
    old: Vec<(u64, Canvas)>,
    frames: Frames,
}

impl<'h> Stage<'h> {
    pub(crate) fn new(host: &'h Host, format: vk::Format, size: [u32; 2]) -> Self {
        Self {
            host,
            canvas: Self::canvas(host, format, size),
            old: Vec::new(),
            frames: Frames::new(host, IN_FLIGHT),
        }
    }

    fn canvas(host: &Host, format: vk::Format, size: [u32; 2]) -> Canvas {
        Canvas {
            target: HostImage::color(host, format, size),
            contents: None,
            depth: None,
        }
    }

    /// A new, empty picture. The old one goes when the frames that use it have finished; nobody waits.
    pub(crate) fn resize(&mut self, format: vk::Format, size: [u32; 2]) {
        let canvas = Self::canvas(self.host, format, size);
        let old = std::mem::replace(&mut self.canvas, canvas);
        self.old.push((self.frames.newest(), old));
    }

    /// The host draws `pixels` before the volumes, every frame. Once for a picture.
    pub(crate) fn set_contents(&mut self, pixels: &[[f64; 4]]) {
        let bytes = encode(self.canvas.target.format, pixels);
        let before = self
            .canvas
            .contents
            .replace(HostBuffer::holding(self.host, &bytes));
        assert!(before.is_none(), "contents are given once");
    }

    /// The host has opaque geometry of these depths. Once for a picture.
    pub(crate) fn set_depth(&mut self, depths: &[f32]) {
        let image = HostImage::depth(self.host, self.canvas.target.size);
        let values = HostBuffer::holding(self.host, bytemuck::cast_slice(depths));
        let fresh = ImageUse {
            stage: vk::PipelineStageFlags::TOP_OF_PIPE,
            access: vk::AccessFlags::empty(),
            layout: vk::ImageLayout::UNDEFINED,
        };
        self.host
            .run(|cmd| image.record_fill(self.host, cmd, &values, fresh, DEPTH_ATTACHMENT));
        values.destroy(self.host);
        let before = self.canvas.depth.replace(image);
        assert!(before.is_none(), "depths are given once");
    }

    /// A frame with the host's own drawing recorded.
    pub(crate) fn begin(&mut self) -> Frame {
        let frame = self.frames.begin(self.host);
        let (finished, used) = std::mem::take(&mut self.old)
            .into_iter()
            .partition(|(newest, _)| *newest <= frame.completed);
        self.old = used;
        for (_, canvas) in finished {
            canvas.destroy(self.host);
        }
        if let Some(contents) = &self.canvas.contents {
            let target = &self.canvas.target;
            target.record_fill(self.host, frame.cmd, contents, DISCARDED, ATTACHMENT);
        }
        frame
    }

    /// What volume `place` of `count` is told about a frame.
    pub(crate) fn input(
        &self,
        frame: &Frame,
        look: &Look,
        place: usize,
        count: usize,
    ) -> FrameInput {
        let target = &self.canvas.target;
        let (first, last) = (place == 0, place + 1 == count);
        let entry = match (first, &self.canvas.contents) {
            (true, Some(_)) => ATTACHMENT,
            (true, None) => DISCARDED,
            (false, _) => STORAGE,
        };
        let depth = self.canvas.depth.as_ref().map(|depth| SceneDepth {
            image: depth.image,
            view: depth.view,
            aspects: depth.aspect,
            entry: if first {
                DEPTH_ATTACHMENT
            } else {
                DEPTH_READ_ONLY
            },
            exit: if last {
                DEPTH_ATTACHMENT
            } else {
                DEPTH_READ_ONLY
            },
        });
        FrameInput {
            index: frame.index,
            completed: frame.completed,
            camera: look.camera,
            target: Target {
                image: target.image,
                view: target.view,
                format: target.format,
                size_px: target.size,
                entry,
                exit: if last { SAMPLED } else { STORAGE },
                background: if first {
                    look.background
                } else {
                    Background::Target
                },
                encode_srgb: look.encode_srgb,
            },
            depth,
            upload_budget: FrameInput::UPLOAD_BUDGET,
        }
    }

    /// Submits a frame and reads its picture, which the last commands used as `entry` says.
    pub(crate) fn read(&mut self, frame: &Frame, entry: ImageUse) -> Vec<[f64; 4]> {
        let target = &self.canvas.target;
        let pixels = target.pixel_buffer(self.host);
        target.record_read(self.host, frame.cmd, &pixels, entry);
        self.frames.submit(self.host, frame);
        self.frames.wait(self.host);
        let picture = decode(target.format, &pixels.contents());
        pixels.destroy(self.host);
        picture
    }

    /// Draws frames until every volume is complete; the last one's picture.
    pub(crate) fn draw(&mut self, look: &Look, volumes: &mut [&mut Renderer]) -> Vec<[f64; 4]> {
        let count = volumes.len();
        for _ in 0..MOST_FRAMES {
            let frame = self.begin();
            let mut complete = true;
            for (place, volume) in volumes.iter_mut().enumerate() {
                let input = self.input(&frame, look, place, count);
                complete &= record(volume, &frame, &input).unwrap().is_complete();
            }
            if complete {
                return self.read(&frame, SAMPLED);
            }
            self.frames.submit(self.host, &frame);
        }
        panic!("the volumes are not complete after {MOST_FRAMES} frames");
    }

    /// Submits a frame; nobody waits for it.
    pub(crate) fn submit(&mut self, frame: &Frame) {
        self.frames.submit(self.host, frame);
    }

    /// Throws the commands of a frame away.
    pub(crate) fn discard(&mut self, frame: &Frame) {
        self.frames.discard(self.host, frame);
    }

    /// Waits for all frames and destroys what is the host's. The number of the newest frame.
    pub(crate) fn destroy(self) -> u64 {
        let newest = self.frames.wait(self.host);
        self.frames.destroy(self.host);
        for (_, canvas) in self.old {
            canvas.destroy(self.host);
        }
        self.canvas.destroy(self.host);
        newest
    }
}

/// Has a volume recorded into a frame of a stage.
pub(crate) fn record(
    volume: &mut Renderer,
    frame: &Frame,
    input: &FrameInput,
) -> umbravox::Result<FrameReport> {
    // SAFETY: the command buffer records, outside a render pass; a stage submits its frames in order and keeps its images
    // until they have finished; images are used as stated, and `completed` is what the fences said.
    unsafe { volume.record(frame.cmd, input) }
}

/// Pixels as a colour format stores them.
fn encode(format: vk::Format, pixels: &[[f64; 4]]) -> Vec<u8> {
    let channels = pixels.iter().flatten();
    match format {
        vk::Format::R8G8B8A8_UNORM => channels.map(|c| (c * 255.0).round() as u8).collect(),
        vk::Format::R16G16B16A16_SFLOAT => channels
            .flat_map(|&c| f16::from_f64(c).to_le_bytes())
            .collect(),
        _ => channels.flat_map(|&c| (c as f32).to_le_bytes()).collect(),
    }
}
