//! Closed forms of the volume rendering integral (Max 1995), for fields that have one.
//!
//! Lengths are in mm; `unit` is the length that opacities refer to.

/// Extinction per mm of a medium with `opacity` over `unit`: `tau = -ln(1-a)/u`.
pub fn extinction(opacity: f64, unit: f64) -> f64 {
    -(-opacity).ln_1p() / unit
}

/// Opacity of `length` of a homogeneous medium: `1 - exp(-tau length)`.
pub fn slab_opacity(opacity: f64, unit: f64, length: f64) -> f64 {
    -(-extinction(opacity, unit) * length).exp_m1()
}

/// Length of a line inside a sphere, at `distance` from its centre.
pub fn sphere_chord(radius: f64, distance: f64) -> f64 {
    2.0 * (radius * radius - distance * distance).max(0.0).sqrt()
}

/// Opacity of `length` of a medium whose opacity over `unit` rises linearly along the way, from `first` to
/// `last`, both in `[0,1]`.
///
/// Optical depth: `-(1/u) integral_0^L ln(1 - a(s)) ds = (L/u) (F(1-last) - F(1-first)) / (last - first)`
/// with `F(w) = w ln w - w`.
pub fn ramp_opacity(first: f64, last: f64, unit: f64, length: f64) -> f64 {
    let antiderivative = |w: f64| if w > 0.0 { w * w.ln() - w } else { 0.0 };
    let rise = last - first;
    // Below this the quotient cancels; the middle is then exact to the square of the rise.
    let per_unit = if rise.abs() < 1e-5 {
        extinction(0.5 * (first + last), 1.0)
    } else {
        (antiderivative(1.0 - last) - antiderivative(1.0 - first)) / rise
    };
    -(-per_unit * length / unit).exp_m1()
}

/// One channel of a homogeneous emitting and absorbing medium over a background:
/// `I = I0 T + c (1 - T)`.
pub fn emission_absorption(source: f64, background: f64, transparency: f64) -> f64 {
    background * transparency + source * (1.0 - transparency)
}

/// One channel of a medium of constant extinction (per mm) whose source colour changes linearly along the
/// way, from `first` to `last`, over black:
/// `I = integral_0^L c(s) tau exp(-tau s) ds = c0 (1 - T) + (c1 - c0) (1 - T (1 + tau L)) / (tau L)`.
pub fn color_ramp(first: f64, last: f64, extinction: f64, length: f64) -> f64 {
    let depth = extinction * length;
    let transparency = (-depth).exp();
    first * (1.0 - transparency) + (last - first) * (1.0 - transparency * (1.0 + depth)) / depth
}
