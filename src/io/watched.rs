//! Work on all cores, with the caller's thread telling how far it is.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

/// How often progress is told.
const INTERVAL: Duration = Duration::from_millis(50);

/// Runs `work`, which counts what is done of `all`. Progress is told by the calling thread alone: its receiver need not be
/// shared between threads, and the work never waits for it.
pub(super) fn watched<R: Send>(
    progress: Option<&dyn Fn(u64, u64)>,
    all: u64,
    work: impl FnOnce(&AtomicU64) -> R + Send,
) -> R {
    let done = AtomicU64::new(0);
    let Some(progress) = progress else {
        return work(&done);
    };
    let tell = || progress(done.load(Ordering::Relaxed).min(all), all);
    std::thread::scope(|scope| {
        let (end, ended) = channel::<()>();
        let worker = scope.spawn(|| {
            // Dropped when the work ends, however it ends.
            let _end = end;
            work(&done)
        });
        while ended.recv_timeout(INTERVAL) == Err(RecvTimeoutError::Timeout) {
            tell();
        }
        let result = worker.join();
        tell();
        result.unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    })
}
