//! Samples on the rays of local ambient occlusion that lie farther apart the farther out they are.
//!
//! In equation 2 of Hernell, Ljung and Ynnerman (2007) a part of a ray hides only what lies behind it: the opacity of part `m` of
//! `M` weighs `M - 1 - m`. So far parts can do with fewer samples. Those between two samples are interpolated.

use glam::{DVec3, UVec3};
use rayon::prelude::*;

use crate::field::Field;
use crate::scene::{AmbientOcclusion, Curve, Interpolation, Optical, RaySampling};
use crate::volume::Volume;

/// Largest RMS error of the light, of 1, that a growth may make to be chosen.
pub const RMS_ERROR: f64 = 1.0 / 255.0;

/// Growths to choose from, largest first. On rays of 15 parts they take 5, 6, 7 and 9 samples.
pub const GROWTHS: [f64; 4] = [1.0, 0.6, 0.4, 0.15];

/// Share of a part by which a sample may fall short of it in binary: 0.6 * 15 is below 9.
const ROUNDING: f64 = 1e-3;

/// Part of a ray in which sample `n` lies: each distance is `growth` parts longer than the one before, the first is 1.
pub fn part_of(growth: f64, n: u32) -> u32 {
    let n = f64::from(n);
    (n * (1.0 + 0.5 * growth * (n - 1.0)) + ROUNDING) as u32
}

/// All parts of a ray from few samples: opacity over the part first, then what else is interpolated like it.
///
/// `inside`: parts that lie in the field; the others hold zeros. No sample is taken for the last part alone, since nothing lies
/// behind it. Between samples stands the mean of the line through two and the parabola through three, behind the last its own value.
pub fn parts_of_ray<const N: usize>(
    growth: f64,
    parts: u32,
    inside: u32,
    mut sample: impl FnMut(u32) -> [f64; N],
) -> Vec<[f64; N]> {
    let inside = inside.min(parts);
    let end = inside.min(parts.saturating_sub(1).max(1));
    let mut ray = vec![[0.0; N]; parts as usize];
    let mut before: Option<u32> = None;
    let mut two_before: Option<u32> = None;
    for q in (0..).map(|n| part_of(growth, n)).take_while(|&q| q < end) {
        ray[q as usize] = sample(q);
        if let Some(p) = before {
            for m in p + 1..q {
                let value = std::array::from_fn(|channel| {
                    let at = |part: u32| [f64::from(part), ray[part as usize][channel]];
                    between(two_before.map(at), at(p), at(q), f64::from(m))
                });
                ray[m as usize] = value;
                if let Some(opacity) = ray[m as usize].first_mut() {
                    *opacity = opacity.min(1.0);
                }
            }
        }
        (two_before, before) = (before, Some(q));
    }
    if let Some(last) = before {
        let held = ray[last as usize];
        ray[last as usize + 1..inside as usize].fill(held);
    }
    ray
}

/// At `x`, between the samples `near` and `here`, each a place and a value; not negative.
fn between(far: Option<[f64; 2]>, near: [f64; 2], here: [f64; 2], x: f64) -> f64 {
    let slope = |a: [f64; 2], b: [f64; 2]| (b[1] - a[1]) / (b[0] - a[0]);
    let along = slope(near, here);
    let bend = far.map_or(0.0, |far| (along - slope(far, near)) / (here[0] - far[0]));
    let value = near[1] + (x - near[0]) * (along + 0.5 * bend * (x - here[0]));
    value.max(0.0)
}

/// The growth that settings ask for; `None`: samples in every part.
///
/// Where they leave it open it is the largest of [`GROWTHS`] that keeps the light within [`RMS_ERROR`] of samples in every part, by
/// a standard error at least, at up to 16384 voxels of the finest level, labels aside; `None` where none does.
pub fn growth(volume: &Volume, curve: &Curve, settings: &AmbientOcclusion) -> Option<f64> {
    match settings.sampling {
        RaySampling::Uniform => None,
        RaySampling::Distance => settings
            .growth
            .or_else(|| Pilot::new(volume, curve, settings).growth()),
    }
}

/// Voxels to look at, at most.
const VOXELS: usize = 1 << 14;
/// Fewest voxels that decide.
const FEWEST: usize = 512;
/// Standard errors by which fewer than all must be clear of the bound.
const EARLY: f64 = 4.0;
/// Samples of the field to take for that, at most, but for 16 voxels.
const SAMPLES: usize = 1 << 23;
/// Directions to look along, at most; with more, errors would only average out better.
const DIRECTIONS: usize = 32;
/// Voxels of a round, with those that nothing shows, and rounds at most.
const ROUND: usize = 2048;
const ROUNDS: usize = 64;

/// Mean and variance of values.
#[derive(Clone, Copy)]
struct Estimate {
    count: f64,
    sum: f64,
    squares: f64,
}

