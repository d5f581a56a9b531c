//! Pre-integrated classification (Engel, Kraus and Ertl 2001): what the host prepares of the table that
//! `glsl/preintegrate.comp` computes.
//!
//! The table's axes have entries at chosen values: at every control point of the transfer function (twice where it jumps), close
//! together near them and wider between, and compressed beyond the function's range, so that segments that begin or end far
//! outside are right too. Of each entry the shader needs the antiderivatives of extinction and of extinction times colour up to its value;
//! they are computed here in f64.

use crate::scene::{Curve, CurvePoint, Optical};

/// Cells that each compressed end of an axis takes.
const TAIL_CELLS: usize = 64;
/// Where the last entry lies, in bins of the transfer table beyond the function's range.
const FAR: f64 = 1e7;
/// Most cells over the function's range. A table has 16 bytes an entry, and as many again with emission.
const MAX_CELLS: usize = 892;
/// Fewest cells over the function's range, given as many bins.
const MIN_CELLS: usize = 256;
/// Cells of a piece between control points, where the table has room for them and the piece has as many bins. Pieces that show
/// nothing need as many as others: what a segment shows depends on how far it reaches into them.
const CELLS_A_PIECE: usize = 64;
/// Largest optical depth of a whole step: what is opaque is opaque over a ten thousandth of a step too.
const OPAQUE: f64 = 1e6;
/// Rows of [`Preintegration::texels`].
pub(crate) const ROWS: u32 = 6;

/// Entries of the table and what lies between them.
#[derive(Clone, Debug)]
pub(crate) struct Preintegration {
    curve: Curve,
    /// Value of the first control point, and width of a bin of the transfer table.
    first: f64,
    width: f64,
    entries: Vec<Entry>,
    /// By bin of the transfer table inside the function's range: places of its start and end.
    places: Vec<[f32; 2]>,
    /// Place of the last control point.
    end: usize,
    /// Cells a bin, beyond the function's range.
    tail: f64,
    /// Number of intervals between entries, before each, in which something shows.
    shown_before: Vec<u32>,
}

/// A value that the table has an entry for.
#[derive(Clone, Copy, Debug)]
struct Entry {
    value: f64,
    /// The function just below the value, where it jumps; the next entry is then the one just above.
    below: bool,
}

/// A piece between neighbouring control points: its bins, and the cells it is given.
struct Piece {
    bins: [usize; 2],
    /// Value of the control point at its end.
    end: f64,
    cells: usize,
}

impl Piece {
    /// Borders of its cells, in bins: close together at both ends, where control points make the table bend.
    fn borders(&self) -> Vec<usize> {
        let [from, to] = self.bins;
        let (bins, cells) = (to - from, self.cells);
        let mut borders = vec![from];
        for cell in 1..=cells {
            let u = cell as f64 / cells as f64;
            let ideal = from + (bins as f64 * u * u * (3.0 - 2.0 * u)).round() as usize;
            // Every cell has a bin at least, those still to come included.
            let least = borders[cell - 1] + 1;
            borders.push(ideal.clamp(least, to - (cells - cell)));
        }
        borders
    }
}

impl Preintegration {
    /// `first`, `width` and `bins`: the transfer table's bins over the function's range; none where it has a single value.
    pub(crate) fn new(curve: &Curve, first: f64, width: f64, bins: usize) -> Self {
        let pieces = pieces(curve, first, width, bins);
        let borders: Vec<Vec<usize>> = pieces.iter().map(Piece::borders).collect();
        // The ends go on as finely as the range ends.
        let finest = borders
            .iter()
            .flat_map(|b| [b[1] - b[0], b[b.len() - 1] - b[b.len() - 2]]);
        let tail = finest
            .min()
            .map_or(MIN_CELLS as f64, |bins| 1.0 / bins as f64);
        // Of an entry of an end, by its distance from the range.
        let beyond = |cell: usize| {
            let share = (cell as f64 / TAIL_CELLS as f64).min(1.0 - 1e-12);
            width * (TAIL_CELLS as f64 * share / (1.0 - share) / tail).min(FAR)
        };
        let plain = |value| Entry {
            value,
            below: false,
        };
        let mut entries: Vec<Entry> = (1..=TAIL_CELLS)
            .rev()
            .map(|cell| plain(first - beyond(cell)))
            .collect();
        push_control_point(&mut entries, curve, first);
        let mut places = Vec::with_capacity(bins);
        for (piece, borders) in pieces.iter().zip(&borders) {
            for ends in borders.windows(2) {
                let start = entries.len() as f32 - 1.0;
                let share = |bin: usize| (bin - ends[0]) as f32 / (ends[1] - ends[0]) as f32;
                places.extend((ends[0]..ends[1]).map(|b| [start + share(b), start + share(b + 1)]));
                if ends[1] == piece.bins[1] {
                    push_control_point(&mut entries, curve, piece.end);
                } else {
                    entries.push(plain(first + width * ends[1] as f64));
                }
            }
        }
        let end = entries.len() - 1;
        let last = entries[end].value;
        entries.extend((1..=TAIL_CELLS).map(|cell| plain(last + beyond(cell))));
        let mut shown_before = vec![0];
        for pair in entries.windows(2) {
            let before = shown_before.last().copied().unwrap_or(0);
            shown_before.push(before + u32::from(shows_between(curve, pair[0], pair[1])));
        }
        Self {
            curve: curve.clone(),
            first,
            width,
            entries,
            places,
            end,
            tail,
            shown_before,
        }
    }

