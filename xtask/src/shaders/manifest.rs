//! `spirv/MANIFEST.toml`: what every module was compiled from, by what.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use anyhow::{Context as _, Result};
use serde::{Deserialize, Serialize};
use sha2::{Digest as _, Sha256};

use super::source::Shader;

/// First line of the file.
const HEADER: &str = "# Written by `cargo xtask shaders`. Do not edit.\n";

/// The whole manifest.
#[derive(Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Manifest {
    /// Compiler and version. Other compilers give other bytes from the same source.
    pub compiler: String,
    /// Flags common to all modules.
    pub flags: Vec<String>,
    /// By module name.
    #[serde(default)]
    pub modules: BTreeMap<String, ModuleRecord>,
}

/// One module.
#[derive(Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModuleRecord {
    /// File name in `glsl/`.
    pub source: String,
    /// `NAME` or `NAME=VALUE`.
    pub defines: Vec<String>,
    /// Of the source with its includes.
    pub source_sha256: String,
    /// Of the SPIR-V file.
    pub spirv_sha256: String,
}

impl ModuleRecord {
    /// The record of a module just compiled.
    pub fn new(shader: &Shader, spirv: &[u8]) -> Self {
        Self {
            source: shader.source.clone(),
            defines: shader.defines.clone(),
            source_sha256: sha256(shader.expanded.as_bytes()),
            spirv_sha256: sha256(spirv),
        }
    }

    /// True when the module was compiled from this source, as it is now.
    pub fn matches_source(&self, shader: &Shader) -> bool {
        self.source == shader.source
            && self.defines == shader.defines
            && self.source_sha256 == sha256(shader.expanded.as_bytes())
    }
}

impl Manifest {
    /// Reads the file.
    pub fn read(path: &Path) -> Result<Self> {
        let context = || path.display().to_string();
        let text = fs::read_to_string(path).with_context(context)?;
        toml::from_str(&text).with_context(context)
    }

    /// Writes the file.
    pub fn write(&self, path: &Path) -> Result<()> {
        let text = format!("{HEADER}{}", toml::to_string(self)?);
        fs::write(path, text).with_context(|| path.display().to_string())
    }
}

/// SHA-256 in hexadecimal.
pub fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes)
        .iter()
        .map(|byte| format!("{byte:02x}"))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sha256_of_the_standard_example() {
        // FIPS 180-4, example "abc".
        let expected = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!(sha256(b"abc"), expected);
    }
}
