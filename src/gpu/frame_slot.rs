//! What one frame in flight needs for itself: uniforms, descriptors, timestamps, pass markers.

use std::sync::Arc;

use ash::vk;

use super::buffer::Buffer;
use super::context::Context;
use super::memory::MemoryLocation;
use super::retire::Retired;
use crate::error::Result;

/// Most passes that are timed and marked in one frame; later ones run unmarked.
const MAX_PASSES: usize = 32;
/// Bytes of uniforms a frame can hold.
const UNIFORM_BYTES: u64 = 4096;
/// Uniform offsets are multiples of this, the largest alignment that Vulkan allows a device to ask for.
const UNIFORM_ALIGNMENT: u64 = 256;

/// GPU time of one pass.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PassTime {
    pub(crate) name: &'static str,
    pub(crate) ms: f64,
}

/// A part of the frame's uniform buffer, bytes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Uniforms {
    pub(super) offset: u64,
    pub(super) bytes: u64,
}

/// Resources of one frame in flight; reused once the frame has completed.
pub(crate) struct FrameSlot {
    context: Arc<Context>,
    /// The frame that uses it; 0: none yet.
    frame: u64,
    pub(super) descriptors: vk::DescriptorPool,
    queries: vk::QueryPool,
    uniforms: Buffer,
    uniform_bytes: u64,
    markers: Buffer,
    passes: Vec<&'static str>,
}

impl FrameSlot {
    pub(super) fn new(context: &Arc<Context>) -> Result<Self> {
        let device = &context.device;
        let kinds = [
            (vk::DescriptorType::UNIFORM_BUFFER, 32),
            (vk::DescriptorType::STORAGE_BUFFER, 32),
            (vk::DescriptorType::COMBINED_IMAGE_SAMPLER, 96),
            (vk::DescriptorType::STORAGE_IMAGE, 32),
            (vk::DescriptorType::STORAGE_TEXEL_BUFFER, 32),
        ];
        let sizes = kinds.map(|(ty, descriptor_count)| vk::DescriptorPoolSize {
            ty,
            descriptor_count,
        });
        let info = vk::DescriptorPoolCreateInfo::default()
            .max_sets(16)
            .pool_sizes(&sizes);
        let mut slot = Self {
            context: context.clone(),
            frame: 0,
            descriptors: vk::DescriptorPool::null(),
            queries: vk::QueryPool::null(),
            uniforms: Buffer::new(
                context,
                "umbravox.frame.uniforms",
                UNIFORM_BYTES,
                vk::BufferUsageFlags::UNIFORM_BUFFER,
                MemoryLocation::Upload,
            )?,
            uniform_bytes: 0,
            markers: Buffer::new(
                context,
                "umbravox.frame.markers",
                4 * MAX_PASSES as u64,
                vk::BufferUsageFlags::TRANSFER_DST,
                MemoryLocation::Readback,
            )?,
            passes: Vec::new(),
        };
        // SAFETY: the device is alive, the infos are complete. On failure the slot's Drop destroys what was made.
        slot.descriptors = unsafe { device.create_descriptor_pool(&info, None) }
            .map_err(|e| context.vulkan_error("vkCreateDescriptorPool", "umbravox.frame", e))?;
        if context.capabilities.timestamp_ns.is_some() {
            let info = vk::QueryPoolCreateInfo::default()
                .query_type(vk::QueryType::TIMESTAMP)
                .query_count(2 * MAX_PASSES as u32);
            // SAFETY: as above.
            slot.queries = unsafe { device.create_query_pool(&info, None) }
                .map_err(|e| context.vulkan_error("vkCreateQueryPool", "umbravox.frame", e))?;
        }
        Ok(slot)
    }

    /// Makes it the slot of a new frame; the old one has completed.
    fn begin(&mut self, frame: u64) -> Result<()> {
        self.frame = frame;
        self.uniform_bytes = 0;
        self.passes.clear();
        self.markers.mapped_mut()?.fill(0);
        // SAFETY: the slot's last frame has completed, so no set of the pool is in use.
        unsafe {
            self.context
                .device
                .reset_descriptor_pool(self.descriptors, vk::DescriptorPoolResetFlags::empty())
        }
        .map_err(|e| {
            self.context
                .vulkan_error("vkResetDescriptorPool", "umbravox.frame", e)
        })
    }

    /// Writes uniforms and tells where they lie.
    pub(crate) fn uniforms(&mut self, data: &[u8]) -> Result<Uniforms> {
        let offset = self.uniform_bytes;
        let bytes = data.len() as u64;
        debug_assert!(
            offset + bytes <= UNIFORM_BYTES,
            "uniforms of a frame fit its buffer"
        );
        self.uniforms.mapped_mut()?[offset as usize..(offset + bytes) as usize]
            .copy_from_slice(data);
        self.uniform_bytes = (offset + bytes).next_multiple_of(UNIFORM_ALIGNMENT);
        Ok(Uniforms { offset, bytes })
    }

    /// The buffer that [`FrameSlot::uniforms`] writes to.
    pub(super) fn uniform_buffer(&self) -> &Buffer {
        &self.uniforms
    }

    /// # Safety
    /// `cmd` is recording, outside a render pass.
    pub(super) unsafe fn reset_queries(&self, cmd: vk::CommandBuffer) {
        if self.queries != vk::QueryPool::null() {
            // SAFETY: this function's contract; the slot's last frame has completed.
            unsafe {
                self.context.device.cmd_reset_query_pool(
                    cmd,
                    self.queries,
                    0,
                    2 * MAX_PASSES as u32,
                );
            }
        }
    }

