//! Phase functions: how much of the scattered light goes where.
//!
//! The cosine is that of the angle between two directions of travel, of the light before and after: 1 is
//! forward. Every function is a density over the sphere of outgoing directions, 1/sr.

use std::f64::consts::PI;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::validate::{Number, finite, is_share, require};
use crate::error::Result;

/// Largest asymmetry of a phase function, either way.
pub const MAX_ASYMMETRY: f64 = 0.99;
/// Most values of a tabulated phase function.
pub const MAX_PHASE_VALUES: usize = 4096;

/// Density of an isotropic phase function, 1/sr.
const UNIFORM: f64 = 0.25 / PI;

/// Angular distribution of scattered light.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
pub enum PhaseFunction {
    /// The same in all directions.
    #[default]
    Isotropic,
    /// Henyey and Greenstein 1941 (Max 1995, eq. 10): `(1 - g^2) / (4 pi (1 + g^2 - 2 g cos)^1.5)`.
    HenyeyGreenstein {
        /// Mean cosine, -0.99 to 0.99; positive is forward.
        g: f64,
    },
    /// Two lobes of Henyey and Greenstein.
    DoubleHenyeyGreenstein {
        /// Mean cosine of the first lobe, -0.99 to 0.99.
        g1: f64,
        /// Mean cosine of the second lobe, -0.99 to 0.99.
        g2: f64,
        /// Share of the first lobe, 0 to 1.
        weight: f64,
    },
    /// Particles much smaller than the wavelength: `3 (1 + cos^2) / (16 pi)`.
    Rayleigh,
    /// Rational stand-in for Henyey and Greenstein (Blasi, Le Saëc, Schlick 1993):
    /// `(1 - k^2) / (4 pi (1 - k cos)^2)`; `k = 1.55 g - 0.55 g^3` comes close to `g`.
    Schlick {
        /// Asymmetry, -0.99 to 0.99; positive is forward.
        k: f64,
    },
    /// Large spheres that scatter by Lambert's law on their surface (Blinn 1982):
    /// `(8 / 3 pi) (sin a + (pi - a) cos a) / (4 pi)`, with `a` the phase angle between the directions to the light
    /// and to the eye, so `cos a = -cos`: back-scattering, as of a planet, with the mean cosine -4/9.
    LambertSphere,
    /// Values at equal steps of the cosine from -1 to 1, linear between them, normalised.
    Table {
        /// Two or more numbers >= 0, not all 0.
        values: Vec<f64>,
    },
}

impl PhaseFunction {
    /// Checks the range of every parameter.
    ///
    /// # Errors
    /// [`crate::error::Error::Invalid`] names the parameter by its scene key.
    pub fn validate(&self) -> Result<()> {
        let at = |key: &str| format!("lighting.phase.{key}");
        let asymmetry = |key: &str, value: f64| {
            require(
                value.abs() <= MAX_ASYMMETRY,
                &at(key),
                Number(value),
                &format!("a number from -{MAX_ASYMMETRY} to {MAX_ASYMMETRY}"),
            )
        };
        match self {
            Self::Isotropic | Self::Rayleigh | Self::LambertSphere => Ok(()),
            Self::HenyeyGreenstein { g } => asymmetry("g", *g),
            Self::Schlick { k } => asymmetry("k", *k),
            Self::DoubleHenyeyGreenstein { g1, g2, weight } => {
                asymmetry("g1", *g1)?;
                asymmetry("g2", *g2)?;
                let wanted = "a number from 0 to 1 (share of g1)";
                require(is_share(*weight), &at("weight"), Number(*weight), wanted)
            }
            Self::Table { values } => {
                require(
                    (2..=MAX_PHASE_VALUES).contains(&values.len()),
                    &at("values"),
                    format_args!("a list of {}", values.len()),
                    &format!("2 to {MAX_PHASE_VALUES} numbers"),
                )?;
                let valid = |&v: &f64| finite(v) && v >= 0.0;
                if let Some(i) = values.iter().position(|v| !valid(v)) {
                    let at = at(&format!("values.{i}"));
                    return require(false, &at, Number(values[i]), "a number >= 0");
                }
                require(
                    values.iter().any(|&v| v >= f64::from(f32::MIN_POSITIVE)),
                    &at("values"),
                    format_args!("a list of zeros"),
                    "at least one number > 0",
                )
            }
        }
    }

