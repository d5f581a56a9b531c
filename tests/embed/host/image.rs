//! Images and buffers of the host, each with memory of its own.

use ash::vk;
use half::f16;
use umbravox::embed::ImageUse;

use super::Host;

/// A mapped buffer.
pub(crate) struct HostBuffer {
    pub(crate) buffer: vk::Buffer,
    memory: vk::DeviceMemory,
    pointer: *mut u8,
    bytes: usize,
}

impl HostBuffer {
    pub(crate) fn new(host: &Host, bytes: usize) -> Self {
        let info = vk::BufferCreateInfo::default()
            .size(bytes as u64)
            .usage(vk::BufferUsageFlags::TRANSFER_SRC | vk::BufferUsageFlags::TRANSFER_DST);
        let flags = vk::MemoryPropertyFlags::HOST_VISIBLE | vk::MemoryPropertyFlags::HOST_COHERENT;
        let device = &host.device;
        // SAFETY: fresh handles of a device that is alive; the memory is of a type that the buffer allows.
        unsafe {
            let buffer = device.create_buffer(&info, None).unwrap();
            let requirements = device.get_buffer_memory_requirements(buffer);
            let allocate = vk::MemoryAllocateInfo::default()
                .allocation_size(requirements.size)
                .memory_type_index(host.memory_type(requirements.memory_type_bits, flags));
            let memory = device.allocate_memory(&allocate, None).unwrap();
            device.bind_buffer_memory(buffer, memory, 0).unwrap();
            let all = vk::MemoryMapFlags::empty();
            let pointer = device.map_memory(memory, 0, vk::WHOLE_SIZE, all).unwrap();
            Self {
                buffer,
                memory,
                pointer: pointer.cast(),
                bytes,
            }
        }
    }

    pub(crate) fn holding(host: &Host, data: &[u8]) -> Self {
        let buffer = Self::new(host, data.len());
        // SAFETY: mapped for its whole length; the device does not use it yet.
        unsafe {
            buffer
                .pointer
                .copy_from_nonoverlapping(data.as_ptr(), data.len())
        };
        buffer
    }

    /// The contents. The device has finished what writes them.
    pub(crate) fn contents(&self) -> Vec<u8> {
        // SAFETY: mapped for its whole length, and written by nobody now.
        unsafe { std::slice::from_raw_parts(self.pointer, self.bytes) }.to_vec()
    }

    pub(crate) fn destroy(self, host: &Host) {
        // SAFETY: the device has finished with it (callers wait).
        unsafe {
            host.device.destroy_buffer(self.buffer, None);
            host.device.free_memory(self.memory, None);
        }
    }
}

/// A 2D image with a view, for colour or depth.
pub(crate) struct HostImage {
    pub(crate) image: vk::Image,
    pub(crate) view: vk::ImageView,
    pub(crate) format: vk::Format,
    pub(crate) size: [u32; 2],
    pub(crate) aspect: vk::ImageAspectFlags,
    memory: vk::DeviceMemory,
}

impl HostImage {
    /// A picture that volumes can be drawn into.
    pub(crate) fn color(host: &Host, format: vk::Format, size: [u32; 2]) -> Self {
        let usage = vk::ImageUsageFlags::STORAGE | vk::ImageUsageFlags::COLOR_ATTACHMENT;
        Self::new(host, format, size, usage, vk::ImageAspectFlags::COLOR)
    }

    /// A depth buffer.
    pub(crate) fn depth(host: &Host, size: [u32; 2]) -> Self {
        let usage = vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT;
        let aspect = vk::ImageAspectFlags::DEPTH;
        Self::new(host, vk::Format::D32_SFLOAT, size, usage, aspect)
    }

    fn new(
        host: &Host,
        format: vk::Format,
        size: [u32; 2],
        usage: vk::ImageUsageFlags,
        aspect: vk::ImageAspectFlags,
    ) -> Self {
        let usage = usage
            | vk::ImageUsageFlags::SAMPLED
            | vk::ImageUsageFlags::TRANSFER_SRC
            | vk::ImageUsageFlags::TRANSFER_DST;
        let info = vk::ImageCreateInfo::default()
            .image_type(vk::ImageType::TYPE_2D)
            .format(format)
            .extent(extent(size))
            .mip_levels(1)
            .array_layers(1)
            .samples(vk::SampleCountFlags::TYPE_1)
            .usage(usage);
        let device = &host.device;
        // SAFETY: fresh handles of a device that is alive; the memory is of a type that the image allows.
        unsafe {
            let image = device.create_image(&info, None).unwrap();
            let requirements = device.get_image_memory_requirements(image);
            let local = vk::MemoryPropertyFlags::DEVICE_LOCAL;
            let allocate = vk::MemoryAllocateInfo::default()
                .allocation_size(requirements.size)
                .memory_type_index(host.memory_type(requirements.memory_type_bits, local));
            let memory = device.allocate_memory(&allocate, None).unwrap();
            device.bind_image_memory(image, memory, 0).unwrap();
            let view_info = vk::ImageViewCreateInfo::default()
                .image(image)
                .view_type(vk::ImageViewType::TYPE_2D)
                .format(format)
                .subresource_range(range(aspect));
            Self {
                image,
                view: device.create_image_view(&view_info, None).unwrap(),
                format,
                size,
                aspect,
                memory,
            }
        }
    }

