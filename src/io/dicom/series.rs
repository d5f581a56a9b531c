//! Which frames belong together.

use std::collections::BTreeMap;
use std::path::Path;

use super::super::ReadOptions;
use super::super::source::bad;
use super::frame::Frame;
use crate::error::Result;

/// Most series that a message lists.
const MAX_LISTED: usize = 12;

/// Frames of one size, pixel format and orientation, of one `SeriesInstanceUID`.
pub(super) struct Series {
    pub(super) frames: Vec<Frame>,
}

impl Series {
    fn voxels(&self) -> u64 {
        self.frames
            .iter()
            .fold(0, |n: u64, f| n.saturating_add(f.rows * f.columns))
    }

    fn describe(&self) -> String {
        let Some(first) = self.frames.first() else {
            return String::new();
        };
        format!(
            "{} {:?}, {} x {} x {} ({})",
            first.series_number.as_deref().unwrap_or("?"),
            first.series_description.as_deref().unwrap_or(""),
            first.columns,
            first.rows,
            self.frames.len(),
            first.series_uid
        )
    }

    fn is_called(&self, name: &str) -> bool {
        self.frames.first().is_some_and(|first| {
            let number = first.series_number.as_deref();
            let description = first.series_description.as_deref();
            first.series_uid == name
                || number == Some(name)
                || (!name.is_empty() && description.is_some_and(|d| d.starts_with(name)))
        })
    }
}

/// Sorts frames into series, the largest first. Scouts of another orientation within a series are one of their own.
pub(super) fn group(frames: Vec<Frame>) -> Vec<Series> {
    let mut groups: BTreeMap<_, Vec<Frame>> = BTreeMap::new();
    for frame in frames {
        // Directions that differ by less than a thousandth are one: writers round them.
        let direction = frame
            .directions
            .map(|d| d.map(|v| (v * 1000.0).round().as_i64vec3().to_array()));
        let format = frame.format;
        let key = (
            frame.series_uid.clone(),
            [frame.columns, frame.rows, format.allocated, format.samples],
            format.signed,
            direction,
        );
        groups.entry(key).or_default().push(frame);
    }
    let mut all: Vec<Series> = groups
        .into_values()
        .map(|frames| Series { frames })
        .collect();
    all.sort_by_key(|series| std::cmp::Reverse(series.voxels()));
    all
}

/// The series asked for, or the largest.
pub(super) fn choose(path: &Path, all: Vec<Series>, options: &ReadOptions<'_>) -> Result<Series> {
    let list: Vec<String> = all.iter().take(MAX_LISTED).map(Series::describe).collect();
    let list = list.join("; ");
    let count = all.len();
    let mut all = all.into_iter();
    let chosen = match &options.series {
        Some(name) => all.find(|series| series.is_called(name)).ok_or_else(|| {
            bad(
                path,
                format!("no series {name:?} (volume.series); there are {list}"),
            )
        })?,
        None => all
            .next()
            .ok_or_else(|| bad(path, "there is no DICOM object with pictures".into()))?,
    };
    if count > 1 && options.series.is_none() {
        tracing::info!("{count} series, the largest is read; volume.series picks another: {list}");
    }
    Ok(chosen)
}
