//! Files that nobody should trust. Whatever a file holds, it is read within the limits or refused as bad input, within a
//! second and little memory: never a panic, never an abort. The same tables of seeds serve every kind of damage.

mod bombs;
mod claims;
mod cuts;
mod mutations;
mod references;
mod seeds;
mod values;

use std::alloc::System;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use peakmem_alloc::{PeakMemAlloc, PeakMemAllocTrait as _};
use umbravox::Error;
use umbravox::io::{Limits, ReadOptions, read};
use umbravox::volume::Volume;

#[global_allocator]
static ALLOCATOR: PeakMemAlloc<System> = PeakMemAlloc::new(System);

const MAX_TIME: Duration = Duration::from_secs(1);
/// Above what was held before. The seeds take a hundredth of it; dictionaries of decoders most.
const MAX_MEMORY: usize = 96 << 20;

/// One read at a time: what it takes is measured.
static READING: Mutex<()> = Mutex::new(());

/// Far above what the seeds need, and far below what the machine has.
fn limits() -> Limits {
    Limits {
        max_voxels: 1 << 20,
        max_bytes: 4 << 20,
        max_header_bytes: 1 << 20,
        max_archive_bytes: 16 << 20,
        max_files: 100,
    }
}

fn limited() -> ReadOptions<'static> {
    ReadOptions {
        limits: limits(),
        ..ReadOptions::default()
    }
}

/// Reads; panics when it takes longer or more memory than it may, or fails otherwise than by bad input. `what`
/// says in the message what was done to the file.
#[track_caller]
fn judge(path: &Path, options: &ReadOptions<'_>, what: &str) -> Result<Volume, Error> {
    let _one_at_a_time = READING.lock().unwrap_or_else(PoisonError::into_inner);
    let timed = || {
        ALLOCATOR.reset_peak_memory();
        let start = Instant::now();
        let result = read(path, options);
        let took = start.elapsed();
        (result, took, ALLOCATOR.get_peak_memory())
    };
    let (mut result, mut took, memory) = timed();
    if took > MAX_TIME {
        // The machine may have been busy; what is slow is slow again.
        (result, took, _) = timed();
    }
    let name = path.display();
    assert!(took <= MAX_TIME, "{name}, {what}: took {took:?}");
    assert!(memory <= MAX_MEMORY, "{name}, {what}: took {memory} bytes");
    match &result {
        Ok(volume) => assert!(volume.voxels().len() as u64 <= options.limits.max_voxels),
        Err(error) => assert!(error.is_bad_input(), "{name}, {what}: {error}"),
    }
    result
}

/// [`judge`], and it must be refused with all of `words`.
#[track_caller]
fn refuse(path: &Path, options: &ReadOptions<'_>, words: &[&str]) {
    match judge(path, options, "as it is") {
        Ok(volume) => panic!("{path:?} was read: {:?}, wanted {words:?}", volume.size()),
        Err(error) => {
            let message = error.to_string();
            for word in words {
                assert!(message.contains(word), "{message:?} does not say {word:?}");
            }
        }
    }
}

/// A folder that goes away with the test.
struct Scratch(tempfile::TempDir);

impl Scratch {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn file(&self, name: &str, bytes: &[u8]) -> PathBuf {
        let path = self.0.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(&path, bytes).unwrap();
        path
    }
}

/// What once took memory, time, or the program down.
#[test]
fn known_attacks() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/hostile");
    let mut count = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let _ = judge(&entry.unwrap().path(), &limited(), "as it was found");
        count += 1;
    }
    assert!(count > 0);
}