    /// Entries on each axis.
    pub(crate) fn entries(&self) -> u32 {
        self.entries.len() as u32
    }

    /// By bin of the transfer table inside the function's range: places of its start and end on an axis.
    pub(crate) fn places(&self) -> &[[f32; 2]] {
        &self.places
    }

    /// Place of the last control point, and cells a bin beyond the function's range.
    pub(crate) fn ends(&self) -> (f64, f64) {
        (self.end as f64, self.tail)
    }

    /// The place of a value on an axis, in entries: the shaders' `table_place`.
    fn place(&self, value: f64) -> f64 {
        let x = (value - self.first) / self.width;
        let inner = self.places.len() as f64;
        let inside = x.clamp(0.0, inner);
        let beyond = (x - inside) * self.tail;
        let place = if x < 0.0 {
            TAIL_CELLS as f64
        } else if x >= inner {
            self.end as f64
        } else {
            let [start, end] = self.places[inside as usize].map(f64::from);
            start + (end - start) * inside.fract()
        };
        place + beyond / (1.0 + beyond.abs() / TAIL_CELLS as f64)
    }

    /// True when a segment whose values lie in a range shows anything, read off the table between its entries. `margin`: what
    /// the device may miss a value by.
    pub(crate) fn visible(&self, range: [f64; 2], margin: f64) -> bool {
        let last = (self.entries.len() - 1) as f64;
        // Places are computed in 32 bits; that of the first control point is exact.
        let slack = |value: f64| {
            if value == self.first && margin == 0.0 {
                0.0
            } else {
                4e-7 * last
            }
        };
        let low = self.place(range[0] - margin) - slack(range[0]);
        let high = self.place(range[1] + margin) + slack(range[1]);
        if low == high && low.fract() == 0.0 {
            return shows(&self.curve.evaluate(range[0]));
        }
        let first = low.floor().clamp(0.0, last - 1.0) as usize;
        let end = high.ceil().clamp(first as f64 + 1.0, last) as usize;
        self.shown_before[end] > self.shown_before[first]
    }

