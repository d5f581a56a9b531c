//! Keys of a Zarr store and what lies under them.

use std::borrow::Cow;
use std::collections::HashMap;
use std::path::PathBuf;

use serde::de::DeserializeOwned;

use crate::error::{Error, Result};
use crate::io::Limits;
use crate::io::bundle::{Bundle, Member};
use crate::io::source::bad;

/// Files that say what a folder is.
const ROOT_FILES: [&str; 4] = ["zarr.json", ".zattrs", ".zgroup", ".zarray"];

/// A store, or a group of it. Keys only ever find files of the bundle: none leads out of it.
pub(super) struct Store<'a> {
    bundle: &'a Bundle,
    limits: &'a Limits,
    root: String,
    members: HashMap<&'a str, &'a Member>,
}

/// The folder nearest to the top that is a Zarr group or array, with `/` at its end unless it is the top.
pub(super) fn root(bundle: &Bundle) -> Option<&str> {
    let folders = bundle.members().iter().filter_map(|member| {
        let (folder, name) = split(member.name());
        ROOT_FILES.contains(&name).then_some(folder)
    });
    folders.min_by_key(|folder| folder.matches('/').count())
}

/// The folder of a file, with its `/`, and the file's own name.
fn split(name: &str) -> (&str, &str) {
    let at = name.rfind('/').map_or(0, |slash| slash + 1);
    name.split_at(at)
}

impl<'a> Store<'a> {
    /// From the root of what the bundle holds.
    pub(super) fn new(bundle: &'a Bundle, limits: &'a Limits) -> Self {
        let members = bundle.members().iter();
        Self {
            bundle,
            limits,
            root: root(bundle).unwrap_or_default().to_owned(),
            members: members.map(|member| (member.name(), member)).collect(),
        }
    }

    /// The group below `path`.
    pub(super) fn enter(&mut self, path: &str) {
        self.root = self.full(&format!("{path}/"));
    }

    fn full(&self, key: &str) -> String {
        format!("{}{key}", self.root)
    }

    /// What messages call the file of a key.
    pub(super) fn path(&self, key: &str) -> PathBuf {
        self.bundle.path().join(self.full(key))
    }

    /// The bytes of a key, if it is there.
    pub(super) fn bytes(&self, key: &str) -> Result<Option<Cow<'a, [u8]>>> {
        let member = self.members.get(self.full(key).as_str());
        member.map(|member| member.bytes(self.limits)).transpose()
    }

    /// The JSON of a key, if it is there.
    pub(super) fn json<T: DeserializeOwned>(&self, key: &str) -> Result<Option<T>> {
        let Some(bytes) = self.bytes(key)? else {
            return Ok(None);
        };
        if bytes.len() as u64 > self.limits.max_header_bytes {
            return Err(self.bad(key, "it is longer than the limit for headers".into()));
        }
        serde_json::from_slice(&bytes)
            .map(Some)
            .map_err(|e| self.bad(key, e.to_string()))
    }

    pub(super) fn bad(&self, key: &str, message: String) -> Error {
        bad(&self.path(key), message)
    }
}