impl Estimate {
    fn of(values: impl Iterator<Item = f64>) -> Self {
        let none = Self {
            count: 0.0,
            sum: 0.0,
            squares: 0.0,
        };
        values.fold(none, |all, value| Self {
            count: all.count + 1.0,
            sum: all.sum + value,
            squares: all.squares + value * value,
        })
    }

    /// The mean, and by how much it may be off: a standard error.
    fn mean(self) -> [f64; 2] {
        let count = self.count.max(1.0);
        let mean = self.sum / count;
        let variance = (self.squares / count - mean * mean).max(0.0);
        [mean, (variance / count).sqrt()]
    }
}

/// The `n`th of a sequence of voxels that fills the grid evenly (Roberts 2018, the plastic number's generalization in 3D).
fn spread(n: usize, size: [u32; 3]) -> UVec3 {
    const ALPHA: DVec3 = DVec3::new(
        0.819_172_513_396_164_4,
        0.671_043_606_703_789_2,
        0.549_700_477_901_970_3,
    );
    let unit = (0.5 + ALPHA * n as f64).fract();
    let size = UVec3::from_array(size);
    (unit * size.as_dvec3()).as_uvec3().min(size - 1)
}

/// Rays at single voxels.
struct Pilot<'a> {
    volume: &'a Volume,
    field: Field<'a>,
    curve: &'a Curve,
    /// Index units per mm, and the weight.
    directions: Vec<(DVec3, f64)>,
    parts: u32,
    offset_mm: f64,
    part_mm: f64,
    /// Of a part's transparency.
    exponent: f64,
    emission: bool,
}

impl<'a> Pilot<'a> {
    fn new(volume: &'a Volume, curve: &'a Curve, settings: &AmbientOcclusion) -> Self {
        let field = Field::new(volume);
        let parts = settings.samples_per_ray();
        let voxel_mm = volume.min_spacing();
        let part_mm = (settings.radius - settings.offset) / f64::from(parts) * voxel_mm;
        let directions = settings.weighted_directions();
        let directions = directions
            .iter()
            .take(DIRECTIONS)
            .map(|&(direction, weight)| {
                let direction = DVec3::from_array(direction);
                (field.ix_from_world().transform_vector3(direction), weight)
            });
        Self {
            directions: directions.collect(),
            volume,
            field,
            curve,
            parts,
            offset_mm: settings.offset * voxel_mm,
            part_mm,
            exponent: settings.gamma * part_mm / curve.unit_distance,
            emission: settings.emission,
        }
    }

    /// True when a voxel or one of the 26 around it does.
    fn shows_something(&self, voxel: UVec3) -> bool {
        let last = UVec3::from_array(self.volume.size()) - 1;
        let (low, high) = (voxel.saturating_sub(UVec3::ONE), (voxel + 1).min(last));
        let around = (low.z..=high.z).flat_map(|z| {
            (low.y..=high.y).flat_map(move |y| (low.x..=high.x).map(move |x| (x, y, z)))
        });
        around.into_iter().any(|(x, y, z)| {
            let Optical {
                opacity, emission, ..
            } = self.curve.evaluate(self.volume.value(x, y, z));
            opacity > 0.0 || emission.iter().any(|&e| e > 0.0)
        })
    }

    /// Opacity and emission of the parts of a ray that lie in the field.
    fn ray(&self, voxel: UVec3, direction_ix: DVec3) -> Vec<[f64; 4]> {
        let sample = |m: u32| {
            let distance = self.offset_mm + (f64::from(m) + 0.5) * self.part_mm;
            let ix = voxel.as_dvec3() + direction_ix * distance;
            let value = self.field.sample(ix, Interpolation::Linear)?;
            let Optical {
                opacity, emission, ..
            } = self.curve.evaluate(value);
            let opacity = if opacity > 0.0 {
                1.0 - (1.0 - opacity).powf(self.exponent)
            } else {
                0.0
            };
            let [r, g, b] = emission.map(|e| if self.emission { e } else { 0.0 });
            Some([opacity, r, g, b])
        };
        (0..self.parts).map_while(sample).collect()
    }

