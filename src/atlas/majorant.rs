//! Largest extinction of every skip cell: what null-collision tracking goes by.

use super::{Residency, TransferTable, Visibility};
use crate::scene::Interpolation;
use crate::volume::cells::CellGrid;

/// Most optical depth of a sample: the shaders' `LARGEST_DEPTH`.
const LARGEST_DEPTH: f64 = 1e4;
/// What the device's extinction, computed in 32 bits, may exceed ours by.
const ROUNDING: f64 = 1.001;

/// Extinctions per mm.
pub(crate) struct Majorants {
    /// By skip cell.
    pub(crate) cells: Vec<f32>,
    /// The largest of them.
    pub(crate) global: f32,
}

impl Majorants {
    /// `sample_mm`: length of a whole sample of the table.
    pub(crate) fn new(
        residency: &Residency,
        interpolation: Interpolation,
        table: &TransferTable,
        sample_mm: f64,
    ) -> Self {
        let largest = LargestOpacity::new(table.largest_by_bin());
        let unit_mm = table.unit_mm();
        let extinction = |range: [f64; 2]| {
            let opacity = largest.in_bins(table.bins_of(range));
            let exact = -f64::ln_1p(-opacity) / unit_mm;
            (exact.min(LARGEST_DEPTH / sample_mm) * ROUNDING) as f32
        };
        let of = |cells: &CellGrid| -> Vec<f32> {
            (0..cells.len())
                .map(|cell| cells.value_range(cell).map_or(0.0, extinction))
                .collect()
        };
        let cells = match Visibility::reach(residency, interpolation) {
            None => of(&residency.cells),
            Some(reach) => of(&residency.cells.widened(reach)),
        };
        let global = cells.iter().copied().fold(0.0, f32::max);
        Self { cells, global }
    }
}

/// Largest opacities of runs of bins, by powers of two: any run is the union of two of them.
struct LargestOpacity {
    by_power: Vec<Vec<f64>>,
}

impl LargestOpacity {
    fn new(bins: Vec<f64>) -> Self {
        let mut by_power = vec![bins];
        let mut length = 1;
        while let Some(runs) = by_power.last().filter(|runs| runs.len() > length) {
            let next = runs.iter().zip(&runs[length..]);
            let next = next.map(|(a, b)| a.max(*b)).collect();
            by_power.push(next);
            length *= 2;
        }
        Self { by_power }
    }

    /// Both ends included.
    fn in_bins(&self, [first, last]: [usize; 2]) -> f64 {
        let count = last.saturating_sub(first) + 1;
        let power = count.ilog2() as usize;
        let Some(runs) = self.by_power.get(power) else {
            return 1.0;
        };
        let at = |bin: usize| runs.get(bin).copied().unwrap_or(1.0);
        at(first).max(at(last + 1 - (1 << power)))
    }
}

#[cfg(test)]
mod tests {
    use super::LargestOpacity;

    #[test]
    fn runs_have_their_largest() {
        let bins: Vec<f64> = (0..37).map(|i| f64::from(i * 17 % 37) / 37.0).collect();
        let largest = LargestOpacity::new(bins.clone());
        for first in 0..37 {
            for last in first..37 {
                let expected = bins[first..=last].iter().copied().fold(0.0, f64::max);
                assert_eq!(largest.in_bins([first, last]), expected, "{first}..={last}");
            }
        }
    }
}
