//! Choice of a level of detail for every block, by its error in the transfer-function domain.
//!
//! After Ljung, Lundström, Ynnerman and Museth, "Transfer Function Based Adaptive Decompression for
//! Volume Rendering of Large Medical Data Sets" (2004): what a coarse level costs the picture is
//! how far its colours and opacities lie from those of the finest, not how far its values do. The
//! values of both levels are matched in order (the optimal transport between their histograms), and
//! the error is the sum over the matched voxels of the distance between their premultiplied optical
//! properties.
//!
//! Levels are then bought by falling error per added voxel. Every choice is a prefix of one order,
//! so more memory never gives a larger error.

use glam::{Vec3, Vec4};
use rayon::prelude::*;

use super::blocks::{BlockGrid, FINEST, LEVELS, Levels, brick_texels};
use super::statistics::{BINS, BlockStatistics, Histogram};
use crate::error::{Error, Result};

/// The level every visible block has when the budget allows it.
const BASE: u8 = 2;

/// Samples taken of a transfer function over the range of the volume.
const TABLE: usize = 4096;

/// What selection asks of a transfer function.
pub trait Classify: Sync {
    /// `[r a, g a, b a, a, e_r, e_g, e_b]`: premultiplied linear colour, opacity over the unit
    /// distance, and emission, of a value in the file's units.
    fn premultiplied(&self, value: f64) -> [f32; 7];

    /// False only when every value of a closed range, in the file's units, is transparent and does
    /// not emit.
    fn visible(&self, range: [f64; 2]) -> bool;
}

/// How much may be kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Request {
    /// Voxels of the volume per voxel kept, >= 1.
    pub data_reduction: f64,
    /// Device memory for the atlas, bytes.
    pub max_bytes: u64,
    /// Bytes that an atlas texel takes: voxel, and light where there is any.
    pub bytes_per_texel: u32,
}

/// The levels chosen, and what they amount to.
#[derive(Clone, Debug, PartialEq)]
pub struct Selection {
    /// Level of every block.
    pub levels: Levels,
    /// Voxels at the finest level per voxel kept; 1 when all is kept. Infinite when nothing is.
    pub data_reduction: f64,
    /// Number of resident blocks at each level.
    pub by_level: [usize; LEVELS],
    /// Sum over blocks and voxels of the distance in the transfer-function domain.
    pub error: f64,
    /// Blocks that the transfer function shows and the budget had no room for, not even at level 0.
    pub dropped: usize,
}

/// Chooses levels for one transfer function.
///
/// With `data_reduction` 1 and memory for everything, every block is at the finest level. Otherwise
/// blocks that are transparent over their closed range are not resident, visible ones get level 2,
/// or less where not all fit, and finer levels go where they reduce the error most per voxel until
/// the next step would exceed the budget. Steps that gain nothing are not taken. Ties go to the
/// lower block index.
///
/// # Errors
/// [`Error::Invalid`] when `data_reduction` is not a number >= 1.
pub fn select(
    statistics: &BlockStatistics,
    transfer_function: &impl Classify,
    request: &Request,
) -> Result<Selection> {
    if !(request.data_reduction >= 1.0 && request.data_reduction.is_finite()) {
        return Err(Error::invalid(
            "storage.data_reduction",
            format!("{} is not a number >= 1", request.data_reduction),
        ));
    }
    let grid = statistics.grid();
    if request.data_reduction == 1.0 && finest_bytes(grid, request) <= request.max_bytes {
        let everything = vec![Some(FINEST); grid.len()];
        return Ok(finish(grid, everything, 0.0));
    }

    let visible: Vec<bool> = (0..grid.len())
        .into_par_iter()
        .with_min_len(1 << 10)
        .map(|block| transfer_function.visible(statistics.block_value_range(block)))
        .collect();
    let mut choice = Choice::new(grid, request);
    // The highest floor that fits every visible block; from there, up to the next floor at most.
    let (floor, top) = [(Some(BASE), FINEST), (Some(1), BASE), (Some(0), 1)]
        .into_iter()
        .find(|&(floor, _)| choice.start_at(floor, &visible))
        .unwrap_or((None, 0));
    if floor.is_none() {
        choice.start_at(None, &visible);
    }
    let curves = error_curves(statistics, transfer_function, &visible, floor);
    choice.upgrade(&curves, top);

    let error = curves
        .iter()
        .zip(&choice.levels)
        .filter_map(|(curve, &level)| Some(curve.as_ref()?[rank(level)]))
        .sum();
    let shown = visible.iter().filter(|&&v| v).count();
    let mut selection = finish(grid, choice.levels, error);
    selection.dropped = shown - selection.levels.resident();
    Ok(selection)
}

/// Bytes of the grid of all finest bricks, the last of each axis trimmed to its voxels.
fn finest_bytes(grid: &BlockGrid, request: &Request) -> u64 {
    let texels: u64 = (0..3)
        .map(|a| u64::from(grid.size()[a]) + u64::from(grid.counts()[a]) - 1)
        .product();
    texels.saturating_mul(request.bytes_per_texel.into())
}

