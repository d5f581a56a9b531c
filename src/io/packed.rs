//! Ordinary volume files in an archive: unpacked into a folder of their own, which goes away after reading.

use std::io::{self, ErrorKind};
use std::path::{Component, Path, PathBuf};

use super::bundle::{Bundle, Member};
use super::source::bad;
use super::{HEAD_BYTES, ReadOptions, formats, read_file, reader_of};
use crate::error::{Error, Result};
use crate::volume::Volume;

/// The one file that is a volume; of several, the one that `volume.series` names.
fn choose<'a>(archive: &'a Bundle, options: &ReadOptions<'_>) -> Result<&'a Member> {
    let volumes: Vec<&Member> = archive
        .members()
        .iter()
        .filter(|m| reader_of(&m.head(HEAD_BYTES), Path::new(m.name())).is_some())
        .collect();
    let asked = options.series.as_deref();
    let found = volumes.iter().find(|m| asked == Some(m.name()));
    match (volumes.as_slice(), found) {
        (&[one], _) | (_, Some(&one)) => Ok(one),
        ([], _) if archive.members().len() == 1 => Err(formats::unrecognised(archive.path())),
        ([], _) => Err(formats::unrecognised_bundle(archive)),
        (several, _) => {
            const LISTED: usize = 8;
            let names: Vec<&str> = several.iter().take(LISTED).map(|m| m.name()).collect();
            let more = if several.len() > LISTED { ", …" } else { "" };
            let asked = asked.map(|name| format!("no volume {name:?} among "));
            Err(bad(
                archive.path(),
                format!(
                    "{}{} volumes ({}{more}); volume.series picks one by its name",
                    asked.unwrap_or_default(),
                    several.len(),
                    names.join(", ")
                ),
            ))
        }
    }
}

/// Reads it, with the files beside it that its header may name.
pub(super) fn read(archive: &Bundle, options: &ReadOptions<'_>) -> Result<Volume> {
    let chosen = choose(archive, options)?;
    let scratch = tempfile::tempdir().map_err(|e| Error::io(archive.path(), e))?;
    let folder = scratch.path();
    let inside = |member: &Member| -> Option<PathBuf> {
        let name = Path::new(member.name());
        let plain = name
            .components()
            .all(|part| matches!(part, Component::Normal(_)));
        (plain && name.file_name().is_some()).then(|| folder.join(name))
    };
    let own_folder = Path::new(chosen.name()).parent().unwrap_or(Path::new(""));
    for member in archive.members() {
        if !Path::new(member.name()).starts_with(own_folder) {
            continue;
        }
        let Some(path) = inside(member) else {
            continue;
        };
        let parent = path.parent().unwrap_or(folder);
        let bytes = member.bytes(&options.limits)?;
        std::fs::create_dir_all(parent)
            .and_then(|()| std::fs::write(&path, bytes))
            .map_err(|e| not_written(archive, member, e))?;
    }
    let path = inside(chosen).ok_or_else(|| {
        bad(
            archive.path(),
            format!("{:?} is no plain name of a file", chosen.name()),
        )
    })?;
    let options = ReadOptions {
        series: None,
        ..options.clone()
    };
    // Messages call the file by where it came from.
    read_file(&path, &options).map_err(|error| match error {
        Error::Volume { path, message } => Error::Volume {
            path: match path.strip_prefix(folder) {
                Ok(name) => archive.path().join(name),
                Err(_) => path,
            },
            message,
        },
        other => other,
    })
}

/// A full disk is nobody's fault; a name that no file can have is the archive's.
fn not_written(archive: &Bundle, member: &Member, error: io::Error) -> Error {
    match error.kind() {
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded | ErrorKind::PermissionDenied => {
            Error::io(archive.path(), error)
        }
        _ => bad(
            archive.path(),
            format!("{:?} cannot be unpacked: {error}", member.name()),
        ),
    }
}
