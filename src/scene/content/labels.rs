//! Telling label maps from images.

use std::collections::BTreeMap;

use rayon::prelude::*;

use crate::volume::{Volume, Voxels};

/// Neighbours that are compared, about.
const PAIRS: usize = 1 << 22;
/// Share of neighbours, not both background, that are equal in a label map.
const MIN_EQUAL: f64 = 0.6;
/// So few values are labels whatever their steps; grey values are more.
const FEW: usize = 12;
/// Mean step between unequal neighbours, in ranks of the values: smooth fields go from one value to the next.
const MIN_STEP: f64 = 1.6;

/// Every value and the number of voxels that have it, ascending.
pub(in crate::scene) fn label_values(volume: &Volume) -> Vec<(f64, u64)> {
    let counts = match volume.voxels() {
        Voxels::U8(v) => count(v, |v| v.into()),
        Voxels::I8(v) => count(v, |v| v.into()),
        Voxels::U16(v) => count(v, |v| v.into()),
        Voxels::I16(v) => count(v, |v| v.into()),
        Voxels::F32(v) => count(v, |v| v as i32),
    };
    let values = counts
        .into_iter()
        .map(|(stored, n)| (volume.value_from_stored(stored.into()), n));
    let mut values: Vec<(f64, u64)> = values.collect();
    values.sort_by(|a, b| a.0.total_cmp(&b.0));
    values
}

fn count<T: Copy + Sync>(voxels: &[T], of: impl Fn(T) -> i32 + Sync) -> BTreeMap<i32, u64> {
    let parts = voxels.par_chunks(1 << 20).map(|chunk| {
        let mut counts = BTreeMap::new();
        // Labels come in runs: a look-up a run.
        for run in chunk.chunk_by(|&a, &b| of(a) == of(b)) {
            if let Some(&first) = run.first() {
                *counts.entry(of(first)).or_insert(0) += run.len() as u64;
            }
        }
        counts
    });
    parts.reduce(BTreeMap::new, |mut sum, part| {
        for (value, n) in part {
            *sum.entry(value).or_insert(0) += n;
        }
        sum
    })
}

/// The reason to take a volume for a label map, if there is one: whole numbers from 0, equal to their neighbours
/// nearly everywhere, with jumps between.
pub(super) fn reason(volume: &Volume) -> Option<String> {
    let [lowest, highest] = volume.value_range();
    if lowest < 0.0 || highest > f64::from(u16::MAX) || lowest == highest {
        return None;
    }
    let pairs = Pairs::of(volume)?;
    let distinct = pairs.ranks.len();
    let equal = pairs.equal as f64 / (pairs.equal + pairs.unequal).max(1) as f64;
    let step = pairs.steps as f64 / pairs.unequal.max(1) as f64;
    let is_label_map = equal >= MIN_EQUAL && (distinct <= FEW || step >= MIN_STEP);
    is_label_map.then(|| {
        format!(
            "{distinct} whole values, equal to {:.0} % of their neighbours outside of the background",
            100.0 * equal
        )
    })
}

/// What neighbours on the x axis have in common.
struct Pairs {
    /// Values seen.
    ranks: BTreeMap<i32, usize>,
    equal: u64,
    unequal: u64,
    /// Sum of the differences in rank.
    steps: u64,
}

impl Pairs {
    /// `None` when some value is not whole.
    fn of(volume: &Volume) -> Option<Self> {
        let row = volume.size()[0] as usize;
        let rows = volume.voxels().len() / row;
        let stride = (volume.voxels().len() / PAIRS).max(1);
        let mut pairs: BTreeMap<[i32; 2], u64> = BTreeMap::new();
        for first in (0..rows).step_by(stride).map(|r| r * row) {
            let mut before = whole(volume, first)?;
            for at in first + 1..first + row {
                let value = whole(volume, at)?;
                *pairs.entry([before, value]).or_insert(0) += 1;
                before = value;
            }
            // Grey values soon make more kinds of pairs than labels ever do.
            if pairs.len() > 1 << 17 {
                return None;
            }
        }
        let background = pairs
            .iter()
            .filter(|([a, b], _)| a == b)
            .max_by_key(|(_, n)| **n)
            .map(|([a, _], _)| *a);
        let mut values: Vec<i32> = pairs.keys().flatten().copied().collect();
        values.sort_unstable();
        values.dedup();
        let ranks: BTreeMap<i32, usize> = values.into_iter().zip(0..).collect();
        let mut sums = Self {
            ranks,
            equal: 0,
            unequal: 0,
            steps: 0,
        };
        for ([a, b], n) in pairs {
            if a != b {
                sums.unequal += n;
                sums.steps += n * sums.ranks[&a].abs_diff(sums.ranks[&b]) as u64;
            } else if Some(a) != background {
                sums.equal += n;
            }
        }
        Some(sums)
    }
}

/// A value that is a whole number.
fn whole(volume: &Volume, at: usize) -> Option<i32> {
    let value = volume.value_from_stored(volume.voxels().get(at));
    (value.fract() == 0.0).then_some(value as i32)
}
