//! Numbered pictures: `frame_%04d.png`.

use std::path::{Path, PathBuf};

/// A path with one number in its file name.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Series {
    folder: PathBuf,
    before: String,
    width: usize,
    after: String,
}

impl Series {
    /// Finds `%d` or `%04d` (any width) in a file name; `None` when there is none.
    pub(crate) fn parse(path: &Path) -> Option<Self> {
        let name = path.file_name()?.to_str()?;
        name.match_indices('%').find_map(|(start, _)| {
            let rest = &name[start + 1..];
            let digits = rest.bytes().take_while(u8::is_ascii_digit).count();
            let after = rest[digits..].strip_prefix('d')?;
            let width = match &rest[..digits] {
                "" => 0,
                digits => digits.parse().ok().filter(|width| *width <= MAX_WIDTH)?,
            };
            Some(Self {
                folder: path.parent().map(Path::to_path_buf).unwrap_or_default(),
                before: name[..start].to_owned(),
                width,
                after: after.to_owned(),
            })
        })
    }

    /// The path of picture `number`.
    pub(crate) fn path(&self, number: u32) -> PathBuf {
        let width = self.width;
        let name = format!("{}{number:0width$}{}", self.before, self.after);
        self.folder.join(name)
    }
}

/// File names have an end.
const MAX_WIDTH: usize = 20;