    /// The largest growth within the error. Looks at more and more voxels until that is clear.
    fn growth(&self) -> Option<f64> {
        let samples_a_voxel = self.directions.len() * self.parts as usize;
        let most = (SAMPLES / samples_a_voxel.max(1)).clamp(16, VOXELS);
        let bound = RMS_ERROR.powi(2);
        // In order, so that sums do not depend on threads.
        let mut errors: Vec<[f64; GROWTHS.len()]> = Vec::new();
        for round in 0..ROUNDS {
            let tried = (round * ROUND..(round + 1) * ROUND).into_par_iter();
            let shown: Vec<UVec3> = tried
                .map(|n| spread(n, self.volume.size()))
                .filter(|&voxel| self.shows_something(voxel))
                .collect();
            // No more than that: rays may be long.
            let wanted = shown.len().min(most - errors.len());
            errors.par_extend(
                shown[..wanted]
                    .par_iter()
                    .map(|&voxel| self.squared_errors_at(voxel)),
            );
            let is_last = errors.len() >= most || round + 1 == ROUNDS;
            if errors.len() < FEWEST && !is_last {
                continue;
            }
            let estimates = (0..GROWTHS.len())
                .map(|growth| Estimate::of(errors.iter().map(|error| error[growth])).mean());
            // Those that are surely too large are out.
            let mut left = GROWTHS.iter().zip(estimates);
            // Who asks often is deceived by chance more often.
            let errors_off = if is_last { 1.0 } else { EARLY };
            let clear = |mean: f64, off: f64| mean + errors_off * off <= bound;
            let next = left.find(|(_, [mean, off])| {
                clear(*mean, *off) || (!is_last && mean - errors_off * off <= bound)
            });
            match next {
                Some((_, [mean, off])) if !clear(mean, off) => {}
                decided => return decided.map(|(&growth, _)| growth),
            }
        }
        None
    }

    /// Squared error of the light at a voxel by each growth, the mean of the channels.
    fn squared_errors_at(&self, voxel: UVec3) -> [f64; GROWTHS.len()] {
        let mut errors = [DVec3::ZERO; GROWTHS.len()];
        for &(direction_ix, weight) in &self.directions {
            let ray = self.ray(voxel, direction_ix);
            let expected = self.light(&ray);
            for (error, growth) in errors.iter_mut().zip(GROWTHS) {
                let few = parts_of_ray(growth, self.parts, ray.len() as u32, |m| ray[m as usize]);
                *error += weight * (self.light(&few) - expected);
            }
        }
        let count = self.directions.len().max(1) as f64;
        errors.map(|error| (error / count).length_squared() / 3.0)
    }

    /// Equations 2 and 4; parts that are missing are clear.
    fn light(&self, ray: &[[f64; 4]]) -> DVec3 {
        let mut light = DVec3::ZERO;
        let mut transparency = 1.0;
        for &[opacity, r, g, b] in ray {
            light += transparency * (1.0 + DVec3::new(r, g, b));
            transparency *= 1.0 - opacity;
        }
        let missing = f64::from(self.parts) - ray.len() as f64;
        (light + transparency * missing) / f64::from(self.parts)
    }
}

#[cfg(test)]
mod tests {
    use super::{GROWTHS, part_of, parts_of_ray};

    #[test]
    fn samples_lie_where_growths_say() {
        let parts = |growth| {
            let parts = (0..).map(|n| part_of(growth, n));
            parts.take_while(|&m| m < 14).collect::<Vec<_>>()
        };
        let expected: [&[u32]; 4] = [
            &[0, 1, 3, 6, 10],
            &[0, 1, 2, 4, 7, 11],
            &[0, 1, 2, 4, 6, 9, 12],
            &[0, 1, 2, 3, 4, 6, 8, 10, 12],
        ];
        assert_eq!(GROWTHS.map(parts), expected);
    }

    #[test]
    fn what_changes_evenly_is_as_if_every_part_were_sampled() {
        for growth in GROWTHS {
            for inside in 0..=15 {
                let mut taken = 0;
                let ray = parts_of_ray(growth, 15, inside, |m| {
                    taken += 1;
                    assert!(
                        m < inside.min(14),
                        "no sample outside, none for the last part"
                    );
                    [0.02 * f64::from(m), 1.0 - 0.05 * f64::from(m)]
                });
                let last = (0..)
                    .map(|n| part_of(growth, n))
                    .take_while(|&m| m < inside.min(14))
                    .last();
                for (m, part) in ray.iter().enumerate() {
                    // Behind the last sample its value stands.
                    let at = last.map_or(0.0, |last| f64::from(last).min(m as f64));
                    let expected = if (m as u32) < inside {
                        [0.02 * at, 1.0 - 0.05 * at]
                    } else {
                        [0.0; 2]
                    };
                    for (actual, expected) in part.iter().zip(expected) {
                        assert!((actual - expected).abs() < 1e-14, "{growth} {inside} {m}");
                    }
                }
                assert!(taken <= inside);
            }
        }
    }

    #[test]
    fn interpolated_parts_are_opacities() {
        let steep = |m: u32| if m < 4 { [0.0] } else { [1.0] };
        for part in parts_of_ray(0.6, 15, 15, steep) {
            assert!((0.0..=1.0).contains(&part[0]), "{part:?}");
        }
        let falling = |m: u32| if m < 4 { [1.0] } else { [0.0] };
        for part in parts_of_ray(0.6, 15, 15, falling) {
            assert!((0.0..=1.0).contains(&part[0]), "{part:?}");
        }
    }
}
