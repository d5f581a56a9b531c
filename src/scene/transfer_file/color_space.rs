//! Colour spaces that programs interpolate display colours in, as VTK's `vtkColorTransferFunction` does.
//!
//! Lab: CIE 1976 with the white and matrix of sRGB in four digits, as VTK has them. Diverging: K. Moreland, *Diverging
//! Color Maps for Scientific Visualization*, ISVC 2009.

use crate::scene::{linear_from_srgb, srgb_from_linear};

/// How colours between two points are found. Colours are display (sRGB) values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ColorSpace {
    Rgb,
    /// Hue the way that does not cross red.
    Hsv,
    /// Hue the shorter way.
    HsvWrapped,
    Lab,
    /// Moreland's Msh, through white.
    Diverging,
    /// The colour of the point at the upper end.
    Step,
}

impl ColorSpace {
    /// The colour at `share` of the way from `a` to `b`.
    pub(super) fn mix(self, a: [f64; 3], b: [f64; 3], share: f64) -> [f64; 3] {
        match self {
            Self::Rgb => lerp(a, b, share),
            Self::Hsv => rgb_from_hsv(lerp(hsv_from_rgb(a), hsv_from_rgb(b), share)),
            Self::HsvWrapped => {
                let (mut from, mut to) = (hsv_from_rgb(a), hsv_from_rgb(b));
                if (from[0] - to[0]).abs() > 0.5 {
                    let larger = if from[0] > to[0] { &mut from } else { &mut to };
                    larger[0] -= 1.0;
                }
                let [hue, saturation, value] = lerp(from, to, share);
                rgb_from_hsv([hue.rem_euclid(1.0), saturation, value])
            }
            Self::Lab => rgb_from_lab(lerp(lab_from_rgb(a), lab_from_rgb(b), share)),
            Self::Diverging => diverging(a, b, share),
            Self::Step => b,
        }
    }
}

pub(super) fn lerp<const N: usize>(a: [f64; N], b: [f64; N], share: f64) -> [f64; N] {
    std::array::from_fn(|i| a[i] + (b[i] - a[i]) * share)
}

/// Hue, saturation and value, each 0 to 1.
fn hsv_from_rgb([r, g, b]: [f64; 3]) -> [f64; 3] {
    let (low, high) = (r.min(g).min(b), r.max(g).max(b));
    let chroma = high - low;
    if chroma <= 0.0 {
        return [0.0, 0.0, high];
    }
    let sixths = if high == r {
        (g - b) / chroma
    } else if high == g {
        2.0 + (b - r) / chroma
    } else {
        4.0 + (r - g) / chroma
    };
    [(sixths / 6.0).rem_euclid(1.0), chroma / high, high]
}

fn rgb_from_hsv([hue, saturation, value]: [f64; 3]) -> [f64; 3] {
    [5.0, 3.0, 1.0].map(|n: f64| {
        let k = (n + hue * 6.0) % 6.0;
        value - value * saturation * k.min(4.0 - k).clamp(0.0, 1.0)
    })
}

/// White of sRGB.
const WHITE: [f64; 3] = [0.9505, 1.0, 1.089];
/// Below this share of white the cube root is continued by a line.
const DARK: f64 = 0.008_856;
const DARK_SLOPE: f64 = 7.787;
const DARK_OFFSET: f64 = 16.0 / 116.0;

fn lab_from_rgb(rgb: [f64; 3]) -> [f64; 3] {
    let [r, g, b] = rgb.map(linear_from_srgb);
    let xyz = [
        0.4124 * r + 0.3576 * g + 0.1805 * b,
        0.2126 * r + 0.7152 * g + 0.0722 * b,
        0.0193 * r + 0.1192 * g + 0.9505 * b,
    ];
    let [x, y, z] = std::array::from_fn(|i| {
        let share = xyz[i] / WHITE[i];
        if share > DARK {
            share.cbrt()
        } else {
            DARK_SLOPE * share + DARK_OFFSET
        }
    });
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// Colours outside of sRGB are darkened until the largest channel is 1; negative channels become 0.
fn rgb_from_lab([l, a, b]: [f64; 3]) -> [f64; 3] {
    let y = (l + 16.0) / 116.0;
    let roots = [a / 500.0 + y, y, y - b / 200.0];
    let [x, y, z]: [f64; 3] = std::array::from_fn(|i| {
        let cube = roots[i].powi(3);
        let share = if cube > DARK {
            cube
        } else {
            (roots[i] - DARK_OFFSET) / DARK_SLOPE
        };
        share * WHITE[i]
    });
    let linear = [
        3.2406 * x - 1.5372 * y - 0.4986 * z,
        -0.9689 * x + 1.8758 * y + 0.0415 * z,
        0.0557 * x - 0.2040 * y + 1.0570 * z,
    ];
    let display = linear.map(srgb_from_linear);
    let largest = display.into_iter().fold(1.0, f64::max);
    display.map(|c| (c / largest).max(0.0))
}

/// Length, angle from the grey axis, and hue, of a Lab colour.
#[derive(Clone, Copy)]
struct Msh {
    m: f64,
    s: f64,
    h: f64,
}

/// Saturation below which a colour has no hue.
const GREY: f64 = 0.05;
/// Lightness of the white between two saturated colours, at least.
const MIN_WHITE: f64 = 88.0;

impl Msh {
    fn of_rgb(rgb: [f64; 3]) -> Self {
        let [l, a, b] = lab_from_rgb(rgb);
        let m = (l * l + a * a + b * b).sqrt();
        let s = if m > 0.001 { (l / m).acos() } else { 0.0 };
        let h = if s > 0.001 { b.atan2(a) } else { 0.0 };
        Self { m, s, h }
    }

    fn rgb(self) -> [f64; 3] {
        let Self { m, s, h } = self;
        rgb_from_lab([m * s.cos(), m * s.sin() * h.cos(), m * s.sin() * h.sin()])
    }

    /// The hue that a grey of length `m` is given so that the way to this colour spins little.
    fn hue_of_grey(self, m: f64) -> f64 {
        if self.m >= m - 0.1 {
            return self.h;
        }
        let spin = self.s * (m * m - self.m * self.m).sqrt() / (self.m * self.s.sin());
        if self.h > -0.3 * std::f64::consts::PI {
            self.h + spin
        } else {
            self.h - spin
        }
    }
}

fn diverging(a: [f64; 3], b: [f64; 3], share: f64) -> [f64; 3] {
    use std::f64::consts::PI;
    let (mut from, mut to, mut share) = (Msh::of_rgb(a), Msh::of_rgb(b), share);
    let apart = (from.h - to.h).abs();
    let apart = apart.min(2.0 * PI - apart);
    if from.s > GREY && to.s > GREY && apart > 0.33 * PI {
        let white = Msh {
            m: from.m.max(to.m).max(MIN_WHITE),
            s: 0.0,
            h: 0.0,
        };
        if share < 0.5 {
            (to, share) = (white, 2.0 * share);
        } else {
            (from, share) = (white, 2.0 * share - 1.0);
        }
    }
    if from.s < GREY && to.s > GREY {
        from.h = to.hue_of_grey(from.m);
    } else if to.s < GREY && from.s > GREY {
        to.h = from.hue_of_grey(to.m);
    }
    let [m, s, h] = lerp([from.m, from.s, from.h], [to.m, to.s, to.h], share);
    Msh { m, s, h }.rgb()
}
