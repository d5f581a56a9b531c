//! How long a picture takes.

use std::time::Instant;

use serde::Serialize;

/// From the start of recording to completion on the device.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FrameTime {
    /// By the clock, ms.
    pub wall_ms: f64,
    /// Processor time of this process meanwhile, all threads, ms; `None` where the system does not tell. A device that is the
    /// processor itself works in it: divided by the cores, it is what an idle machine would take.
    pub cpu_ms: Option<f64>,
}

/// Started when made.
pub(super) struct Stopwatch {
    wall: Instant,
    cpu_ms: Option<f64>,
}

impl Stopwatch {
    pub(super) fn start() -> Self {
        Self {
            cpu_ms: process_cpu_ms(),
            wall: Instant::now(),
        }
    }

    pub(super) fn elapsed(&self) -> FrameTime {
        FrameTime {
            wall_ms: self.wall.elapsed().as_secs_f64() * 1e3,
            cpu_ms: self
                .cpu_ms
                .zip(process_cpu_ms())
                .map(|(start, now)| now - start),
        }
    }
}

#[cfg(unix)]
fn process_cpu_ms() -> Option<f64> {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    Some(time.tv_sec as f64 * 1e3 + time.tv_nsec as f64 * 1e-6)
}

#[cfg(not(unix))]
fn process_cpu_ms() -> Option<f64> {
    None
}
