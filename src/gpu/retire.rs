//! Objects that are no longer needed but may still be in use by the device.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

use ash::vk;

use super::context::Context;
use super::memory::MemoryBlock;

/// Something to destroy.
pub(crate) enum Retired {
    Buffer(vk::Buffer, MemoryBlock),
    BufferView(vk::BufferView),
    Image(vk::Image, vk::ImageView, MemoryBlock),
    Sampler(vk::Sampler),
    Pipeline(vk::Pipeline, vk::PipelineLayout, vk::DescriptorSetLayout),
    DescriptorPool(vk::DescriptorPool),
    QueryPool(vk::QueryPool),
}

/// The host's frame clock and what waits for it.
///
/// Objects dropped while frame `n` is the newest one recorded are destroyed once frame `n` is known to be complete.
#[derive(Default)]
pub(crate) struct RetireQueue {
    current: AtomicU64,
    waiting: Mutex<Vec<(u64, Retired)>>,
}

impl RetireQueue {
    /// Frame `index` is being recorded.
    pub(crate) fn begin(&self, index: u64) {
        self.current.fetch_max(index, Ordering::AcqRel);
    }

    /// Index of the newest frame recorded.
    pub(crate) fn current(&self) -> u64 {
        self.current.load(Ordering::Acquire)
    }

    pub(crate) fn push(&self, object: Retired) {
        let frame = self.current();
        self.waiting
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .push((frame, object));
    }

    /// Destroys what frames up to `completed` used.
    ///
    /// # Safety
    /// The device has finished every frame with an index up to `completed`, and handles came from `context`.
    pub(crate) unsafe fn collect(&self, context: &Context, completed: u64) {
        let ready: Vec<Retired> = {
            let mut waiting = self.waiting.lock().unwrap_or_else(PoisonError::into_inner);
            let (ready, rest): (Vec<_>, Vec<_>) = waiting
                .drain(..)
                .partition(|&(frame, _)| frame <= completed);
            *waiting = rest;
            ready.into_iter().map(|(_, object)| object).collect()
        };
        for object in ready {
            // SAFETY: every frame that could use the object has finished, by this function's contract; it was pushed by
            // the Drop of its only owner, so nothing refers to it any more.
            unsafe { destroy(context, object) };
        }
    }
}

/// # Safety
/// The device does not use the object and nothing refers to it.
unsafe fn destroy(context: &Context, object: Retired) {
    let device = &context.device;
    // SAFETY: this function's contract, for each handle; a view goes before its image, objects before their memory.
    unsafe {
        match object {
            Retired::Buffer(buffer, block) => {
                device.destroy_buffer(buffer, None);
                context.free_memory(block);
            }
            Retired::BufferView(view) => device.destroy_buffer_view(view, None),
            Retired::Image(image, view, block) => {
                device.destroy_image_view(view, None);
                device.destroy_image(image, None);
                context.free_memory(block);
            }
            Retired::Sampler(sampler) => device.destroy_sampler(sampler, None),
            Retired::Pipeline(pipeline, layout, set_layout) => {
                device.destroy_pipeline(pipeline, None);
                device.destroy_pipeline_layout(layout, None);
                device.destroy_descriptor_set_layout(set_layout, None);
            }
            Retired::DescriptorPool(pool) => device.destroy_descriptor_pool(pool, None),
            Retired::QueryPool(pool) => device.destroy_query_pool(pool, None),
        }
    }
}
