//! Compiled pipelines kept on disk, so that the second start is fast.
//!
//! The file is ours until proven: magic, device identity, length and checksum come before the driver sees a byte of it, since
//! drivers are not all careful with damaged caches. Anything unexpected is ignored; a cache is never an error.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use super::capabilities::Capabilities;

const MAGIC: &[u8; 8] = b"UVXPC\0\0\x01";

/// The file of one device.
pub(crate) struct PipelineCacheFile {
    path: PathBuf,
    /// Vendor, device and cache UUID.
    identity: Vec<u8>,
}

impl PipelineCacheFile {
    /// In the user's cache folder; `None` where there is none.
    pub(crate) fn of_device(capabilities: &Capabilities) -> Option<Self> {
        let folder = std::env::var_os("XDG_CACHE_HOME")
            .map(PathBuf::from)
            .filter(|p| p.is_absolute())
            .or_else(|| Some(PathBuf::from(std::env::var_os("HOME")?).join(".cache")))?;
        let [vendor, device] = capabilities.ids.map(u32::to_le_bytes);
        let identity = [&vendor[..], &device, &capabilities.cache_uuid].concat();
        let name: String = identity.iter().map(|b| format!("{b:02x}")).collect();
        let path = folder
            .join("umbravox")
            .join(format!("pipelines-{name}.bin"));
        Some(Self { path, identity })
    }

    /// The driver's data for this device; empty when there is none, or none that can be trusted.
    pub(crate) fn load(&self) -> Vec<u8> {
        std::fs::read(&self.path)
            .ok()
            .and_then(|file| unwrap(&file, &self.identity))
            .unwrap_or_default()
    }

    /// Writes the driver's data, whole or not at all.
    pub(crate) fn store(&self, data: &[u8]) {
        let wrapped = wrap(data, &self.identity);
        if std::fs::read(&self.path).is_ok_and(|there| there == wrapped) {
            return;
        }
        if let Err(e) = write_whole(&self.path, &wrapped) {
            tracing::debug!(
                "the pipeline cache {} was not written: {e}",
                self.path.display()
            );
        }
    }
}

fn write_whole(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder)?;
    }
    let temporary = path.with_extension(format!("{}.tmp", std::process::id()));
    let written = std::fs::File::create(&temporary).and_then(|mut f| f.write_all(bytes));
    match written.and_then(|()| std::fs::rename(&temporary, path)) {
        Ok(()) => Ok(()),
        Err(e) => {
            let _ = std::fs::remove_file(&temporary);
            Err(e)
        }
    }
}

fn wrap(data: &[u8], identity: &[u8]) -> Vec<u8> {
    let length = (data.len() as u64).to_le_bytes();
    [
        MAGIC,
        identity,
        &length,
        &checksum(data).to_le_bytes(),
        data,
    ]
    .concat()
}

fn unwrap(file: &[u8], identity: &[u8]) -> Option<Vec<u8>> {
    let rest = file
        .strip_prefix(MAGIC.as_slice())?
        .strip_prefix(identity)?;
    let (length, rest) = rest.split_first_chunk::<8>()?;
    let (sum, data) = rest.split_first_chunk::<8>()?;
    let whole = u64::from_le_bytes(*length) == data.len() as u64;
    (whole && u64::from_le_bytes(*sum) == checksum(data)).then(|| data.to_vec())
}

/// FNV-1a: finds damage, not malice (who can write here can replace the program as well).
fn checksum(data: &[u8]) -> u64 {
    data.iter().fold(0xcbf2_9ce4_8422_2325, |h, &b| {
        (h ^ u64::from(b)).wrapping_mul(0x100_0000_01b3)
    })
}

#[cfg(test)]
mod tests {
    use super::{unwrap, wrap};

    #[test]
    fn only_whole_caches_of_this_device_are_taken() {
        let file = wrap(b"pipelines", b"device A");
        assert_eq!(
            unwrap(&file, b"device A").as_deref(),
            Some(&b"pipelines"[..])
        );
        assert_eq!(unwrap(&file, b"device B"), None, "another device");
        for cut in 0..file.len() {
            assert_eq!(unwrap(&file[..cut], b"device A"), None, "cut at {cut}");
        }
        for byte in 0..file.len() {
            let mut damaged = file.clone();
            damaged[byte] ^= 0x10;
            assert_eq!(unwrap(&damaged, b"device A"), None, "damage at {byte}");
        }
    }
}