    /// Density for a cosine in `[-1,1]`, 1/sr. Its integral over the sphere is 1.
    pub fn evaluate(&self, cos: f64) -> f64 {
        match self {
            Self::Isotropic => UNIFORM,
            Self::HenyeyGreenstein { g } => henyey_greenstein(*g, cos),
            Self::DoubleHenyeyGreenstein { g1, g2, weight } => {
                mix(*weight, |g| henyey_greenstein(g, cos), *g1, *g2)
            }
            Self::Rayleigh => 0.75 * UNIFORM * (1.0 + cos * cos),
            Self::Schlick { k } => UNIFORM * (1.0 - k * k) / (1.0 - k * cos).powi(2),
            Self::LambertSphere => {
                let a = phase_angle(cos);
                UNIFORM * 8.0 / (3.0 * PI) * (a.sin() + (PI - a) * a.cos())
            }
            Self::Table { values } => {
                let (cell, s) = cell_of(values, cos);
                let value = values[cell] + (values[cell + 1] - values[cell]) * s;
                value / (2.0 * PI * table_integral(values, 1.0))
            }
        }
    }

    /// Share of the light that is scattered to cosines from -1 up to this one, in `[0,1]`.
    pub fn cumulative(&self, cos: f64) -> f64 {
        match self {
            Self::Isotropic => 0.5 * (1.0 + cos),
            Self::HenyeyGreenstein { g } => henyey_greenstein_share(*g, cos),
            Self::DoubleHenyeyGreenstein { g1, g2, weight } => {
                mix(*weight, |g| henyey_greenstein_share(g, cos), *g1, *g2)
            }
            Self::Rayleigh => (4.0 + cos * (3.0 + cos * cos)) / 8.0,
            Self::Schlick { k } => 0.5 * (1.0 - k) * (1.0 + cos) / (1.0 - k * cos),
            Self::LambertSphere => {
                let a = phase_angle(cos);
                let [sin, cos] = [(2.0 * a).sin(), (2.0 * a).cos()];
                (2.0 * a + PI - (PI - a) * cos - 1.5 * sin) / (3.0 * PI)
            }
            Self::Table { values } => table_integral(values, cos) / table_integral(values, 1.0),
        }
    }

    /// The cosine up to which a share in `[0,1]` of the light is scattered: inverse of [`Self::cumulative`].
    pub fn quantile(&self, share: f64) -> f64 {
        if share <= 0.0 {
            return -1.0;
        }
        if share >= 1.0 {
            return 1.0;
        }
        let cos = match self {
            Self::Isotropic => 2.0 * share - 1.0,
            Self::HenyeyGreenstein { g } => {
                // The usual form divides by g; this one has no 0/0.
                let t = 1.0 - g + 2.0 * g * share;
                let s = (1.0 - g * g) / t;
                0.5 * (g + (2.0 * share - 1.0 + g) * (s + 1.0) / t)
            }
            Self::Rayleigh => {
                let half = 4.0 * share - 2.0;
                let root = (half.abs() + half.hypot(1.0)).cbrt();
                (root - 1.0 / root).copysign(half)
            }
            Self::Schlick { k } => (2.0 * share - 1.0 + k) / (1.0 - k + 2.0 * k * share),
            Self::DoubleHenyeyGreenstein { .. } | Self::LambertSphere | Self::Table { .. } => {
                return self.bisected_quantile(share);
            }
        };
        cos.clamp(-1.0, 1.0)
    }

    fn bisected_quantile(&self, share: f64) -> f64 {
        let [mut low, mut high] = [-1.0, 1.0];
        // Each step halves an interval of 2: 54 steps end at the spacing of numbers near 1.
        for _ in 0..54 {
            let middle = 0.5 * (low + high);
            if self.cumulative(middle) < share {
                low = middle;
            } else {
                high = middle;
            }
        }
        0.5 * (low + high)
    }

    /// The `n + 1` cosines, from -1 to 1, between which equal shares `1/n` of the light are scattered, `n >= 1`.
    pub fn equal_probability_cosines(&self, n: u32) -> Vec<f64> {
        let share = |i: u32| f64::from(i) / f64::from(n.max(1));
        (0..=n.max(1)).map(|i| self.quantile(share(i))).collect()
    }

    /// Legendre moment `2 pi integral_{-1}^1 p(x) P_l(x) dx`: 1 for `l = 0`, the mean cosine for `l = 1`, `g^l` of
    /// Henyey and Greenstein.
    pub fn moment(&self, l: u32) -> f64 {
        match self {
            Self::Isotropic => power(0.0, l),
            Self::HenyeyGreenstein { g } => power(*g, l),
            Self::DoubleHenyeyGreenstein { g1, g2, weight } => {
                mix(*weight, |g| power(g, l), *g1, *g2)
            }
            Self::Rayleigh => match l {
                0 => 1.0,
                2 => 0.1,
                _ => 0.0,
            },
            Self::Schlick { .. } | Self::LambertSphere | Self::Table { .. } => self.quadrature(l),
        }
    }