fn finish(grid: &BlockGrid, by_block: Vec<Option<u8>>, error: f64) -> Selection {
    let levels = Levels { by_block };
    let kept: u64 = levels
        .by_block
        .iter()
        .enumerate()
        .filter_map(|(block, level)| Some(grid.own_voxels(block, (*level)?)))
        .sum();
    Selection {
        data_reduction: finest_voxels(grid) as f64 / kept as f64,
        by_level: levels.count_by_level(),
        levels,
        error,
        dropped: 0,
    }
}

/// Own voxels of all blocks at the finest level: one for each cell.
fn finest_voxels(grid: &BlockGrid) -> u64 {
    grid.size().iter().map(|&n| u64::from(n) - 1).product()
}

/// Error of a block when absent and at each level, never rising from coarse to fine; `None` for a
/// block that the transfer function hides.
type ErrorCurve = Option<[f64; LEVELS + 1]>;

/// Place of a level in an error curve.
fn rank(level: Option<u8>) -> usize {
    level.map_or(0, |l| usize::from(l) + 1)
}

/// Error curves of the visible blocks, from `floor` up.
fn error_curves(
    statistics: &BlockStatistics,
    transfer_function: &impl Classify,
    visible: &[bool],
    floor: Option<u8>,
) -> Vec<ErrorCurve> {
    let table = Table::new(statistics.value_range(), transfer_function);
    statistics.count(visible);
    visible
        .par_iter()
        .with_min_len(64)
        .enumerate()
        .map(|(block, visible)| visible.then(|| error_curve(statistics, block, &table, floor)))
        .collect()
}

fn error_curve(
    statistics: &BlockStatistics,
    block: usize,
    table: &Table,
    floor: Option<u8>,
) -> [f64; LEVELS + 1] {
    let mut curve = [0.0; LEVELS + 1];
    let [low, high] = statistics
        .stored_range(block)
        .map(|s| statistics.rescale().range([s, s])[0]);
    let Some(histograms) = statistics.histograms(block) else {
        curve[0] = statistics.mass(block) as f64 * f64::from(norm(&table.at(low)));
        return curve;
    };
    let optical: [Optical; BINS] =
        std::array::from_fn(|k| table.at(low + (high - low) * (k as f64 / (BINS - 1) as f64)));
    let finest = Quantiles::new(&histograms[usize::from(FINEST)]);
    for level in (floor.unwrap_or(0)..FINEST).rev() {
        let coarse = Quantiles::new(&histograms[usize::from(level)]);
        let error = transport(&finest, &coarse, &optical);
        let at = rank(Some(level));
        curve[at] = f64::from(error).max(curve[at + 1]);
    }
    if floor.is_none() {
        let all: f32 = histograms[usize::from(FINEST)]
            .iter()
            .zip(&optical)
            .map(|(&count, optical)| f32::from(count) * norm(optical))
            .sum();
        curve[0] = f64::from(all).max(curve[1]);
    }
    curve
}

/// Premultiplied colour and opacity; emission.
type Optical = [Vec4; 2];

fn norm(a: &Optical) -> f32 {
    distance(a, &[Vec4::ZERO; 2])
}

fn distance(a: &Optical, b: &Optical) -> f32 {
    let (d, e) = (a[0] - b[0], a[1] - b[1]);
    (d * d + e * e).element_sum().sqrt()
}

/// A histogram as a quantile function.
struct Quantiles {
    /// Bins that are not empty, ascending.
    bins: [u8; BINS],
    /// Number of values up to each of them.
    until: [u16; BINS],
    total: u16,
}

impl Quantiles {
    fn new(histogram: &Histogram) -> Self {
        let mut quantiles = Self {
            bins: [0; BINS],
            until: [0; BINS],
            total: 0,
        };
        let mut filled = 0;
        for (k, &count) in histogram.iter().enumerate() {
            quantiles.total += count;
            // An empty bin is overwritten by the next: cheaper than to branch on noise.
            quantiles.bins[filled % BINS] = k as u8;
            quantiles.until[filled % BINS] = quantiles.total;
            filled += usize::from(count > 0);
        }
        quantiles
    }
}

/// Sum of distances when the values of two histograms of equal mass are matched in order.
fn transport(from: &Quantiles, to: &Quantiles, optical: &[Optical; BINS]) -> f32 {
    let mut sum = 0.0;
    let (mut i, mut j) = (0, 0);
    let mut matched = 0;
    // Both indices stay below BINS as long as values are left; the masks spare the bounds checks.
    while matched < from.total.min(to.total) {
        let (a, b) = (from.until[i % BINS], to.until[j % BINS]);
        let next = a.min(b);
        let optical = |bin: u8| &optical[usize::from(bin) % BINS];
        let apart = distance(optical(from.bins[i % BINS]), optical(to.bins[j % BINS]));
        sum += f32::from(next - matched) * apart;
        matched = next;
        i += usize::from(a == next);
        j += usize::from(b == next);
    }
    sum
}

