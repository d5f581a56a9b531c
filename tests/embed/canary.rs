//! Validation is on: faults of the host's own are reported. Every other test relies on this.

use ash::vk;

use crate::host::{Frames, Host, HostBuffer};

const BYTES: usize = 256;

/// Copies `from` to `to`, without any barrier.
fn copy(host: &Host, cmd: vk::CommandBuffer, from: &HostBuffer, to: &HostBuffer) {
    let region = vk::BufferCopy::default().size(BYTES as u64);
    // SAFETY: recording; the buffers are alive and of this size. The missing barrier is the fault to be reported.
    unsafe {
        host.device
            .cmd_copy_buffer(cmd, from.buffer, to.buffer, &[region]);
    }
}

#[test]
fn hazards_are_reported() {
    let host = Host::new();
    let buffers = [(); 3].map(|()| HostBuffer::new(&host, BYTES));
    host.run(|cmd| {
        copy(&host, cmd, &buffers[0], &buffers[1]);
        copy(&host, cmd, &buffers[1], &buffers[2]);
    });
    for buffer in buffers {
        buffer.destroy(&host);
    }
    let messages = host.destroy();
    assert!(
        messages
            .iter()
            .any(|m| m.contains("SYNC-HAZARD-READ-AFTER-WRITE")),
        "{messages:?}"
    );
}

/// Frames in flight overlap: what one frame writes, the next must wait for.
#[test]
fn hazards_between_submissions_are_reported() {
    let host = Host::new();
    let buffers = [(); 3].map(|()| HostBuffer::new(&host, BYTES));
    let mut frames = Frames::new(&host, 2);
    for pair in buffers.windows(2) {
        let frame = frames.begin(&host);
        copy(&host, frame.cmd, &pair[0], &pair[1]);
        frames.submit(&host, &frame);
    }
    frames.destroy(&host);
    for buffer in buffers {
        buffer.destroy(&host);
    }
    let messages = host.destroy();
    assert!(
        messages
            .iter()
            .any(|m| m.contains("SYNC-HAZARD-READ-AFTER-WRITE")),
        "{messages:?}"
    );
}

#[test]
fn a_barrier_makes_the_hazard_go_away() {
    let host = Host::new();
    let buffers = [(); 3].map(|()| HostBuffer::new(&host, BYTES));
    host.run(|cmd| {
        copy(&host, cmd, &buffers[0], &buffers[1]);
        let barrier = [vk::MemoryBarrier::default()
            .src_access_mask(vk::AccessFlags::TRANSFER_WRITE)
            .dst_access_mask(vk::AccessFlags::TRANSFER_READ)];
        let stage = vk::PipelineStageFlags::TRANSFER;
        // SAFETY: recording, outside a render pass.
        unsafe {
            let flags = vk::DependencyFlags::empty();
            host.device
                .cmd_pipeline_barrier(cmd, stage, stage, flags, &barrier, &[], &[]);
        }
        copy(&host, cmd, &buffers[1], &buffers[2]);
    });
    for buffer in buffers {
        buffer.destroy(&host);
    }
    host.finish();
}

#[test]
fn leaks_are_reported() {
    let host = Host::new();
    let info = vk::BufferCreateInfo::default()
        .size(64)
        .usage(vk::BufferUsageFlags::TRANSFER_SRC);
    // SAFETY: the device is alive. Never destroying the buffer is the fault to be reported.
    unsafe { host.device.create_buffer(&info, None) }.unwrap();
    let messages = host.destroy();
    assert!(
        messages
            .iter()
            .any(|m| m.contains("VkBuffer") && m.contains("has not been destroyed")),
        "{messages:?}"
    );
}
