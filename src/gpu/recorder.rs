//! Recording into a command buffer: passes, barriers, copies, dispatches.

use std::cell::Cell;
use std::sync::Arc;

use ash::vk;

use super::access::Access;
use super::buffer::Buffer;
use super::context::Context;
use super::frame_slot::FrameSlot;
use super::image::{COLOR_LAYERS, COLOR_RANGE, Image};
use super::pipeline::{Bound, Pipeline, descriptor_set};
use crate::error::Result;

/// A command buffer being recorded, with the frame's slot. Made by `embed`; safe from there on.
pub(crate) struct Recorder<'a> {
    context: &'a Arc<Context>,
    cmd: vk::CommandBuffer,
    slot: &'a mut FrameSlot,
    pending: Pending,
}

/// Barriers collected until the next command that needs them.
#[derive(Default)]
struct Pending {
    source: vk::PipelineStageFlags,
    destination: vk::PipelineStageFlags,
    source_access: vk::AccessFlags,
    destination_access: vk::AccessFlags,
    images: Vec<vk::ImageMemoryBarrier<'static>>,
}

/// A use of an image of the host, as a barrier names it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HostUse {
    pub(crate) stage: vk::PipelineStageFlags,
    pub(crate) access: vk::AccessFlags,
    pub(crate) layout: vk::ImageLayout,
}

/// An image of the host that goes from one use to another.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HostTransition {
    pub(crate) image: vk::Image,
    pub(crate) aspects: vk::ImageAspectFlags,
    pub(crate) from: HostUse,
    pub(crate) to: HostUse,
}

/// Records transitions of the first level and layer of the host's images, with one barrier.
///
/// # Safety
/// `cmd` is recording, outside a render pass. The images are alive until the frame completes, and used as `from` says.
pub(crate) unsafe fn transition_host_images(
    context: &Context,
    cmd: vk::CommandBuffer,
    transitions: &[HostTransition],
) {
    let barriers: Vec<_> = transitions
        .iter()
        .map(|t| {
            let range = vk::ImageSubresourceRange::default()
                .aspect_mask(t.aspects)
                .level_count(1)
                .layer_count(1);
            vk::ImageMemoryBarrier::default()
                .src_access_mask(t.from.access)
                .dst_access_mask(t.to.access)
                .old_layout(t.from.layout)
                .new_layout(t.to.layout)
                .src_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
                .dst_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
                .image(t.image)
                .subresource_range(range)
        })
        .collect();
    let stages = |of: fn(&HostTransition) -> vk::PipelineStageFlags| {
        let all = transitions.iter().map(of);
        all.fold(vk::PipelineStageFlags::empty(), |a, b| a | b)
    };
    // SAFETY: this function's contract.
    unsafe {
        context.device.cmd_pipeline_barrier(
            cmd,
            stages(|t| t.from.stage),
            stages(|t| t.to.stage),
            vk::DependencyFlags::empty(),
            &[],
            &[],
            &barriers,
        );
    }
}

/// One box of a copy between a buffer and an image.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CopyBox {
    pub(crate) buffer_offset: u64,
    /// Texels of a row, and rows of a slice, in the buffer.
    pub(crate) buffer_row: [u32; 2],
    pub(crate) origin: [u32; 3],
    pub(crate) extent: [u32; 3],
}

impl CopyBox {
    /// A box that is tightly packed in the buffer.
    pub(crate) fn packed(buffer_offset: u64, origin: [u32; 3], extent: [u32; 3]) -> Self {
        Self {
            buffer_offset,
            buffer_row: [extent[0], extent[1]],
            origin,
            extent,
        }
    }
}

impl<'a> Recorder<'a> {
    /// # Safety
    /// `cmd` is recording, outside a render pass, on a queue of the context's family, and outlives the recorder.
    /// Command buffers are submitted in the order in which they are recorded.
    pub(crate) unsafe fn new(
        context: &'a Arc<Context>,
        cmd: vk::CommandBuffer,
        slot: &'a mut FrameSlot,
    ) -> Self {
        // SAFETY: by this function's contract.
        unsafe { slot.reset_queries(cmd) };
        Self {
            context,
            cmd,
            slot,
            pending: Pending::default(),
        }
    }

    pub(crate) fn slot(&mut self) -> &mut FrameSlot {
        self.slot
    }