    /// The moment by Gauss's quadrature with three points, over angles: its panels meet where a table has kinks.
    fn quadrature(&self, l: u32) -> f64 {
        let panel = PI / f64::from(512 + 8 * l);
        self.kinks()
            .windows(2)
            .map(|ends| {
                let count = ((ends[1] - ends[0]) / panel).ceil().max(1.0);
                let width = (ends[1] - ends[0]) / count;
                (0..count as u32)
                    .map(|i| {
                        let middle = ends[0] + (f64::from(i) + 0.5) * width;
                        gauss(middle, width, |angle| {
                            let cos = angle.cos();
                            2.0 * PI * self.evaluate(cos) * legendre(l, cos) * angle.sin()
                        })
                    })
                    .sum::<f64>()
            })
            .sum()
    }

    /// Angles, ascending from 0 to pi, between which the function is smooth.
    fn kinks(&self) -> Vec<f64> {
        match self {
            Self::Table { values } => {
                let cells = (values.len() - 1) as f64;
                let angle = |i: usize| (1.0 - 2.0 * i as f64 / cells).acos();
                (0..values.len()).map(angle).collect()
            }
            _ => vec![0.0, PI],
        }
    }
}

fn mix(weight: f64, lobe: impl Fn(f64) -> f64, first: f64, second: f64) -> f64 {
    weight * lobe(first) + (1.0 - weight) * lobe(second)
}

/// `1 + g^2 - 2 g cos`, without cancellation at the peak.
fn squared_distance(g: f64, cos: f64) -> f64 {
    let g_abs = g.abs();
    (1.0 - g_abs).powi(2) + 2.0 * g_abs * (1.0 - cos * g.signum())
}

fn henyey_greenstein(g: f64, cos: f64) -> f64 {
    UNIFORM * (1.0 - g * g) / squared_distance(g, cos).powf(1.5)
}

/// Cumulative share of a lobe, without the usual form's division by g.
fn henyey_greenstein_share(g: f64, cos: f64) -> f64 {
    let s = squared_distance(g, cos).sqrt();
    (1.0 - g) * (1.0 + cos) / (s * (1.0 + g + s))
}

/// `g^l`, 1 for `l = 0` whatever g is.
fn power(g: f64, l: u32) -> f64 {
    i32::try_from(l).map_or(0.0, |l| g.powi(l))
}

/// Angle between the directions to the light and to the eye: 0 is back-scattering.
fn phase_angle(cos: f64) -> f64 {
    (-cos).clamp(-1.0, 1.0).acos()
}

/// The cell of a table in which a cosine lies, and where in it, `[0,1]`.
fn cell_of(values: &[f64], cos: f64) -> (usize, f64) {
    let cells = values.len() - 1;
    let at = 0.5 * (1.0 + cos.clamp(-1.0, 1.0)) * cells as f64;
    let cell = (at as usize).min(cells - 1);
    (cell, at - cell as f64)
}

/// Integral of a table over cosines from -1 up to one.
fn table_integral(values: &[f64], cos: f64) -> f64 {
    let (cell, s) = cell_of(values, cos);
    let whole: f64 = values[..=cell]
        .windows(2)
        .map(|v| 0.5 * (v[0] + v[1]))
        .sum();
    let part = s * (values[cell] + 0.5 * s * (values[cell + 1] - values[cell]));
    (whole + part) * 2.0 / (values.len() - 1) as f64
}

/// Legendre polynomial, by Bonnet's recursion.
fn legendre(l: u32, x: f64) -> f64 {
    let [mut before, mut value] = [0.0, 1.0];
    for n in 0..l {
        let n = f64::from(n);
        (before, value) = (
            value,
            ((2.0 * n + 1.0) * x * value - n * before) / (n + 1.0),
        );
    }
    value
}

/// Integral over an interval, exact for polynomials of degree 5.
fn gauss(middle: f64, width: f64, f: impl Fn(f64) -> f64) -> f64 {
    let offset = 0.5 * width * 0.6_f64.sqrt();
    width * (5.0 * (f(middle - offset) + f(middle + offset)) + 8.0 * f(middle)) / 18.0
}
