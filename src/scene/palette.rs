//! Colours along a scale from 0 to 1.

/// Display colours at ascending places from 0 to 1.
pub(super) struct Palette(&'static [(f64, [f64; 3])]);

/// Dark red tissue to ivory.
pub(super) const TISSUE: Palette = Palette(&[
    (0.00, [0.70, 0.45, 0.32]),
    (0.25, [0.80, 0.58, 0.42]),
    (0.55, [0.90, 0.74, 0.57]),
    (0.80, [0.96, 0.86, 0.72]),
    (1.00, [1.0, 0.98, 0.93]),
]);

impl Palette {
    /// The colour at a place; the ends hold outside.
    pub(super) fn at(&self, place: f64) -> [f64; 3] {
        let above = self.0.partition_point(|&(at, _)| at <= place);
        let Some(&(to, high)) = self.0.get(above) else {
            return self.0.last().map_or([1.0; 3], |&(_, color)| color);
        };
        let Some(&(from, low)) = above.checked_sub(1).and_then(|i| self.0.get(i)) else {
            return high;
        };
        let share = (place - from) / (to - from);
        std::array::from_fn(|c| low[c] + (high[c] - low[c]) * share)
    }
}

/// The colour of a segment: hues a golden angle apart, so that neighbours in value differ.
pub(super) fn of_label(label: u64) -> [f64; 3] {
    const GOLDEN: f64 = 0.618_033_988_749_895;
    let hue = (label as f64 * GOLDEN).fract();
    let saturation = [0.62, 0.82, 0.48][(label % 3) as usize];
    let value = [0.95, 0.80][(label / 3 % 2) as usize];
    // Smith 1978, Color gamut transform pairs: the hexcone's distance of each channel from its hue.
    [5.0, 3.0, 1.0].map(|n: f64| {
        let k = (n + hue * 6.0) % 6.0;
        value - value * saturation * k.min(4.0 - k).clamp(0.0, 1.0)
    })
}