    /// Runs `body` as a named, labelled, timed pass.
    pub(crate) fn pass<T>(
        &mut self,
        name: &'static str,
        body: impl FnOnce(&mut Self) -> Result<T>,
    ) -> Result<T> {
        // SAFETY: the command buffer is recording outside a render pass (contract of `new`).
        unsafe {
            self.context.debug.begin(self.cmd, name);
            self.slot.begin_pass(self.cmd, name);
        }
        let result = body(self);
        // SAFETY: as above; the label and the pass were begun above.
        unsafe {
            self.slot.end_pass(self.cmd);
            self.context.debug.end(self.cmd);
        }
        result
    }

    fn depend(&mut self, access: &Cell<Access>, next: Access, is_image: bool) -> bool {
        let previous = access.replace(next);
        if !previous.needs_barrier(next, is_image) {
            return false;
        }
        let (a, b) = (previous.masks(), next.masks());
        self.pending.source |= a.stage;
        self.pending.destination |= b.stage;
        self.pending.source_access |= a.access;
        self.pending.destination_access |= b.access;
        true
    }

    /// The next commands use `buffer` like this.
    pub(crate) fn use_buffer(&mut self, buffer: &Buffer, next: Access) {
        self.depend(&buffer.access, next, false);
    }

    /// The next commands use `image` like this.
    pub(crate) fn use_image(&mut self, image: &Image, next: Access) {
        let old = image.access.get().masks();
        let new = next.masks();
        if self.depend(&image.access, next, true) {
            self.pending.images.push(
                vk::ImageMemoryBarrier::default()
                    .src_access_mask(old.access)
                    .dst_access_mask(new.access)
                    .old_layout(old.layout)
                    .new_layout(new.layout)
                    .src_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
                    .dst_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
                    .image(image.handle())
                    .subresource_range(COLOR_RANGE),
            );
        }
    }

    /// Emits the barriers collected so far.
    pub(crate) fn flush(&mut self) {
        let Pending {
            source,
            destination,
            source_access,
            destination_access,
            images,
        } = std::mem::take(&mut self.pending);
        if destination.is_empty() {
            return;
        }
        let memory = [vk::MemoryBarrier::default()
            .src_access_mask(source_access)
            .dst_access_mask(destination_access)];
        // SAFETY: the command buffer is recording outside a render pass; images are alive until the frame completes
        // (ours by the retire queue, the host's by contract).
        unsafe {
            self.context.device.cmd_pipeline_barrier(
                self.cmd,
                source,
                destination,
                vk::DependencyFlags::empty(),
                &memory,
                &[],
                &images,
            );
        }
    }

    fn regions(boxes: &[CopyBox]) -> Vec<vk::BufferImageCopy> {
        boxes
            .iter()
            .map(|b| vk::BufferImageCopy {
                buffer_offset: b.buffer_offset,
                buffer_row_length: b.buffer_row[0],
                buffer_image_height: b.buffer_row[1],
                image_subresource: COLOR_LAYERS,
                image_offset: vk::Offset3D {
                    x: b.origin[0] as i32,
                    y: b.origin[1] as i32,
                    z: b.origin[2] as i32,
                },
                image_extent: vk::Extent3D {
                    width: b.extent[0],
                    height: b.extent[1],
                    depth: b.extent[2],
                },
            })
            .collect()
    }

    /// Copies boxes of a host-written buffer into an image.
    pub(crate) fn upload(&mut self, from: &Buffer, to: &Image, boxes: &[CopyBox]) {
        self.use_image(to, Access::TransferWrite);
        self.flush();
        debug_assert!(
            boxes
                .iter()
                .all(|b| (0..3).all(|i| b.origin[i] + b.extent[i] <= to.extent()[i]))
        );
        // SAFETY: recording; both alive until the frame completes; boxes lie inside the image (layout planner) and
        // inside the buffer (sized from them); the host wrote the buffer before submission.
        unsafe {
            self.context.device.cmd_copy_buffer_to_image(
                self.cmd,
                from.handle(),
                to.handle(),
                vk::ImageLayout::TRANSFER_DST_OPTIMAL,
                &Self::regions(boxes),
            );
        }
    }

    /// Copies a box of an image into a buffer for the host to read.
    pub(crate) fn read_back(&mut self, from: &Image, to: &Buffer, part: CopyBox) {
        self.use_image(from, Access::TransferRead);
        self.use_buffer(to, Access::TransferWrite);
        self.flush();
        // SAFETY: as for `upload`.
        unsafe {
            self.context.device.cmd_copy_image_to_buffer(
                self.cmd,
                from.handle(),
                vk::ImageLayout::TRANSFER_SRC_OPTIMAL,
                to.handle(),
                &Self::regions(&[part]),
            );
        }
        self.use_buffer(to, Access::HostRead);
        self.flush();
    }

    /// Sets every bit of a colour image to 0.
    pub(crate) fn clear(&mut self, image: &Image) {
        self.clear_to(image, [0.0; 4]);
    }

