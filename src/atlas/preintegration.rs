//! Pre-integrated classification (Engel, Kraus and Ertl 2001): what the host prepares of the table that
//! `glsl/preintegrate.comp` computes.
//!
//! The table's axes have entries at fixed values: linear over the transfer function's range, and compressed beyond it, so that
//! segments that begin or end far outside are right too. Of each entry the shader needs the antiderivatives of extinction and of
//! extinction times colour up to its value; they are computed here in f64.

use super::SampleScale;
use super::transfer_table::best_cells;
use crate::scene::{Curve, Optical};

/// Cells that each compressed end of an axis takes.
const TAIL_CELLS: usize = 64;
/// Where the last entry lies, in ranges beyond the function's own.
const FAR: f64 = 1e4;
/// Most cells over the function's range. A table has 16 bytes an entry, and as many again with emission.
const MAX_CELLS: usize = 892;
/// Fewest cells over the function's range.
const MIN_CELLS: usize = 128;
/// Cells that the narrowest piece of a transfer function shall have at least, where a table allows it.
const CELLS_A_PIECE: f64 = 8.0;
/// Largest optical depth of a whole step: what is opaque is opaque over a ten thousandth of a step too.
const OPAQUE: f64 = 1e6;
/// Rows of [`Preintegration::texels`].
pub(crate) const ROWS: u32 = 6;

/// Entries of the table and what lies between them.
#[derive(Clone, Debug)]
pub(crate) struct Preintegration {
    curve: Curve,
    /// First and last value of the transfer function; the last is above the first.
    range: [f64; 2],
    /// Cells over that range.
    cells: usize,
    /// Number of intervals between entries, before each, in which something shows.
    shown_before: Vec<u32>,
}

impl Preintegration {
    pub(crate) fn new(curve: &Curve) -> Self {
        let values: Vec<f64> = curve.points.iter().map(|p| p.value).collect();
        let low = values.first().copied().unwrap_or(0.0);
        let high = values.last().copied().unwrap_or(0.0);
        // A single value has all the action at itself; any width around it will do.
        let width = if high > low {
            high - low
        } else {
            low.abs().max(1.0)
        };
        let narrowest = values
            .windows(2)
            .map(|v| v[1] - v[0])
            .filter(|&piece| piece > 0.0)
            .fold(width, f64::min);
        let fewest =
            ((CELLS_A_PIECE * width / narrowest).ceil() as usize).clamp(MIN_CELLS, MAX_CELLS);
        // Twice as many give room to align all control points.
        let most = (2 * fewest).min(MAX_CELLS);
        let cells = if high > low {
            best_cells(&values, fewest..=most)
        } else {
            MIN_CELLS
        };
        let mut table = Self {
            curve: curve.clone(),
            range: [low, low + width],
            cells,
            shown_before: Vec::new(),
        };
        let mut shown = vec![0];
        for entry in 1..table.count() {
            let shows = table.shows(table.value(entry - 1), table.value(entry));
            shown.push(shown[entry - 1] + u32::from(shows));
        }
        table.shown_before = shown;
        table
    }

    /// Entries on each axis.
    pub(crate) fn entries(&self) -> u32 {
        self.count() as u32
    }

    /// Cells from the transfer function's first value to its last.
    pub(crate) fn cells(&self) -> u32 {
        self.cells as u32
    }

    fn count(&self) -> usize {
        self.cells + 2 * TAIL_CELLS + 1
    }

    /// First value of the transfer function, and the distance to its last one (> 0).
    pub(crate) fn range(&self) -> (f64, f64) {
        (self.range[0], self.range[1] - self.range[0])
    }

    /// Value of an entry.
    fn value(&self, entry: usize) -> f64 {
        let (low, width) = self.range();
        low + width * self.place_in_range(entry)
    }

    /// Value of an entry, 0 at the function's first and 1 at its last.
    fn place_in_range(&self, entry: usize) -> f64 {
        let (cells, tail) = (self.cells as f64, TAIL_CELLS as f64);
        let x = entry as f64 - tail;
        let inside = x.clamp(0.0, cells);
        let compressed = ((x - inside).abs() / tail).min(1.0 - 1e-12);
        let beyond = tail * compressed / (1.0 - compressed) / cells;
        inside / cells + (x - inside).signum() * beyond.min(FAR)
    }

    /// The place of a value on an axis, in entries: the shaders' `table_place`.
    fn place(&self, value: f64) -> f64 {
        let (low, width) = self.range();
        let (cells, tail) = (self.cells as f64, TAIL_CELLS as f64);
        let t = (value - low) / width;
        let inside = t.clamp(0.0, 1.0);
        let beyond = (t - inside) * cells;
        inside * cells + beyond / (1.0 + beyond.abs() / tail) + tail
    }

    /// True when the function shows anything between two values, these included.
    fn shows(&self, from: f64, to: f64) -> bool {
        let at_ends = [
            self.curve.evaluate(from),
            self.curve.evaluate(to),
            self.curve.before(to),
        ];
        at_ends.iter().any(shows)
            || self
                .curve
                .points
                .iter()
                .any(|p| (from..=to).contains(&p.value) && shows(&p.optical))
    }

