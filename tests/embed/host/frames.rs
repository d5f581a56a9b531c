//! Frames in flight: a ring of command buffers and fences.

use ash::vk;

use super::Host;

/// A frame being recorded.
pub(crate) struct Frame {
    pub(crate) cmd: vk::CommandBuffer,
    /// Number, from 1.
    pub(crate) index: u64,
    /// The newest frame that the device has finished.
    pub(crate) completed: u64,
}

/// The host's frame clock. Only the frame that used a slot before is ever waited for.
pub(crate) struct Frames {
    slots: Vec<(vk::CommandBuffer, vk::Fence)>,
    newest: u64,
}

impl Frames {
    pub(crate) fn new(host: &Host, in_flight: usize) -> Self {
        let info = vk::CommandBufferAllocateInfo::default()
            .command_pool(host.pool)
            .level(vk::CommandBufferLevel::PRIMARY)
            .command_buffer_count(in_flight as u32);
        let signaled = vk::FenceCreateInfo::default().flags(vk::FenceCreateFlags::SIGNALED);
        // SAFETY: the device and its pool are alive.
        let slots = unsafe {
            let commands = host.device.allocate_command_buffers(&info).unwrap();
            commands
                .into_iter()
                .map(|cmd| (cmd, host.device.create_fence(&signaled, None).unwrap()))
                .collect()
        };
        Self { slots, newest: 0 }
    }

    /// Number of the newest frame.
    pub(crate) fn newest(&self) -> u64 {
        self.newest
    }

    /// The next frame, with its command buffer recording.
    pub(crate) fn begin(&mut self, host: &Host) -> Frame {
        self.newest += 1;
        let in_flight = self.slots.len() as u64;
        let (cmd, fence) = self.slots[(self.newest % in_flight) as usize];
        let begin = vk::CommandBufferBeginInfo::default()
            .flags(vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT);
        // SAFETY: the slot's last frame has finished once its fence is signalled; one thread uses the pool.
        unsafe {
            host.device
                .wait_for_fences(&[fence], true, u64::MAX)
                .unwrap();
            host.device.begin_command_buffer(cmd, &begin).unwrap();
        }
        Frame {
            cmd,
            index: self.newest,
            completed: self.newest.saturating_sub(in_flight),
        }
    }

    /// Submits a frame; does not wait.
    pub(crate) fn submit(&mut self, host: &Host, frame: &Frame) {
        let fence = self.slots[(frame.index % self.slots.len() as u64) as usize].1;
        let commands = [frame.cmd];
        let submits = [vk::SubmitInfo::default().command_buffers(&commands)];
        // SAFETY: the command buffer is recording; the fence is signalled and nobody waits for it.
        unsafe {
            host.device.end_command_buffer(frame.cmd).unwrap();
            host.device.reset_fences(&[fence]).unwrap();
            host.device
                .queue_submit(host.queue, &submits, fence)
                .unwrap();
        }
    }

    /// Throws the recorded commands of a frame away.
    pub(crate) fn discard(&mut self, host: &Host, frame: &Frame) {
        // SAFETY: recorded, and not submitted.
        unsafe {
            host.device.end_command_buffer(frame.cmd).unwrap();
            host.device
                .reset_command_buffer(frame.cmd, vk::CommandBufferResetFlags::empty())
                .unwrap();
        }
    }

    /// Number of the newest frame, once all have finished.
    pub(crate) fn wait(&self, host: &Host) -> u64 {
        let fences: Vec<_> = self.slots.iter().map(|slot| slot.1).collect();
        // SAFETY: the fences are alive.
        unsafe { host.device.wait_for_fences(&fences, true, u64::MAX) }.unwrap();
        self.newest
    }

    pub(crate) fn destroy(self, host: &Host) {
        self.wait(host);
        for (cmd, fence) in self.slots {
            // SAFETY: all frames have finished.
            unsafe {
                host.device.free_command_buffers(host.pool, &[cmd]);
                host.device.destroy_fence(fence, None);
            }
        }
    }
}
