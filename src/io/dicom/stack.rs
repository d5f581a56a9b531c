//! The order of a series' frames along their normal, and the grid that they make.

use std::path::Path;

use glam::DVec3;

use super::super::ReadOptions;
use super::super::source::bad;
use super::frame::Frame;
use super::series::Series;
use crate::error::Result;

/// Positions that differ by less are one, mm.
const SAME_PLACE: f64 = 1e-3;
/// How far a slice may lie from its place on the even grid, of the distance between slices.
const EVENNESS: f64 = 0.02;

/// Frames in order of their position, and where they lie.
pub(super) struct Stack {
    pub(super) frames: Vec<Frame>,
    /// World steps (mm) along a row, along a column and from slice to slice.
    pub(super) steps_ws: [DVec3; 3],
    /// Centre of the first voxel, mm.
    pub(super) origin_ws: DVec3,
    /// Where slices are unevenly spaced: the place of each in units of the slice step, from 0, ascending.
    pub(super) uneven: Option<Vec<f64>>,
}

/// Orders the frames and finds the grid. The step from slice to slice is the way between their positions, and not
/// along the normal: that is how a tilted gantry shears a volume.
pub(super) fn arrange(path: &Path, series: Series, options: &ReadOptions<'_>) -> Result<Stack> {
    let mut frames = series.frames;
    let spacing = spacing(path, &frames, options)?;
    let located = frames.first().and_then(|f| f.directions).filter(|_| {
        frames.iter().all(|f| f.position.is_some()) && (frames.len() == 1 || spread(&frames))
    });
    let Some([row, column]) = located else {
        return unlocated(path, frames, spacing, options);
    };
    let normal = row.cross(column).normalize();
    let place = |f: &Frame| f.position.unwrap_or_default().dot(normal);
    frames.sort_by(|a, b| place(a).total_cmp(&place(b)).then_with(|| in_order(a, b)));
    let frames = one_at_each_place(path, frames, place, options)?;
    let distances: Vec<f64> = frames.iter().map(place).collect();
    let origin_ws = frames.first().and_then(|f| f.position).unwrap_or_default();
    let last = frames.last().and_then(|f| f.position).unwrap_or_default();
    let in_plane = [row * spacing[0], column * spacing[1]];

    let (intervals, length) = (distances.len().saturating_sub(1), span(&distances));
    if intervals == 0 {
        return Err(bad(
            path,
            "the series is one slice; a volume needs at least 2".into(),
        ));
    }
    let (step, uneven) = slice_step(path, &distances, options)?;
    let way = (last - origin_ws) / length;
    check_straight(path, &frames, origin_ws, way, place)?;
    Ok(Stack {
        frames,
        steps_ws: [in_plane[0], in_plane[1], way * step],
        origin_ws,
        uneven,
    })
}

fn in_order(a: &Frame, b: &Frame) -> std::cmp::Ordering {
    a.order
        .iter()
        .zip(&b.order)
        .map(|(a, b)| a.total_cmp(b))
        .find(|o| o.is_ne())
        .unwrap_or(std::cmp::Ordering::Equal)
}

fn span(ascending: &[f64]) -> f64 {
    match (ascending.first(), ascending.last()) {
        (Some(first), Some(last)) => last - first,
        _ => 0.0,
    }
}

/// Whether not all frames are said to be at one place, as multi-frame objects without functional groups say.
fn spread(frames: &[Frame]) -> bool {
    let first = frames.first().and_then(|f| f.position);
    frames.iter().any(|f| {
        f.position
            .zip(first)
            .is_some_and(|(a, b)| a.distance(b) > SAME_PLACE)
    })
}

/// Millimetres between columns and between rows.
fn spacing(path: &Path, frames: &[Frame], options: &ReadOptions<'_>) -> Result<[f64; 2]> {
    let mut known = frames.iter().filter_map(|f| f.spacing);
    let Some(first) = known.next() else {
        guess(path, "PixelSpacing is missing; 1 mm is taken", options)?;
        return Ok([1.0, 1.0]);
    };
    let differs = |other: [f64; 2]| (0..2).any(|i| relative(first, other, i) > 1e-3);
    if let Some(other) = known.find(|&other| differs(other)) {
        return Err(bad(
            path,
            format!("PixelSpacing differs from slice to slice: {first:?} and {other:?}"),
        ));
    }
    Ok(first)
}

fn relative(a: [f64; 2], b: [f64; 2], i: usize) -> f64 {
    match (a.get(i), b.get(i)) {
        (Some(a), Some(b)) => (a - b).abs() / a,
        _ => f64::INFINITY,
    }
}

/// Something that the series does not say.
fn guess(path: &Path, what: &str, options: &ReadOptions<'_>) -> Result<()> {
    if options.strict {
        return Err(bad(path, format!("{what} unless volume.strict is set")));
    }
    tracing::warn!("{}: {what}", path.display());
    Ok(())
}

