//! Data files beside their header.

use std::path::{Component, Path, PathBuf};

use super::source::Source;
use crate::error::{Error, Result};

/// Opens the data file that a header names.
pub(super) fn open(header: &Path, key: &str, name: &str) -> Result<Source> {
    match Source::open(&path(header, key, name)?) {
        Err(Error::Io { source, .. }) => Err(bad(
            header,
            key,
            name,
            &format!("cannot open it ({source})"),
        )),
        other => other,
    }
}

/// Where the data file is that a header names: inside the header's folder and nowhere else. A header from elsewhere
/// must not be able to show other files of this machine.
pub(super) fn path(header: &Path, key: &str, name: &str) -> Result<PathBuf> {
    let refuse = |why: &str| Err(bad(header, key, name, why));
    let mut depth = 0u32;
    for part in Path::new(name).components() {
        match part {
            Component::Prefix(_) | Component::RootDir => return refuse("this path is absolute"),
            Component::ParentDir if depth == 0 => {
                return refuse("this path leaves the header's folder");
            }
            Component::ParentDir => depth -= 1,
            Component::Normal(_) => depth += 1,
            Component::CurDir => {}
        }
    }
    if depth == 0 {
        return refuse("this names no file");
    }
    Ok(header.parent().unwrap_or(Path::new("")).join(name))
}

fn bad(header: &Path, key: &str, name: &str, why: &str) -> Error {
    Error::volume(
        header,
        format!(
            "{key} {name:?}: {why}; a path relative to the header and inside its folder is needed"
        ),
    )
}
