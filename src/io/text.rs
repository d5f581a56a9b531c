//! Numbers and names in text headers.

use std::path::Path;
use std::str::FromStr;

use super::source;
use crate::error::Result;

/// All white-space separated numbers of a header's field. `what` says what they should be.
pub(super) fn numbers<T: FromStr>(
    path: &Path,
    key: &str,
    text: &str,
    what: &str,
) -> Result<Vec<T>> {
    text.split_whitespace()
        .map(|word| {
            word.parse().map_err(|_| {
                source::bad(path, format!("{key}: {word:?} is not {what} (in {text:?})"))
            })
        })
        .collect()
}

/// One whole number.
pub(super) fn number<T: FromStr>(path: &Path, key: &str, text: &str) -> Result<T> {
    text.trim().parse().map_err(|_| {
        source::bad(
            path,
            format!("{key}: {text:?} is not a whole number in range"),
        )
    })
}

/// Sizes of axes.
pub(super) fn sizes(path: &Path, key: &str, text: &str) -> Result<Vec<u64>> {
    numbers(path, key, text, "a number of voxels")
}

/// Exactly `count` numbers.
pub(super) fn floats(path: &Path, key: &str, text: &str, count: usize) -> Result<Vec<f64>> {
    let all: Vec<f64> = numbers(path, key, text, "a number")?;
    if all.len() == count {
        return Ok(all);
    }
    Err(source::bad(
        path,
        format!(
            "{key} {text:?}: {count} numbers are needed, {} are there",
            all.len()
        ),
    ))
}

/// One of the values that are read, found by name.
pub(super) fn one_of<T: Copy>(
    path: &Path,
    key: &str,
    text: &str,
    valid: &[(&str, T)],
) -> Result<T> {
    valid
        .iter()
        .find(|(name, _)| name.eq_ignore_ascii_case(text))
        .map(|&(_, value)| value)
        .ok_or_else(|| {
            let names: Vec<&str> = valid.iter().map(|&(name, _)| name).collect();
            source::bad(
                path,
                format!("{key} {text:?} is not read; valid are {}", names.join(", ")),
            )
        })
}
