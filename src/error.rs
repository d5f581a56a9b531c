//! One error type for the whole library.

use std::path::PathBuf;

/// What can go wrong. Messages say what, where, and what would be valid.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A Vulkan call failed. `call` is the function, `object` our debug name of what it was for.
    #[error("{call} failed for {object:?}: {result}")]
    Vulkan {
        /// The Vulkan function.
        call: &'static str,
        /// Debug name of the object concerned.
        object: String,
        /// What Vulkan returned.
        result: ash::vk::Result,
    },
    /// The device stopped. `last_pass` is the last pass known to have started.
    #[error("device lost; the last pass that started was {}", .last_pass.as_deref().unwrap_or("none"))]
    DeviceLost {
        /// Name of the pass, `None` when no pass had started.
        last_pass: Option<String>,
    },
    /// An allocation failed. Retry with a smaller memory budget or a larger data reduction.
    #[error("out of {heap} memory: {what} asked for {bytes} bytes ({detail})")]
    OutOfMemory {
        /// Which memory: "device" or "host".
        heap: &'static str,
        /// Debug name of the object that asked.
        what: String,
        /// Size of the request in bytes.
        bytes: u64,
        /// What the memory back end said.
        detail: String,
    },
    /// The device or driver lacks something that is needed.
    #[error("{device}: {need} is needed; it has {have}")]
    Unsupported {
        /// Device name.
        device: String,
        /// What is needed.
        need: String,
        /// What is there.
        have: String,
    },
    /// No usable Vulkan device, or none of the name asked for.
    #[error("{0}")]
    NoDevice(String),
    /// A volume file is damaged, unsupported or does not say enough.
    #[error("{}: {message}", .path.display())]
    Volume {
        /// The file.
        path: PathBuf,
        /// What is wrong, where, and what would be valid.
        message: String,
    },
    /// A scene, or an argument of the library, is not valid. `at` is a JSON pointer-like place (`camera.fov_y`).
    #[error("{at}: {message}")]
    Invalid {
        /// Where: a scene key path or an argument name.
        at: String,
        /// What is wrong and what would be valid.
        message: String,
    },
    /// Reading or writing a file failed.
    #[error("{}: {source}", .path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The validation layer reported something: a fault of ours or of the driver.
    #[error("Vulkan validation: {0}")]
    Validation(String),
    /// An output file could not be encoded.
    #[error("{}: cannot encode: {message}", .path.display())]
    Encode {
        /// The file.
        path: PathBuf,
        /// What the encoder said.
        message: String,
    },
}

impl Error {
    /// True for what the caller can mend by changing a scene, a file or a flag (exit status 2 of the program);
    /// false for what happened to us (device lost, disk full).
    pub fn is_bad_input(&self) -> bool {
        match self {
            Self::Volume { .. } | Self::Invalid { .. } | Self::NoDevice(_) => true,
            Self::Io { source, .. } => matches!(
                source.kind(),
                std::io::ErrorKind::NotFound
                    | std::io::ErrorKind::IsADirectory
                    | std::io::ErrorKind::NotADirectory
                    | std::io::ErrorKind::PermissionDenied
                    // Names that no file can have.
                    | std::io::ErrorKind::InvalidInput
                    | std::io::ErrorKind::InvalidFilename
            ),
            _ => false,
        }
    }

    /// An [`Error::Invalid`] at a place.
    pub fn invalid(at: impl Into<String>, message: impl Into<String>) -> Self {
        Self::Invalid {
            at: at.into(),
            message: message.into(),
        }
    }

    /// An [`Error::Volume`] for a file.
    pub fn volume(path: impl Into<PathBuf>, message: impl Into<String>) -> Self {
        Self::Volume {
            path: path.into(),
            message: message.into(),
        }
    }

    /// An [`Error::Io`] for a file.
    pub fn io(path: impl Into<PathBuf>, source: std::io::Error) -> Self {
        Self::Io {
            path: path.into(),
            source,
        }
    }
}

/// Shorthand for results of this library.
pub type Result<T, E = Error> = std::result::Result<T, E>;
