//! A plot of a transfer function: opacity over value, the colours below, a histogram behind.

use std::path::Path;

use embedded_graphics::mono_font::iso_8859_1::{FONT_6X12, FONT_9X15};
use embedded_graphics::text::Alignment;

use super::canvas::{Canvas, quantized};
use crate::error::Result;
use crate::scene::{ColorManagement, Curve};

const SIZE: [u32; 2] = [760, 460];
/// Left, top, right and bottom of the plot area.
const AREA: [i32; 4] = [56, 40, 740, 360];
/// Height of the colour ramp below it, and the gap between.
const RAMP: [i32; 2] = [30, 8];
const PAPER: [f64; 3] = [0.11, 0.12, 0.14];
const GRID: [f64; 3] = [0.20, 0.21, 0.24];
const BARS: [f64; 3] = [0.32, 0.36, 0.42];
const INK: [f64; 3] = [0.93, 0.94, 0.95];

/// Numbers of voxels in equal parts of a range of values.
#[derive(Clone, Copy, Debug)]
pub struct PlotHistogram<'a> {
    /// Lowest and highest value.
    pub range: [f64; 2],
    /// Counts, lowest values first; drawn on a logarithmic scale.
    pub counts: &'a [u64],
}

/// Draws `curve` as PNG: over the histogram's range, or else over that of its points.
///
/// # Errors
/// [`crate::Error::Io`], [`crate::Error::Encode`].
pub fn write_plot(
    path: &Path,
    title: &str,
    curve: &Curve,
    colors: ColorManagement,
    histogram: Option<PlotHistogram<'_>>,
) -> Result<()> {
    let [left, top, right, bottom] = AREA;
    let range = range(curve, histogram);
    let mut canvas = Canvas::new(SIZE, PAPER);
    canvas.text(title, [left, 26], (&FONT_9X15, Alignment::Left), INK);
    if let Some(histogram) = histogram {
        bars(&mut canvas, histogram, range);
    }
    for tenth in [0, 25, 50, 75, 100] {
        let y = bottom - (bottom - top) * tenth / 100;
        canvas.line([left, y], [right, y], 1, GRID);
        let label = format!("{}", f64::from(tenth) / 100.0);
        canvas.text(
            &label,
            [left - 6, y + 4],
            (&FONT_6X12, Alignment::Right),
            INK,
        );
    }
    let x_of = |value: f64| {
        let share = (value - range[0]) / (range[1] - range[0]);
        left + (share.clamp(-1.0, 2.0) * f64::from(right - left)).round() as i32
    };
    let y_of = |opacity: f64| bottom - (opacity * f64::from(bottom - top)).round() as i32;
    let ramp_top = bottom + RAMP[1];
    for x in left..=right {
        let value =
            range[0] + (range[1] - range[0]) * f64::from(x - left) / f64::from(right - left);
        let color = quantized(colors.encode(curve.evaluate(value).color));
        (ramp_top..ramp_top + RAMP[0]).for_each(|y| canvas.set([x, y], color));
    }
    for value in ticks(range) {
        let x = x_of(value);
        canvas.line([x, bottom], [x, bottom + 4], 1, INK);
        let at = [x, ramp_top + RAMP[0] + 16];
        canvas.text(&short(value), at, (&FONT_6X12, Alignment::Center), INK);
    }
    // Flat outside of its points.
    let places = || {
        curve
            .points
            .iter()
            .filter(|p| (range[0]..=range[1]).contains(&p.value))
    };
    let mut corners = vec![[left, y_of(curve.evaluate(range[0]).opacity)]];
    corners.extend(places().map(|p| [x_of(p.value), y_of(p.optical.opacity)]));
    corners.push([right, y_of(curve.evaluate(range[1]).opacity)]);
    for pair in corners.windows(2) {
        canvas.line(pair[0], pair[1], 2, INK);
    }
    for point in places() {
        let [x, y] = [x_of(point.value), y_of(point.optical.opacity)];
        let color = colors.encode(point.optical.color);
        canvas.fill([x - 4, y - 4], [9, 9], INK);
        canvas.fill([x - 3, y - 3], [7, 7], color);
    }
    let unit = format!("opacity over {} mm", short(curve.unit_distance));
    canvas.text(&unit, [right, 26], (&FONT_6X12, Alignment::Right), INK);
    canvas.write(path)
}

/// What the plot shows, never empty.
fn range(curve: &Curve, histogram: Option<PlotHistogram<'_>>) -> [f64; 2] {
    let ends = [curve.points.first(), curve.points.last()];
    let points = ends.map(|p| p.map_or(0.0, |p| p.value));
    let margin = 0.05 * (points[1] - points[0]);
    let [low, high] = match histogram {
        Some(histogram) => histogram.range,
        None => [points[0] - margin, points[1] + margin],
    };
    if high > low {
        [low, high]
    } else {
        [low - 1.0, low + 1.0]
    }
}

fn bars(canvas: &mut Canvas, histogram: PlotHistogram<'_>, range: [f64; 2]) {
    let [left, top, right, bottom] = AREA;
    let log = |count: u64| (count as f64 + 1.0).ln();
    let highest = histogram
        .counts
        .iter()
        .copied()
        .map(log)
        .fold(1.0, f64::max);
    let bins = histogram.counts.len().max(1) as f64;
    let [low, high] = histogram.range;
    let x_of = |bin: usize| {
        let value = low + (high - low) * bin as f64 / bins;
        let share = (value - range[0]) / (range[1] - range[0]);
        left + (share * f64::from(right - left)) as i32
    };
    for (bin, &count) in histogram.counts.iter().enumerate() {
        let height = (log(count) / highest * f64::from(bottom - top)) as i32;
        let (from, to) = (x_of(bin), x_of(bin + 1));
        let size = [(to - from).max(1), height].map(|n| n.max(0) as u32);
        canvas.fill([from, bottom - height], size, BARS);
    }
}

/// Round numbers inside a range, some six of them.
fn ticks([low, high]: [f64; 2]) -> Vec<f64> {
    let rough = (high - low) / 6.0;
    let decade = 10f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0]
        .map(|n| n * decade)
        .into_iter()
        .find(|step| *step >= rough)
        .unwrap_or(rough);
    let first = (low / step).ceil();
    (0..20)
        .map(|n| (first + f64::from(n)) * step)
        .take_while(|tick| *tick <= high)
        .collect()
}

/// A number in few letters.
fn short(value: f64) -> String {
    if value == 0.0 || (0.01..1e5).contains(&value.abs()) {
        format!("{}", (value * 1000.0).round() / 1000.0)
    } else {
        format!("{value:.2e}")
    }
}