    /// True when a segment whose values lie in a range shows anything, read off the table between its entries. `margin`: what
    /// the device may miss a value by.
    pub(crate) fn visible(&self, range: [f64; 2], margin: f64) -> bool {
        let last = (self.count() - 1) as f64;
        // Entries are computed in 32 bits; a value on the function's first point is exact.
        let slack = |value: f64| {
            if value == self.range[0] && margin == 0.0 {
                0.0
            } else {
                2e-7 * last
            }
        };
        let low = self.place(range[0] - margin) - slack(range[0]);
        let high = self.place(range[1] + margin) + slack(range[1]);
        let first = low.floor().clamp(0.0, last - 1.0) as usize;
        let end = high.ceil().clamp(first as f64 + 1.0, last) as usize;
        if low == high && low == low.floor() {
            // One value, on an entry.
            return shows(&self.curve.evaluate(range[0]));
        }
        self.shown_before[end] > self.shown_before[first]
    }

    /// Rows of RGBA texels, one an entry: antiderivatives, from the first entry on, of extinction times colour (rgb) and of
    /// extinction (a), as the sum of two floats in two rows; of extinction times emission (rgb), and the entry's value (a),
    /// likewise; colour and extinction at the entry; emission at the entry.
    ///
    /// Extinctions are optical depths of a whole step, `step` unit distances long; values are in ranges of the function.
    pub(crate) fn texels(&self, step: f64) -> Vec<[f32; 4]> {
        let mut texels = vec![[0.0f32; 4]; ROWS as usize * self.count()];
        let mut sums = Integrals::default();
        for entry in 0..self.count() {
            if entry > 0 {
                self.integrate(entry, step, &mut sums);
            }
            let here = self.curve.evaluate(self.value(entry));
            let [kr, kg, kb] = sums.color;
            let [er, eg, eb] = sums.emission;
            let pairs = [
                [kr, kg, kb, sums.extinction],
                [er, eg, eb, self.place_in_range(entry)],
            ];
            let mut put = |row: usize, texel: [f32; 4]| texels[row * self.count() + entry] = texel;
            for (row, values) in pairs.into_iter().enumerate() {
                put(2 * row, values.map(|v| v as f32));
                put(
                    2 * row + 1,
                    values.map(|v| (v - f64::from(v as f32)) as f32),
                );
            }
            let [r, g, b] = here.color.map(|c| c as f32);
            put(4, [r, g, b, depth(here.opacity, step) as f32]);
            let [r, g, b] = here.emission.map(|c| c as f32);
            put(5, [r, g, b, 0.0]);
        }
        texels
    }

    /// Adds what lies between the entry before and this one.
    fn integrate(&self, entry: usize, step: f64, sums: &mut Integrals) {
        let (from, to) = (self.value(entry - 1), self.value(entry));
        let (_, width) = self.range();
        let mut start = from;
        let inside = |p: &&crate::scene::CurvePoint| p.value > from && p.value < to;
        let ends = self.curve.points.iter().filter(inside).map(|p| p.value);
        for end in ends.chain([to]) {
            if end > start {
                let (a, b) = (self.curve.evaluate(start), self.curve.before(end));
                sums.add_piece(&a, &b, (end - start) / width, step);
            }
            start = end;
        }
    }
}

fn shows(o: &Optical) -> bool {
    o.opacity > 0.0
}

/// Optical depth of a whole step.
fn depth(opacity: f64, step: f64) -> f64 {
    (-(-opacity).ln_1p() * step).min(OPAQUE)
}

#[derive(Clone, Copy, Default)]
struct Integrals {
    extinction: f64,
    color: [f64; 3],
    emission: [f64; 3],
}

/// Abscissae in [0, 1] and weights of Gauss-Legendre quadrature, exact to degree 7.
const GAUSS: [(f64, f64); 4] = [
    (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
    (0.330_009_478_207_571_87, 0.326_072_577_431_273_07),
    (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
    (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
];

impl Integrals {
    /// Adds a piece over which colour, emission and opacity are linear.
    fn add_piece(&mut self, a: &Optical, b: &Optical, length: f64, step: f64) {
        let extinction = length * mean_depth(a.opacity, b.opacity, step);
        if extinction <= 0.0 {
            return;
        }
        self.extinction += extinction;
        // The mean colour, weighted by extinction: exact for pieces of one colour.
        let mix = |a: f64, b: f64, f: f64| a + (b - a) * f;
        let mut total = 0.0;
        let (mut color, mut emission) = ([0.0; 3], [0.0; 3]);
        for (f, weight) in GAUSS {
            let weight = weight * depth(mix(a.opacity, b.opacity, f), step);
            total += weight;
            for c in 0..3 {
                color[c] += weight * mix(a.color[c], b.color[c], f);
                emission[c] += weight * mix(a.emission[c], b.emission[c], f);
            }
        }
        for c in 0..3 {
            self.color[c] += extinction * color[c] / total;
            self.emission[c] += extinction * emission[c] / total;
        }
    }
}

/// Mean of `-step ln(1 - o)` for opacities that run linearly from `a` to `b`.
fn mean_depth(a: f64, b: f64, step: f64) -> f64 {
    let antiderivative = |w: f64| if w > 0.0 { w * w.ln() - w } else { 0.0 };
    let rise = b - a;
    // The quotient cancels where the ends are close, and where both are small; quadrature is exact enough there.
    let mean = if rise.abs() < 0.05 && a.max(b) < 0.9 {
        GAUSS
            .iter()
            .map(|&(f, weight)| weight * -(-(a + rise * f)).ln_1p())
            .sum()
    } else if rise == 0.0 {
        -(-a).ln_1p()
    } else {
        (antiderivative(1.0 - b) - antiderivative(1.0 - a)) / rise
    };
    (mean * step).min(OPAQUE)
}

impl Preintegration {
    /// Factor and first sample of `table_place`: from texture samples to the function's range.
    pub(crate) fn range_from_sample(&self, samples: SampleScale) -> (f64, f64) {
        let (low, width) = self.range();
        (samples.scale / width, samples.sample(low))
    }
}
