//! Which ranges of stored values show something, by one comparison where values are integers.

use rayon::prelude::*;

use super::select::Classify;
use super::{Rescale, Volume, VoxelType};

/// Values that one task looks at.
const CHUNK: usize = 1 << 12;

/// Answers [`Classify::visible`] for ranges of stored values of a volume.
///
/// There are more skip cells than ranges of few integers to ask about, and far more cells between voxels.
pub struct VisibleRanges<'a, C> {
    classify: &'a C,
    rescale: Rescale,
    ends: Option<VisibleEnds>,
}

impl<'a, C: Classify> VisibleRanges<'a, C> {
    /// Looks at every value that a volume of integers may have, in parallel.
    pub fn new(volume: &Volume, classify: &'a C) -> Self {
        let rescale = volume.rescale();
        let integers = volume.voxels().voxel_type() != VoxelType::F32;
        let ends = integers.then(|| {
            let [first, last] = volume.stored_range().map(|v| v as i32);
            let visible = |low: i32, high: i32| {
                classify.visible(rescale.range([low, high].map(|v| v as f32)))
            };
            VisibleEnds::new(first, last, &visible)
        });
        Self {
            classify,
            rescale,
            ends,
        }
    }

    /// False only when every value of a closed range of stored values is transparent and does not emit.
    pub fn visible(&self, stored: [f32; 2]) -> bool {
        let known = self.ends.as_ref().and_then(|ends| ends.visible(stored));
        known.unwrap_or_else(|| self.classify.visible(self.rescale.range(stored)))
    }

    /// All that the transfer function says of ranges of integers; `None` where values are no integers.
    pub fn ends(&self) -> Option<&VisibleEnds> {
        self.ends.as_ref()
    }

    /// As [`VisibleRanges::ends`].
    pub fn into_ends(self) -> Option<VisibleEnds> {
        self.ends
    }
}

/// By integer, the least upper end of a range from there that shows something.
///
/// A range shows something when a part of it does ([`Classify::visible`] is false only where all of a range is transparent), so that
/// these ends say all.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct VisibleEnds {
    first: i32,
    /// From `first` on; beyond the last integer where no range shows anything.
    ends: Vec<i32>,
}

impl VisibleEnds {
    fn new(first: i32, last: i32, visible: &(impl Fn(i32, i32) -> bool + Sync)) -> Self {
        let mut ends = vec![0; (last - first + 1) as usize];
        let chunks = ends.par_chunks_mut(CHUNK).enumerate();
        chunks.for_each(|(chunk, ends)| {
            let start = first + (chunk * CHUNK) as i32;
            // The first by bisection, the others from there: ends ascend.
            let [mut end, mut shown] = [start, last + 1];
            while end < shown {
                let middle = end + (shown - end) / 2;
                if visible(start, middle) {
                    shown = middle;
                } else {
                    end = middle + 1;
                }
            }
            for (low, to) in (start..).zip(ends) {
                end = end.max(low);
                while end <= last && !visible(low, end) {
                    end += 1;
                }
                *to = end;
            }
        });
        Self { first, ends }
    }

    /// Intervals of integers, both ends included and ascending, of which a range meets one if it shows something: at most `most`, for which
    /// those that lie closest together are taken for one.
    pub fn intervals(&self, most: usize) -> Vec<[i32; 2]> {
        let last = self.first + self.ends.len() as i32 - 1;
        let mut intervals: Vec<[i32; 2]> = Vec::new();
        for (low, &end) in (self.first..).zip(&self.ends) {
            if end > last {
                break;
            }
            if self.ends.get((low + 1 - self.first) as usize) == Some(&end) {
                // Ranges from the next integer on show as much.
                continue;
            }
            match intervals.last_mut() {
                Some([_, before]) if low <= *before + 1 => *before = end,
                _ => intervals.push([low, end]),
            }
        }
        // Groups that the widest gaps part.
        let mut starts: Vec<usize> = (1..intervals.len()).collect();
        starts.sort_by_key(|&at| intervals[at - 1][1] - intervals[at][0]);
        starts.truncate(most.max(1) - 1);
        let joins = |at: usize| !starts.contains(&at);
        let mut merged: Vec<[i32; 2]> = Vec::new();
        for (at, interval) in intervals.iter().enumerate() {
            match merged.last_mut() {
                Some(last) if joins(at) => last[1] = interval[1],
                _ => merged.push(*interval),
            }
        }
        merged
    }