    /// Records a copy from `pixels` that leaves the image as `exit` says. What it held is lost; `entry` is how it was used.
    pub(crate) fn record_fill(
        &self,
        host: &Host,
        cmd: vk::CommandBuffer,
        pixels: &HostBuffer,
        entry: ImageUse,
        exit: ImageUse,
    ) {
        let write = ImageUse {
            stage: vk::PipelineStageFlags::TRANSFER,
            access: vk::AccessFlags::TRANSFER_WRITE,
            layout: vk::ImageLayout::TRANSFER_DST_OPTIMAL,
        };
        let discarding = ImageUse {
            layout: vk::ImageLayout::UNDEFINED,
            ..entry
        };
        self.record_transition(host, cmd, discarding, write);
        // SAFETY: recording, outside a render pass; both live until the frame has finished.
        unsafe {
            host.device.cmd_copy_buffer_to_image(
                cmd,
                pixels.buffer,
                self.image,
                write.layout,
                &[self.region()],
            );
        }
        self.record_transition(host, cmd, write, exit);
    }

    /// Records a barrier from one use to another.
    pub(crate) fn record_transition(
        &self,
        host: &Host,
        cmd: vk::CommandBuffer,
        from: ImageUse,
        to: ImageUse,
    ) {
        let barrier = vk::ImageMemoryBarrier::default()
            .src_access_mask(from.access)
            .dst_access_mask(to.access)
            .old_layout(from.layout)
            .new_layout(to.layout)
            .src_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
            .dst_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
            .image(self.image)
            .subresource_range(range(self.aspect));
        let flags = vk::DependencyFlags::empty();
        // SAFETY: recording, outside a render pass; the image lives until the frame has finished.
        unsafe {
            let device = &host.device;
            device.cmd_pipeline_barrier(cmd, from.stage, to.stage, flags, &[], &[], &[barrier]);
        }
    }

    /// Records a copy to `pixels`, which the host reads once the frame has finished.
    pub(crate) fn record_read(
        &self,
        host: &Host,
        cmd: vk::CommandBuffer,
        pixels: &HostBuffer,
        entry: ImageUse,
    ) {
        let read = ImageUse {
            stage: vk::PipelineStageFlags::TRANSFER,
            access: vk::AccessFlags::TRANSFER_READ,
            layout: vk::ImageLayout::TRANSFER_SRC_OPTIMAL,
        };
        self.record_transition(host, cmd, entry, read);
        let to_host = [vk::MemoryBarrier::default()
            .src_access_mask(vk::AccessFlags::TRANSFER_WRITE)
            .dst_access_mask(vk::AccessFlags::HOST_READ)];
        // SAFETY: as for `record_fill`.
        unsafe {
            host.device.cmd_copy_image_to_buffer(
                cmd,
                self.image,
                read.layout,
                pixels.buffer,
                &[self.region()],
            );
            host.device.cmd_pipeline_barrier(
                cmd,
                vk::PipelineStageFlags::TRANSFER,
                vk::PipelineStageFlags::HOST,
                vk::DependencyFlags::empty(),
                &to_host,
                &[],
                &[],
            );
        }
    }

    /// A buffer for all pixels.
    pub(crate) fn pixel_buffer(&self, host: &Host) -> HostBuffer {
        let pixels = self.size[0] as usize * self.size[1] as usize;
        HostBuffer::new(host, pixels * texel_bytes(self.format))
    }

    fn region(&self) -> vk::BufferImageCopy {
        vk::BufferImageCopy::default()
            .image_subresource(
                vk::ImageSubresourceLayers::default()
                    .aspect_mask(self.aspect)
                    .layer_count(1),
            )
            .image_extent(extent(self.size))
    }

    pub(crate) fn destroy(self, host: &Host) {
        // SAFETY: the device has finished with it (callers wait).
        unsafe {
            host.device.destroy_image_view(self.view, None);
            host.device.destroy_image(self.image, None);
            host.device.free_memory(self.memory, None);
        }
    }
}

fn extent([width, height]: [u32; 2]) -> vk::Extent3D {
    vk::Extent3D {
        width,
        height,
        depth: 1,
    }
}

fn range(aspect: vk::ImageAspectFlags) -> vk::ImageSubresourceRange {
    vk::ImageSubresourceRange::default()
        .aspect_mask(aspect)
        .level_count(1)
        .layer_count(1)
}

fn texel_bytes(format: vk::Format) -> usize {
    match format {
        vk::Format::R8G8B8A8_UNORM | vk::Format::D32_SFLOAT => 4,
        vk::Format::R16G16B16A16_SFLOAT => 8,
        vk::Format::R32G32B32A32_SFLOAT => 16,
        other => panic!("no test uses {other:?}"),
    }
}

/// Pixels of a colour format as numbers.
pub(crate) fn decode(format: vk::Format, bytes: &[u8]) -> Vec<[f64; 4]> {
    let channel = |bytes: &[u8]| match *bytes {
        [byte] => f64::from(byte) / 255.0,
        [a, b] => f16::from_le_bytes([a, b]).to_f64(),
        [a, b, c, d] => f32::from_le_bytes([a, b, c, d]).into(),
        _ => unreachable!("channels have one, two or four bytes"),
    };
    let texel = texel_bytes(format);
    bytes
        .chunks_exact(texel)
        .map(|pixel| std::array::from_fn(|i| channel(&pixel[i * texel / 4..][..texel / 4])))
        .collect()
}