    /// Rows of RGBA texels, one an entry: antiderivatives, from the first control point on, of extinction times colour (rgb) and of
    /// extinction (a), as the sum of two floats in two rows; of extinction times emission (rgb), and the entry's value (a),
    /// likewise; colour and extinction at the entry; emission at the entry.
    ///
    /// Extinctions are optical depths of a whole step, `step` unit distances long; values are in bins of the transfer table.
    pub(crate) fn texels(&self, step: f64) -> Vec<[f32; 4]> {
        let count = self.entries.len();
        let mut texels = vec![[0.0f32; 4]; ROWS as usize * count];
        for (at, (entry, sums)) in self.entries.iter().zip(self.integrals(step)).enumerate() {
            let here = if entry.below {
                self.curve.before(entry.value)
            } else {
                self.curve.evaluate(entry.value)
            };
            let [kr, kg, kb] = sums.color;
            let [er, eg, eb] = sums.emission;
            let pairs = [
                [kr, kg, kb, sums.extinction],
                [er, eg, eb, (entry.value - self.first) / self.width],
            ];
            let mut put = |row: usize, texel: [f32; 4]| texels[row * count + at] = texel;
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

    /// Integrals from the first control point to every entry: what lies far beyond must not drown what is near.
    fn integrals(&self, step: f64) -> Vec<Integrals> {
        let mut sums = vec![Integrals::default(); self.entries.len()];
        for at in TAIL_CELLS + 1..self.entries.len() {
            let mut sum = sums[at - 1];
            let [from, to] = [at - 1, at].map(|e| self.entries[e].value);
            self.integrate(from, to, step, &mut sum);
            sums[at] = sum;
        }
        for at in (0..TAIL_CELLS).rev() {
            // Backwards: the sum of what lies between, negative.
            let mut sum = sums[at + 1].negative();
            let [from, to] = [at, at + 1].map(|e| self.entries[e].value);
            self.integrate(from, to, step, &mut sum);
            sums[at] = sum.negative();
        }
        sums
    }

    /// Adds what lies between two values.
    fn integrate(&self, from: f64, to: f64, step: f64, sums: &mut Integrals) {
        let mut start = from;
        let inside = |p: &&CurvePoint| p.value > from && p.value < to;
        let ends = self.curve.points.iter().filter(inside).map(|p| p.value);
        for end in ends.chain([to]) {
            if end > start {
                let (a, b) = (self.curve.evaluate(start), self.curve.before(end));
                sums.add_piece(&a, &b, (end - start) / self.width, step);
            }
            start = end;
        }
    }
}

/// Divides the cells among the pieces of a transfer function.
fn pieces(curve: &Curve, first: f64, width: f64, bins: usize) -> Vec<Piece> {
    let mut pieces: Vec<Piece> = Vec::new();
    let mut start = 0;
    for point in &curve.points {
        let bin = (((point.value - first) / width).round() as usize).min(bins);
        if bin > start {
            pieces.push(Piece {
                bins: [start, bin],
                end: point.value,
                cells: CELLS_A_PIECE.min(bin - start),
            });
            start = bin;
        }
    }
    let total: usize = pieces.iter().map(|p| p.cells).sum();
    let wanted = total.clamp(MIN_CELLS, MAX_CELLS) as f64;
    for piece in &mut pieces {
        let cells = (piece.cells as f64 * wanted / total as f64) as usize;
        piece.cells = cells.clamp(1, piece.bins[1] - piece.bins[0]);
    }
    pieces
}

fn push_control_point(entries: &mut Vec<Entry>, curve: &Curve, value: f64) {
    if curve.before(value) != curve.evaluate(value) {
        entries.push(Entry { value, below: true });
    }
    entries.push(Entry {
        value,
        below: false,
    });
}

/// True when the function shows anything between two entries, these included.
fn shows_between(curve: &Curve, from: Entry, to: Entry) -> bool {
    let inside = |p: &&CurvePoint| p.value > from.value && p.value < to.value;
    shows(&curve.evaluate(from.value))
        || shows(&curve.before(to.value))
        || curve
            .points
            .iter()
            .filter(inside)
            .any(|p| shows(&p.optical))
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
    fn negative(self) -> Self {
        Self {
            extinction: -self.extinction,
            color: self.color.map(|c| -c),
            emission: self.emission.map(|e| -e),
        }
    }

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

#[cfg(test)]
mod tests {
    use super::{Entry, Preintegration};
    use crate::scene::{ColorManagement, ControlPoint, Curve};

    /// Thin tents and a jump.
    fn curve() -> Curve {
        let point = |value, opacity| ControlPoint {
            value,
            color: [1.0, 0.5, value],
            opacity,
            emission: [0.0; 3],
            source: [0.0; 3],
        };
        let points = [
            (0.2, 0.0),
            (0.21, 0.8),
            (0.22, 0.0),
            (0.5, 0.0),
            (0.52, 0.6),
            (0.54, 0.0),
            (0.7, 0.0),
            (0.7, 0.5),
            (0.9, 0.9),
        ];
        let points: Vec<_> = points.iter().map(|&(v, o)| point(v, o)).collect();
        Curve::new(1.0, &points, ColorManagement::None)
    }

    fn table() -> Preintegration {
        Preintegration::new(&curve(), 0.2, 0.7 / 3500.0, 3500)
    }

    #[test]
    fn entries_ascend_and_places_are_theirs() {
        let table = table();
        for pair in table.entries.windows(2) {
            let twins = pair[0].below && pair[0].value == pair[1].value;
            assert!(twins || pair[0].value < pair[1].value, "{pair:?}");
        }
        for (at, entry) in table.entries.iter().enumerate().skip(1) {
            // The side below a jump is approached, never reached.
            let Entry { value, below } = *entry;
            let place = table.place(if below { value - 1e-9 } else { value });
            let far = at + 2 > table.entries.len();
            assert!(
                far || (place - at as f64).abs() < 1e-2,
                "{entry:?}: {place}, not {at}"
            );
        }
    }

    #[test]
    fn what_an_interpolated_entry_shows_is_visible() {
        let table = table();
        let texels = table.texels(1.0);
        let count = table.entries.len();
        let integral = |at: usize| f64::from(texels[at][3]) + f64::from(texels[count + at][3]);
        let mut hidden = 0;
        for low in 0..300 {
            for length in [0.0, 1e-4, 0.003, 0.02, 0.3] {
                let from = 0.1 + f64::from(low) * 0.003;
                let to = from + length;
                let first = table.place(from).floor() as usize;
                let end = (table.place(to).ceil() as usize).max(first + 1);
                let shows = integral(end) > integral(first);
                let visible = table.visible([from, to], 1e-7);
                assert!(visible || !shows, "[{from}, {to}]");
                hidden += usize::from(!visible);
            }
        }
        assert!(
            hidden > 200,
            "{hidden} ranges are hidden: the test sees both"
        );
    }
}