    /// `None` for what does not begin and end at integers that the volume may have.
    fn visible(&self, stored: [f32; 2]) -> Option<bool> {
        let [low, high] = stored.map(|v| v as i32);
        if [low, high].map(|v| v as f32) != stored {
            return None;
        }
        let [from, to] = [low, high].map(|v| v.wrapping_sub(self.first) as u32 as usize);
        let end = *self.ends.get(from)?;
        (to < self.ends.len()).then_some(end <= high)
    }
}

#[cfg(test)]
pub(super) mod tests {
    use glam::DAffine3;

    use super::VisibleRanges;
    use crate::volume::select::Classify;
    use crate::volume::{Rescale, Volume, Voxels};

    /// Shows some intervals.
    pub(in crate::volume) struct Intervals(pub(in crate::volume) Vec<[f64; 2]>);

    impl Classify for Intervals {
        fn premultiplied(&self, _: f64) -> [f32; 7] {
            [0.0; 7]
        }

        fn visible(&self, range: [f64; 2]) -> bool {
            let meets = |shown: &[f64; 2]| shown[0] <= range[1] && range[0] <= shown[1];
            self.0.iter().any(meets)
        }
    }

    #[test]
    fn what_shows_something_meets_an_interval() {
        let volume = Volume::new(
            Voxels::I16((-100..100).collect()),
            [2, 2, 50],
            DAffine3::IDENTITY,
            Rescale::default(),
        )
        .unwrap();
        // Single integers, what lies between two, and more than are asked for.
        let shown = Intervals(vec![
            [-90.0, -70.5],
            [-60.0, -60.0],
            [-40.6, -40.4],
            [10.0, 30.0],
            [50.0, 51.0],
        ]);
        let ranges = VisibleRanges::new(&volume, &shown);
        let ends = ranges.ends().unwrap();
        let all = [[-90, -71], [-60, -60], [-41, -40], [10, 30], [50, 51]];
        assert_eq!(ends.intervals(8), all);
        // The nearest become one.
        assert_eq!(ends.intervals(3), [[-90, -40], [10, 30], [50, 51]]);
        assert_eq!(ends.intervals(1), [[-90, 51]]);
        for most in 1..8 {
            let intervals = ends.intervals(most);
            assert!(intervals.len() <= most);
            for low in -100..100 {
                for high in low..100 {
                    let meets = intervals.iter().any(|i| i[0] <= high && low <= i[1]);
                    let shows = ranges.visible([low, high].map(|v| v as f32));
                    assert!(meets || !shows, "[{low}, {high}] of {intervals:?}");
                }
            }
        }
        let nothing = Intervals(vec![]);
        let ranges = VisibleRanges::new(&volume, &nothing);
        assert!(ranges.ends().unwrap().intervals(8).is_empty());
    }

    #[test]
    fn every_range_is_as_the_transfer_function_says() {
        let values = |from: i16, to: i16| (from..to).chain([to; 4]).collect::<Vec<_>>();
        let volumes = [
            (Voxels::U8((3..=202).collect()), 1.0),
            (Voxels::I8((-100..100).collect()), -0.5),
            // Several chunks.
            (Voxels::I16(values(-4500, 4700)), 1.0),
            (Voxels::F32((0..200).map(|v| v as f32 / 7.0).collect()), 1.0),
        ];
        for (voxels, slope) in volumes {
            let size = [2, 2, voxels.len() as u32 / 4];
            let rescale = Rescale {
                slope,
                intercept: 4.0,
            };
            let volume = Volume::new(voxels, size, DAffine3::IDENTITY, rescale).unwrap();
            let shown = Intervals(vec![[-40.5, -31.0], [10.0, 12.0], [4180.0, 4181.0]]);
            let ranges = VisibleRanges::new(&volume, &shown);
            let [first, last] = volume.stored_range().map(|v| v as f32);
            let mut seen = [0; 2];
            for low in 0..160 {
                for length in [0.0, 0.5, 1.0, 7.0, 60.0, 5000.0, 20_000.0] {
                    let low = first - 2.0 + (last - first) * low as f32 / 150.0;
                    for low in [low, low.round()] {
                        let range = [low, low + length];
                        let expected = shown.visible(rescale.range(range));
                        assert_eq!(ranges.visible(range), expected, "{range:?}");
                        seen[usize::from(expected)] += 1;
                    }
                }
            }
            assert!(seen.iter().all(|&n| n > 100), "{seen:?}");
        }
    }
}
