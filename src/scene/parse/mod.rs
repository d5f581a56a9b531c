//! From the text of a scene file to a checked [`Scene`].
//!
//! JSON text -> value without duplicate keys -> overrides -> shape (keys, types, names; against the JSON Schema
//! that [`super::schema`] publishes) -> [`Scene`] -> ranges ([`Scene::validate`]). Overrides come before the
//! checks, so that a wrong `--set` reads like a wrong file.

mod overrides;
mod shape;
mod unique_keys;

use std::path::Path;

use serde_json::{Value, json};

use super::schema::SCHEMA_KEY;
use super::{Environment, Scene};
use crate::error::{Error, Result};

pub use overrides::Override;

/// Scene files above this are refused unread. The largest sensible ones hold some thousand control points.
const MAX_BYTES: u64 = 64 << 20;

/// Behind volumes that come without a scene: dark, and yet lighter than what lies in shadow.
const BACKGROUND: [f64; 3] = [0.09, 0.10, 0.12];

impl Scene {
    /// Reads a scene file. Paths in it become relative to the working directory.
    ///
    /// # Errors
    /// [`Error::Io`] when it cannot be read; [`Error::Invalid`] with the file and the place in it when it is not
    /// UTF-8, not JSON or not a valid scene.
    pub fn read(path: &Path, overrides: &[Override]) -> Result<Self> {
        let size = std::fs::metadata(path)
            .map_err(|e| Error::io(path, e))?
            .len();
        if size > MAX_BYTES {
            return Err(Error::invalid(
                path.display().to_string(),
                format!("{size} bytes are not a scene file; it has {MAX_BYTES} at most"),
            ));
        }
        let bytes = std::fs::read(path).map_err(|e| Error::io(path, e))?;
        let text = std::str::from_utf8(&bytes).map_err(|e| {
            Error::invalid(
                path.display().to_string(),
                format!(
                    "byte {} is not UTF-8; a scene file is UTF-8 JSON",
                    e.valid_up_to()
                ),
            )
        })?;
        let folder = path.parent().unwrap_or(Path::new(""));
        Self::from_json(text, folder, overrides).map_err(|e| match e {
            Error::Invalid { at, message } => {
                Error::invalid(format!("{}: {at}", path.display()), message)
            }
            other => other,
        })
    }

    /// Parses and checks the text of a scene file that lies in `folder`, which relative paths start from.
    ///
    /// # Errors
    /// [`Error::Invalid`] naming the line and column of a syntax error, or else the key that is wrong and what
    /// would be valid there.
    pub fn from_json(text: &str, folder: &Path, overrides: &[Override]) -> Result<Self> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let value = unique_keys::parse(text)?;
        let mut scene = Self::from_value(value, overrides)?;
        // `join` keeps an absolute path as it is.
        if scene.volume.procedural.is_none() {
            scene.volume.path = folder.join(&scene.volume.path);
        }
        if let Some(labels) = &mut scene.volume.labels {
            labels.path = folder.join(&labels.path);
        }
        if let Some(file) = &mut scene.transfer_function.file {
            *file = folder.join(&*file);
        }
        if let Some(picture) = &mut scene.image.background_image {
            *picture = folder.join(&*picture);
        }
        if let Some(Environment {
            path: Some(path), ..
        }) = &mut scene.lighting.environment
        {
            *path = folder.join(&*path);
        }
        Ok(scene)
    }

    /// The scene for a volume that comes without one, before the volume is known: automatic camera and transfer
    /// function, diffuse shading, ambient occlusion. [`super::FirstPicture`] suits it to the volume.
    ///
    /// # Errors
    /// [`Error::Invalid`] for an override that does not fit.
    pub fn for_volume(path: &Path, overrides: &[Override]) -> Result<Self> {
        Self::for_volume_with(path, json!({ "ambient_occlusion": {} }), overrides)
    }

    /// The same with other parts of the scene, which `overrides` may change.
    pub(super) fn for_volume_with(
        path: &Path,
        mut parts: Value,
        overrides: &[Override],
    ) -> Result<Self> {
        // Paths that are not UTF-8 do not survive JSON: the original is put back unless it was overridden.
        let name = path.to_string_lossy();
        parts["volume"] = json!({ "path": name });
        parts["image"] = json!({ "background": BACKGROUND });
        parts["lighting"] = json!({ "shading": "diffuse", "ambient": 0.6, "diffuse": 1.0 });
        // A camera of another type has none of the keys of ours.
        if overrides.iter().any(|one| one.is_at(&["camera", "type"])) {
            parts["camera"] = json!({});
        } else if parts["camera"].is_null() {
            parts["camera"] = json!({ "type": "auto", "frame": "visible" });
        }
        let mut scene = Self::from_value(parts, overrides)?;
        if scene.volume.path.as_os_str() == name.as_ref() {
            scene.volume.path = path.to_path_buf();
        }
        Ok(scene)
    }

    fn from_value(mut value: Value, overrides: &[Override]) -> Result<Self> {
        for one in overrides {
            one.apply(&mut value)?;
        }
        shape::check(&value)?;
        // For editors: which schema the file follows. It says nothing of the picture.
        if let Some(keys) = value.as_object_mut() {
            keys.remove(SCHEMA_KEY);
        }
        let scene: Self = serde_path_to_error::deserialize(value)
            .map_err(|e| Error::invalid(e.path().to_string(), e.inner().to_string()))?;
        scene.validate()?;
        Ok(scene)
    }
}

/// True when a file holds a scene: by its content (the start of a JSON object), or by the name `*.json`, so that
/// a scene with a syntax error is not taken for a volume.
///
/// # Errors
/// [`Error::Io`] when it cannot be opened or read.
pub fn is_scene_file(path: &Path) -> Result<bool> {
    use std::io::Read;
    if path.is_dir() {
        return Ok(false);
    }
    let file = std::fs::File::open(path).map_err(|e| Error::io(path, e))?;
    if path
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("json"))
    {
        return Ok(true);
    }
    let mut start = Vec::new();
    file.take(512)
        .read_to_end(&mut start)
        .map_err(|e| Error::io(path, e))?;
    let start = start.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&start);
    let mut tokens = start.iter().filter(|b| !b.is_ascii_whitespace());
    // Voxels of a headerless file may begin with a brace too, but hardly go on like this.
    Ok(tokens.next() == Some(&b'{')
        && matches!(tokens.next(), Some(b'"' | b'}'))
        && !start.contains(&0))
}