/// A transfer function sampled over the range of the volume.
struct Table {
    low: f64,
    samples_per_unit: f64,
    samples: Vec<Optical>,
}

impl Table {
    fn new([low, high]: [f64; 2], transfer_function: &impl Classify) -> Self {
        let last = (TABLE - 1) as f64;
        let span = high - low;
        Self {
            low,
            samples_per_unit: if span > 0.0 { last / span } else { 0.0 },
            samples: (0..TABLE)
                .map(|i| {
                    let value = low + span * (i as f64 / last);
                    let [r, g, b, a, emission @ ..] = transfer_function.premultiplied(value);
                    [Vec4::new(r, g, b, a), Vec3::from(emission).extend(0.0)]
                })
                .collect(),
        }
    }

    fn at(&self, value: f64) -> Optical {
        let at = ((value - self.low) * self.samples_per_unit) as f32;
        let below = (at as usize).min(TABLE - 2);
        let s = (at - below as f32).min(1.0);
        let (a, b) = (&self.samples[below], &self.samples[below + 1]);
        [a[0].lerp(b[0], s), a[1].lerp(b[1], s)]
    }
}

/// Levels under construction, with what they take and what remains.
struct Choice<'a> {
    grid: &'a BlockGrid,
    levels: Vec<Option<u8>>,
    voxels: u64,
    texels: u64,
    max_voxels: u64,
    max_texels: u64,
}

/// One step up of one block.
struct Upgrade {
    block: u32,
    to: u8,
    /// Error taken away per voxel added.
    gain: f64,
}

impl<'a> Choice<'a> {
    fn new(grid: &'a BlockGrid, request: &Request) -> Self {
        // Packing bricks of several sizes leaves up to a tenth of the atlas unused.
        let max_texels = request.max_bytes / u64::from(request.bytes_per_texel.max(1));
        Self {
            grid,
            levels: Vec::new(),
            voxels: 0,
            texels: 0,
            max_voxels: (finest_voxels(grid) as f64 / request.data_reduction) as u64,
            max_texels: max_texels - max_texels / 11,
        }
    }

    /// Puts every visible block at one level. False when that does not fit.
    fn start_at(&mut self, floor: Option<u8>, visible: &[bool]) -> bool {
        self.levels = visible.iter().map(|&v| floor.filter(|_| v)).collect();
        self.voxels = 0;
        self.texels = 0;
        for (block, &level) in self.levels.iter().enumerate() {
            self.voxels += voxels(self.grid, block, level);
            self.texels += texels(level);
        }
        self.voxels <= self.max_voxels && self.texels <= self.max_texels
    }

    /// Takes the best steps, up to level `top`, until one does not fit.
    fn upgrade(&mut self, curves: &[ErrorCurve], top: u8) {
        let mut upgrades: Vec<Upgrade> = curves
            .iter()
            .enumerate()
            .filter_map(|(block, curve)| Some((block, curve.as_ref()?)))
            .flat_map(|(block, curve)| hull(self.grid, block, curve, self.levels[block], top))
            .collect();
        upgrades.sort_unstable_by(|a, b| {
            b.gain
                .total_cmp(&a.gain)
                .then(a.block.cmp(&b.block))
                .then(a.to.cmp(&b.to))
        });
        for step in upgrades {
            let block = step.block as usize;
            let (from, to) = (self.levels[block], Some(step.to));
            let voxels =
                self.voxels - voxels(self.grid, block, from) + voxels(self.grid, block, to);
            let texels = self.texels - texels(from) + texels(to);
            if voxels > self.max_voxels || texels > self.max_texels {
                break;
            }
            self.levels[block] = to;
            self.voxels = voxels;
            self.texels = texels;
        }
    }
}

fn voxels(grid: &BlockGrid, block: usize, level: Option<u8>) -> u64 {
    level.map_or(0, |l| grid.own_voxels(block, l))
}

fn texels(level: Option<u8>) -> u64 {
    level.map_or(0, |l| brick_texels(l) as u64)
}

/// The steps from a level to `top` along the lower convex hull of error against voxels: falling
/// gains.
fn hull(
    grid: &BlockGrid,
    block: usize,
    curve: &[f64; LEVELS + 1],
    start: Option<u8>,
    top: u8,
) -> impl Iterator<Item = Upgrade> {
    let mut from = start;
    let mut last_gain = f64::INFINITY;
    std::iter::from_fn(move || {
        let best = (rank(from) as u8..=top)
            .map(|to| {
                let added = voxels(grid, block, Some(to)).saturating_sub(voxels(grid, block, from));
                let removed = curve[rank(from)] - curve[rank(Some(to))];
                Upgrade {
                    block: block as u32,
                    to,
                    // A thin last block can hold fewer voxels than its coarse samples. The cap
                    // keeps rounding from putting the second of two steps of equal gain first.
                    gain: (removed / added.max(1) as f64).min(last_gain),
                }
            })
            .filter(|step| step.gain > 0.0)
            .reduce(|a, b| if b.gain >= a.gain { b } else { a })?;
        from = Some(best.to);
        last_gain = best.gain;
        Some(best)
    })
}