    /// Sets every texel of an image of floats.
    pub(crate) fn clear_to(&mut self, image: &Image, texel: [f32; 4]) {
        self.use_image(image, Access::TransferWrite);
        self.flush();
        // SAFETY: recording; the image is alive, in the layout named, and of a colour format.
        unsafe {
            self.context.device.cmd_clear_color_image(
                self.cmd,
                image.handle(),
                vk::ImageLayout::TRANSFER_DST_OPTIMAL,
                &vk::ClearColorValue { float32: texel },
                &[COLOR_RANGE],
            );
        }
    }

    /// Sets every byte of a buffer to 0.
    pub(crate) fn fill_zero(&mut self, buffer: &Buffer) {
        self.use_buffer(buffer, Access::TransferWrite);
        self.flush();
        // SAFETY: recording, outside a render pass; the buffer is alive until the frame completes; offset 0 and the whole size are
        // always valid.
        unsafe {
            self.context
                .device
                .cmd_fill_buffer(self.cmd, buffer.handle(), 0, vk::WHOLE_SIZE, 0);
        }
    }

    /// Binds a pipeline with its resources. Barriers for them were asked for before.
    pub(crate) fn bind(&mut self, pipeline: &Pipeline, bound: &[(u32, Bound<'_>)]) -> Result<()> {
        // SAFETY: the slot's pool belongs to this frame; host views are valid by the contract of `embed`.
        let set = unsafe { descriptor_set(self.context, self.slot, pipeline, bound) }?;
        let device = &self.context.device;
        // SAFETY: recording; pipeline and set are alive until the frame completes and match each other.
        unsafe {
            device.cmd_bind_pipeline(self.cmd, vk::PipelineBindPoint::COMPUTE, pipeline.handle);
            device.cmd_bind_descriptor_sets(
                self.cmd,
                vk::PipelineBindPoint::COMPUTE,
                pipeline.layout,
                0,
                &[set],
                &[],
            );
        }
        Ok(())
    }

    /// Dispatches the bound pipeline with push constants, after the barriers collected.
    pub(crate) fn dispatch<P: crate::shader::GpuStruct>(
        &mut self,
        pipeline: &Pipeline,
        push: &P,
        groups: [u32; 3],
    ) {
        self.push(pipeline, push);
        self.dispatch_bound(groups);
    }

    /// The same, with group counts that the device has written to the buffer, 12 bytes at `offset`; used as [`Access::Indirect`].
    pub(crate) fn dispatch_indirect<P: crate::shader::GpuStruct>(
        &mut self,
        pipeline: &Pipeline,
        push: &P,
        groups: &Buffer,
        offset: u64,
    ) {
        self.push(pipeline, push);
        assert!(
            offset.is_multiple_of(4) && offset + 12 <= groups.bytes(),
            "group counts lie in their buffer"
        );
        // SAFETY: recording, with a pipeline bound that has its push constants; the counts lie in the buffer (asserted), which was
        // made for this and lives until the frame completes; the passes that write counts keep them within the limits that every
        // device has (65535).
        unsafe {
            self.context
                .device
                .cmd_dispatch_indirect(self.cmd, groups.handle(), offset);
        }
    }

    /// Emits the barriers collected and pushes the constants of the bound pipeline.
    fn push<P: crate::shader::GpuStruct>(&mut self, pipeline: &Pipeline, push: &P) {
        self.flush();
        debug_assert_eq!(
            pipeline.interface.push_constants.map(|l| l.name),
            Some(P::LAYOUT.name),
            "push constants of the pass"
        );
        let device = &self.context.device;
        // SAFETY: recording, with `pipeline` bound; the push constants are those of its layout.
        unsafe {
            device.cmd_push_constants(
                self.cmd,
                pipeline.layout,
                vk::ShaderStageFlags::COMPUTE,
                0,
                bytemuck::bytes_of(push),
            );
        }
    }

    /// Dispatches the bound pipeline, of a pass without push constants, after the barriers collected.
    pub(crate) fn dispatch_plain(&mut self, pipeline: &Pipeline, groups: [u32; 3]) {
        self.flush();
        debug_assert!(
            pipeline.interface.push_constants.is_none(),
            "push constants of the pass"
        );
        self.dispatch_bound(groups);
    }

    fn dispatch_bound(&mut self, [x, y, z]: [u32; 3]) {
        // SAFETY: recording, with a pipeline bound that has its push constants; group counts are within the limits that every
        // device has (65535), kept by the callers.
        unsafe { self.context.device.cmd_dispatch(self.cmd, x, y, z) };
    }
}