/// Frames that do not say where they are: in order of their numbers, along z.
fn unlocated(
    path: &Path,
    mut frames: Vec<Frame>,
    [dx, dy]: [f64; 2],
    options: &ReadOptions<'_>,
) -> Result<Stack> {
    guess(
        path,
        "the slices have no positions; they are taken in order of their numbers",
        options,
    )?;
    frames.sort_by(in_order);
    let first = frames.first();
    let [row, column] = first
        .and_then(|f| f.directions)
        .unwrap_or([DVec3::X, DVec3::Y]);
    let slice = match first.and_then(|f| f.slice_spacing) {
        Some(spacing) => spacing,
        None => {
            guess(
                path,
                "SpacingBetweenSlices is missing; 1 mm is taken",
                options,
            )?;
            1.0
        }
    };
    let origin_ws = first.and_then(|f| f.position).unwrap_or_default();
    Ok(Stack {
        frames,
        steps_ws: [row * dx, column * dy, row.cross(column).normalize() * slice],
        origin_ws,
        uneven: None,
    })
}

/// Keeps one frame of each place: the only one, or the one of the time step asked for.
fn one_at_each_place(
    path: &Path,
    frames: Vec<Frame>,
    place: impl Fn(&Frame) -> f64,
    options: &ReadOptions<'_>,
) -> Result<Vec<Frame>> {
    let mut places: Vec<Vec<Frame>> = Vec::new();
    for frame in frames {
        match places.last_mut() {
            Some(here)
                if here
                    .first()
                    .is_some_and(|f| (place(f) - place(&frame)).abs() < SAME_PLACE) =>
            {
                // The same object twice, in two folders.
                let known = here.iter().any(|f| {
                    f.instance_uid.is_some()
                        && f.instance_uid == frame.instance_uid
                        && f.index == frame.index
                });
                if !known {
                    here.push(frame);
                }
            }
            _ => places.push(vec![frame]),
        }
    }
    let times = places.iter().map(Vec::len).max().unwrap_or(0);
    let fewest = places.iter().map(Vec::len).min().unwrap_or(0);
    if times != fewest {
        return Err(bad(
            path,
            format!(
                "some places have {times} slices and some {fewest}: the series is incomplete, or mixes several"
            ),
        ));
    }
    let step = options.timestep.unwrap_or(0) as usize;
    if step >= times {
        return Err(bad(
            path,
            format!(
                "volume.timestep {step} is not there; valid are 0 to {}",
                times.saturating_sub(1)
            ),
        ));
    }
    if times > 1 && options.timestep.is_none() {
        tracing::info!("{times} time steps, the first is read; volume.timestep picks another");
    }
    Ok(places
        .into_iter()
        .filter_map(|mut here| {
            here.sort_by(in_order);
            here.into_iter().nth(step)
        })
        .collect())
}

/// The distance between slices; and, where they are uneven, the place of each in units of it.
fn slice_step(
    path: &Path,
    distances: &[f64],
    options: &ReadOptions<'_>,
) -> Result<(f64, Option<Vec<f64>>)> {
    let first = distances.first().copied().unwrap_or_default();
    let count = distances.len();
    let even = span(distances) / (count - 1) as f64;
    let off_grid = |step: f64| {
        distances
            .iter()
            .enumerate()
            .map(|(i, d)| ((d - first) / step - i as f64).abs())
            .fold(0.0, f64::max)
    };
    if off_grid(even) <= EVENNESS {
        return Ok((even, None));
    }
    let mut gaps: Vec<f64> = distances
        .iter()
        .zip(distances.iter().skip(1))
        .map(|(a, b)| b - a)
        .collect();
    gaps.sort_by(f64::total_cmp);
    let median = gaps.get(gaps.len() / 2).copied().unwrap_or(even);
    let largest = gaps.last().copied().unwrap_or(even);
    let smallest = gaps.first().copied().unwrap_or(even);
    let whole = gaps
        .iter()
        .all(|g| (g / median - (g / median).round()).abs() <= EVENNESS && g / median > 0.5);
    let places = (span(distances) / median).round() as usize + 1;
    let what = if whole && places > count {
        format!("{} of {places} slices are missing", places - count)
    } else {
        format!("the slices are {smallest:.4} to {largest:.4} mm apart")
    };
    if options.strict {
        return Err(bad(
            path,
            format!("{what}; volume.strict refuses to interpolate"),
        ));
    }
    tracing::warn!(
        "{}: {what}; interpolated onto steps of {median:.4} mm",
        path.display()
    );
    let positions = distances.iter().map(|d| (d - first) / median).collect();
    Ok((median, Some(positions)))
}

/// Refuses slices whose first pixels do not lie on one line: no grid holds them.
fn check_straight(
    path: &Path,
    frames: &[Frame],
    origin: DVec3,
    way: DVec3,
    place: impl Fn(&Frame) -> f64,
) -> Result<()> {
    let Some(first) = frames.first() else {
        return Ok(());
    };
    let allowed = first.spacing.map_or(1.0, |[x, y]| x.min(y)) * 0.1;
    for frame in frames {
        let on_line = origin + way * (place(frame) - place(first));
        let off = frame.position.unwrap_or_default().distance(on_line);
        if off > allowed {
            return Err(bad(
                path,
                format!(
                    "a slice lies {off:.4} mm beside the line of the others: they make no regular grid"
                ),
            ));
        }
    }
    Ok(())
}
