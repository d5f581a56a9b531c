//! Which files are drawn, and what is said of them.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use umbravox::headless::DeviceInfo;
use umbravox::{Error, Result};

/// Endings of files that lie beside volumes and are none by themselves.
const NO_VOLUMES: [&str; 4] = [".md", ".txt", ".raw", ".json"];

/// A volume that was drawn.
pub(crate) struct Entry {
    pub(crate) file: String,
    pub(crate) voxels: [u32; 3],
    pub(crate) modality: String,
    pub(crate) reason: String,
    pub(crate) preset: &'static str,
    pub(crate) read_seconds: f64,
    /// From opening the file to the picture.
    pub(crate) seconds: f64,
    pub(crate) notices: Vec<String>,
}

impl Entry {
    pub(crate) fn caption(&self) -> Vec<String> {
        let second = format!("{}: {}", self.modality, self.preset);
        vec![self.file.clone(), second]
    }
}

/// Files of the folders by name. A file that an earlier folder holds under the same stem is not drawn again.
pub(crate) fn volumes(folders: &[PathBuf]) -> Result<Vec<PathBuf>> {
    let mut found: Vec<PathBuf> = Vec::new();
    for folder in folders {
        let io = |e| Error::io(folder, e);
        let mut paths = Vec::new();
        for entry in std::fs::read_dir(folder).map_err(io)? {
            let path = entry.map_err(io)?.path();
            let name = name_of(&path);
            if path.is_file() && !NO_VOLUMES.iter().any(|ending| name.ends_with(ending)) {
                paths.push(path);
            }
        }
        paths.sort();
        paths.retain(|path| !found.iter().any(|other| stem(other) == stem(path)));
        found.extend(paths);
    }
    Ok(found)
}

pub(crate) fn name_of(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default();
    name.to_string_lossy().into_owned()
}

/// The name up to its first dot.
fn stem(path: &Path) -> String {
    let name = name_of(path);
    name.split('.').next().unwrap_or_default().to_owned()
}

/// The list. Files that could not be drawn stand at its end, with the reason.
pub(crate) fn markdown(entries: &[Result<Entry, (String, String)>], device: &DeviceInfo) -> String {
    let mut text = format!(
        "# Gallery\n\n\
         Every volume in `data/`, and the larger ones beside the repository where they were at hand, as `umbravox render\n\
         VOLUME -o x.png` draws them: nothing was set but the size. `make gallery` makes this page. Times are from opening\n\
         the file to the picture, on {}.\n\n\
         ![Contact sheet](gallery.png)\n\n\
         | file | voxels | taken for | because of | transfer function | read, s | in all, s |\n\
         | --- | --- | --- | --- | --- | --: | --: |\n",
        device.name
    );
    for entry in entries.iter().flatten() {
        let [x, y, z] = entry.voxels;
        let notices: String = entry.notices.iter().map(|n| format!("; {n}")).collect();
        // Writing to a string does not fail.
        let _ = writeln!(
            text,
            "| `{}` | {x} x {y} x {z} | {} | {}{notices} | `{}` | {:.1} | {:.1} |",
            entry.file,
            entry.modality,
            entry.reason,
            entry.preset,
            entry.read_seconds,
            entry.seconds
        );
    }
    let failed: Vec<_> = entries.iter().filter_map(|e| e.as_ref().err()).collect();
    if !failed.is_empty() {
        text += "\nNot drawn:\n\n";
        for (file, reason) in failed {
            let reason: String = reason.chars().take(160).collect();
            let _ = writeln!(text, "- `{file}`: {reason}…");
        }
    }
    text
}