    /// # Safety
    /// `cmd` is recording, outside a render pass; queries were reset in it.
    pub(super) unsafe fn begin_pass(&mut self, cmd: vk::CommandBuffer, name: &'static str) {
        let index = self.passes.len();
        self.passes.push(name);
        if index >= MAX_PASSES {
            return;
        }
        let device = &self.context.device;
        let before = vk::PipelineStageFlags::COMPUTE_SHADER | vk::PipelineStageFlags::TRANSFER;
        // SAFETY: this function's contract; each pass has a word and two queries of its own.
        unsafe {
            // The mark waits for the passes before, or it would not tell which one hangs.
            device.cmd_pipeline_barrier(
                cmd,
                before,
                vk::PipelineStageFlags::TRANSFER,
                vk::DependencyFlags::empty(),
                &[],
                &[],
                &[],
            );
            device.cmd_fill_buffer(cmd, self.markers.handle(), 4 * index as u64, 4, 1);
            if self.queries != vk::QueryPool::null() {
                device.cmd_write_timestamp(
                    cmd,
                    vk::PipelineStageFlags::ALL_COMMANDS,
                    self.queries,
                    2 * index as u32,
                );
            }
        }
    }

    /// # Safety
    /// As [`FrameSlot::begin_pass`], after it.
    pub(super) unsafe fn end_pass(&self, cmd: vk::CommandBuffer) {
        let index = self.passes.len().saturating_sub(1);
        if index < MAX_PASSES && self.queries != vk::QueryPool::null() {
            // SAFETY: this function's contract.
            unsafe {
                self.context.device.cmd_write_timestamp(
                    cmd,
                    vk::PipelineStageFlags::ALL_COMMANDS,
                    self.queries,
                    2 * index as u32 + 1,
                );
            }
        }
    }

    /// GPU times of the passes of a completed frame; empty where the device has no timestamps.
    fn times(&self) -> Vec<PassTime> {
        let Some(tick_ns) = self.context.capabilities.timestamp_ns else {
            return Vec::new();
        };
        let count = self.passes.len().min(MAX_PASSES);
        let mut ticks = vec![0u64; 2 * count];
        if count == 0 {
            return Vec::new();
        }
        // SAFETY: the frame has completed and wrote these queries.
        let read = unsafe {
            self.context.device.get_query_pool_results(
                self.queries,
                0,
                &mut ticks,
                vk::QueryResultFlags::TYPE_64,
            )
        };
        if read.is_err() {
            return Vec::new();
        }
        let mask = self.context.capabilities.timestamp_mask;
        self.passes
            .iter()
            .zip(ticks.chunks_exact(2))
            .map(|(&name, t)| PassTime {
                name,
                ms: (t[1].wrapping_sub(t[0]) & mask) as f64 * tick_ns * 1e-6,
            })
            .collect()
    }

    /// The last pass of this frame that is known to have started.
    fn last_started(&self) -> Option<&'static str> {
        let started = (0..MAX_PASSES)
            .take_while(|&word| self.markers.read_word(word).is_ok_and(|w| w != 0))
            .count();
        started
            .checked_sub(1)
            .and_then(|i| self.passes.get(i).copied())
    }
}

impl Drop for FrameSlot {
    fn drop(&mut self) {
        self.context
            .retire
            .push(Retired::DescriptorPool(self.descriptors));
        self.context.retire.push(Retired::QueryPool(self.queries));
    }
}

/// As many slots as frames are in flight.
#[derive(Default)]
pub(crate) struct FrameSlots {
    slots: Vec<FrameSlot>,
    /// Pass times of the newest frame known to have completed, and its number.
    times: (u64, Vec<PassTime>),
}

impl FrameSlots {
    /// A slot for frame `index`, given that frames up to `completed` have finished.
    pub(crate) fn acquire(
        &mut self,
        context: &Arc<Context>,
        index: u64,
        completed: u64,
    ) -> Result<&mut FrameSlot> {
        let free = match self.slots.iter().position(|s| s.frame <= completed) {
            Some(free) => free,
            None => {
                self.slots.push(FrameSlot::new(context)?);
                self.slots.len() - 1
            }
        };
        let timed = self.slots.iter().filter(|s| !s.passes.is_empty());
        if let Some(newest) = timed
            .filter(|s| s.frame <= completed && s.frame > self.times.0)
            .max_by_key(|s| s.frame)
        {
            self.times = (newest.frame, newest.times());
        }
        let slot = &mut self.slots[free];
        slot.begin(index)?;
        Ok(slot)
    }

    /// Recording frame `index` failed; its timestamps may never be written.
    pub(crate) fn abandon(&mut self, index: u64) {
        for slot in self.slots.iter_mut().filter(|s| s.frame == index) {
            slot.passes.clear();
        }
    }

    /// Pass times of frame `index`, which has completed and whose slot was not reused yet.
    pub(crate) fn times_of(&self, index: u64) -> Vec<PassTime> {
        self.slots
            .iter()
            .find(|s| s.frame == index)
            .map(FrameSlot::times)
            .unwrap_or_default()
    }

    /// Pass times of the newest frame known to have completed.
    pub(crate) fn latest_times(&self) -> &[PassTime] {
        &self.times.1
    }

    /// The last pass known to have started, of the newest frame that started any.
    pub(crate) fn last_started(&self) -> Option<&'static str> {
        let mut slots: Vec<_> = self.slots.iter().collect();
        slots.sort_by_key(|s| std::cmp::Reverse(s.frame));
        slots.into_iter().find_map(FrameSlot::last_started)
    }
}
