//! Telling label maps from images.

use std::collections::{BTreeMap, HashMap};

use rayon::prelude::*;

use crate::volume::{Volume, Voxel, VoxelType, Voxels, with_typed};

/// Neighbours that are compared, about.
const PAIRS: usize = 1 << 22;
/// Integers of which all pairs have a place in a table: at most so many.
const TABLE_VALUES: usize = 512;
/// Grey values soon make more kinds of pairs than labels ever do.
const MAX_KINDS: usize = 1 << 17;
/// Share of neighbours, not both background, that are equal in a label map.
const MIN_EQUAL: f64 = 0.6;
/// So few values are labels whatever their steps; grey values are more.
const FEW: usize = 12;
/// Mean step between unequal neighbours, in ranks of the values: smooth fields go from one value to the next.
const MIN_STEP: f64 = 1.6;

/// Every value and the number of voxels that have it, ascending; real numbers are cut to whole ones.
pub(in crate::scene) fn label_values(volume: &Volume) -> Vec<(f64, u64)> {
    let mut values: Vec<(f64, u64)> = match volume.voxels() {
        Voxels::F32(voxels) => whole_counts(voxels)
            .into_iter()
            .map(|(stored, n)| (volume.value_from_stored(stored.into()), n))
            .collect(),
        _ => volume.value_counts().filter(|&(_, n)| n > 0).collect(),
    };
    values.sort_by(|a, b| a.0.total_cmp(&b.0));
    values
}

fn whole_counts(voxels: &[f32]) -> BTreeMap<i32, u64> {
    let parts = voxels.par_chunks(1 << 20).map(|chunk| {
        let mut counts = BTreeMap::new();
        // Labels come in runs: a look-up a run.
        for run in chunk.chunk_by(|&a, &b| a as i32 == b as i32) {
            if let Some(&first) = run.first() {
                *counts.entry(first as i32).or_insert(0) += run.len() as u64;
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
    /// `None` when some value is not whole, and of values that are no labels anyway.
    fn of(volume: &Volume) -> Option<Self> {
        let pairs = with_typed!(volume.voxels(), voxels => counted(volume, voxels))?;
        let background = pairs
            .iter()
            .filter(|([a, b], _)| a == b)
            .max_by_key(|(_, n)| *n)
            .map(|([a, _], _)| *a);
        let mut values: Vec<i32> = pairs.iter().flat_map(|(pair, _)| *pair).collect();
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

/// Pairs of neighbours by their values, ascending, and how many there are of each.
fn counted<V: Voxel>(volume: &Volume, voxels: &[V]) -> Option<Vec<([i32; 2], u64)>> {
    let row = volume.size()[0] as usize;
    let rows = voxels.chunks_exact(row);
    let rows: Vec<&[V]> = rows.step_by((voxels.len() / PAIRS).max(1)).collect();
    let [first, last] = volume.stored_range();
    // Of real numbers it may be any number, and says nothing.
    let values = ((last - first) as usize).saturating_add(1);
    let whole = |stored: f64| {
        let value = volume.value_from_stored(stored);
        (value.fract() == 0.0).then_some(value as i32)
    };
    let is_real = volume.voxels().voxel_type() == VoxelType::F32;
    let mut pairs = if is_real || values > TABLE_VALUES {
        by_hash(&rows, |v| whole(v.to_f32().into()))?
    } else {
        let table = by_table(&rows, first as i32, values);
        let value = |at: usize| whole(first + at as f64);
        let there = table.into_iter().enumerate().filter(|&(_, n)| n > 0);
        there
            .map(|(at, n)| Some(([value(at / values)?, value(at % values)?], n.into())))
            .collect::<Option<Vec<_>>>()?
    };
    pairs.sort_unstable_by_key(|&(pair, _)| pair);
    (pairs.len() <= MAX_KINDS).then_some(pairs)
}

/// Pairs of so many integers from `first` on: by the first of them, then by the second.
fn by_table<V: Voxel>(rows: &[&[V]], first: i32, values: usize) -> Vec<u32> {
    let place = |v: V| (v.to_f32() as i32 - first) as usize;
    let add = |mut table: Vec<u32>, row: &&[V]| {
        for pair in row.windows(2) {
            table[place(pair[0]) * values + place(pair[1])] += 1;
        }
        table
    };
    let empty = || vec![0; values * values];
    rows.par_iter()
        .with_min_len(rows.len() / 16 + 1)
        .fold(empty, add)
        .reduce(empty, |mut sum, part| {
            sum.iter_mut().zip(part).for_each(|(s, p)| *s += p);
            sum
        })
}

/// `None` when some value is not whole, or there are too many kinds of pairs.
fn by_hash<V: Voxel>(
    rows: &[&[V]],
    whole: impl Fn(V) -> Option<i32>,
) -> Option<Vec<([i32; 2], u64)>> {
    let mut pairs: HashMap<[i32; 2], u64> = HashMap::new();
    for row in rows {
        let mut values = row.iter().map(|&v| whole(v));
        let mut before = values.next()??;
        // Pairs come in runs, too.
        let mut run = ([before; 2], 0);
        for value in values {
            let pair = [before, value?];
            before = pair[1];
            if pair != run.0 && run.1 > 0 {
                *pairs.entry(run.0).or_insert(0) += run.1;
                run.1 = 0;
            }
            run = (pair, run.1 + 1);
        }
        *pairs.entry(run.0).or_insert(0) += run.1;
        if pairs.len() > MAX_KINDS {
            return None;
        }
    }
    Some(pairs.into_iter().collect())
}

#[cfg(test)]
mod tests {
    use super::counted;
    use crate::volume::{Volume, Voxels};

    #[test]
    fn pairs_are_the_same_by_table_and_by_hash() {
        let size = [30, 6, 5];
        let values = (0..30 * 6 * 5).map(|i: u32| if i % 7 < 4 { 0 } else { i * i % 11 });
        let integers: Vec<u16> = values.map(|v| v as u16).collect();
        let volume = |voxels| Volume::axis_aligned(voxels, size, [1.0; 3]).unwrap();
        // Too many values for a table: the pair of the largest one with itself comes on top.
        let mut wide = integers.clone();
        wide[..30].fill(600);
        let mut narrow = integers;
        narrow[..30].fill(60);
        let reals: Vec<f32> = narrow.iter().map(|&v| v.into()).collect();
        let by_table = counted(&volume(Voxels::U16(narrow.clone())), &narrow).unwrap();
        let of_reals = counted(&volume(Voxels::F32(reals.clone())), &reals).unwrap();
        let by_hash = counted(&volume(Voxels::U16(wide.clone())), &wide).unwrap();
        assert_eq!(by_table, of_reals);
        let largest = |(pair, n): ([i32; 2], u64)| (pair.map(|v| if v == 60 { 600 } else { v }), n);
        assert_eq!(
            by_table.into_iter().map(largest).collect::<Vec<_>>(),
            by_hash
        );
        assert_eq!(by_hash.iter().map(|&(_, n)| n).sum::<u64>(), 29 * 6 * 5);
        assert_eq!(by_hash.last(), Some(&([600; 2], 29)));
    }
}
