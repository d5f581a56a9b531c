//! Data files beside their header.

use std::path::{Component, Path};

use super::source::Source;
use crate::error::{Error, Result};

/// Opens the data file that a header names, inside the header's folder and nowhere else: a header from elsewhere
/// must not be able to show other files of this machine.
pub(super) fn open(header: &Path, key: &str, name: &str) -> Result<Source> {
    let bad = |why: &str| {
        Err(Error::volume(
            header,
            format!(
                "{key} {name:?}: {why}; a path relative to the header and inside its folder is needed"
            ),
        ))
    };
    let mut depth = 0u32;
    for part in Path::new(name).components() {
        match part {
            Component::Prefix(_) | Component::RootDir => return bad("this path is absolute"),
            Component::ParentDir if depth == 0 => {
                return bad("this path leaves the header's folder");
            }
            Component::ParentDir => depth -= 1,
            Component::Normal(_) => depth += 1,
            Component::CurDir => {}
        }
    }
    if depth == 0 {
        return bad("this names no file");
    }
    let path = header.parent().unwrap_or(Path::new("")).join(name);
    match Source::open(&path) {
        Err(Error::Io { source, .. }) => bad(&format!("cannot open it ({source})")),
        other => other,
    }
}
