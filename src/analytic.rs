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

/// Mean extinction, per unit distance, of a medium whose opacity over it runs linearly between two in `[0,1]`:
/// `-integral_0^1 ln(w_0 + (w_1 - w_0) s) ds` with `w = 1 - a`. Finite unless both are opaque.
pub fn mean_extinction(first: f64, last: f64) -> f64 {
    let [clearest, densest] = [first.min(last), first.max(last)];
    let w = 1.0 - clearest;
    // With r = (w_1 - w_0) / w_0 it is -ln w_0 + 1 - (1 + r) ln(1 + r) / r, where nothing cancels.
    let r = (clearest - densest) / w;
    let fall = if r == 0.0 || clearest == 1.0 {
        1.0
    } else if r == -1.0 {
        0.0
    } else {
        (1.0 + r) * r.ln_1p() / r
    };
    extinction(clearest, 1.0) + 1.0 - fall
}

/// Opacity of `length` of a medium whose opacity over `unit` rises linearly along the way, from `first` to
/// `last`, both in `[0,1]`.
pub fn ramp_opacity(first: f64, last: f64, unit: f64, length: f64) -> f64 {
    -(-mean_extinction(first, last) * length / unit).exp_m1()
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

/// Mean of `exp(-x s)` over `s` in `[0,1]`, of an optical depth `x`: `(1 - exp(-x)) / x`, 1 for 0.
pub fn mean_transmittance(depth: f64) -> f64 {
    if depth == 0.0 {
        1.0
    } else {
        -(-depth).exp_m1() / depth
    }
}

/// One channel of a homogeneous medium that adds `source` per mm whatever its extinction (per mm), over a background
/// (Max 1995, eq. 7): `I = I0 T + g (1 - T) / tau`, `I0 + g L` without extinction.
pub fn glow(source: f64, background: f64, extinction: f64, length: f64) -> f64 {
    let depth = extinction * length;
    background * (-depth).exp() + source * length * mean_transmittance(depth)
}

/// A homogeneous slab that parallel light falls on from above.
#[derive(Clone, Copy, Debug)]
pub struct LitSlab {
    /// Optical depth straight through.
    pub depth: f64,
    /// Cosine of the angle between the light and the normal, in (0,1].
    pub cos_light: f64,
    /// Albedo times the phase function for the angle of scattering (1/sr) times the irradiance across the beam.
    pub scattered: f64,
}

impl LitSlab {
    /// Radiance scattered once and leaving at the side of the light, `cos_eye` in (0,1] from the normal
    /// (Chandrasekhar 1950): `S mu_0 / (mu_0 + mu) (1 - exp(-tau (1/mu_0 + 1/mu)))`.
    pub fn reflected(self, cos_eye: f64) -> f64 {
        let way = 1.0 / self.cos_light + 1.0 / cos_eye;
        self.scattered / cos_eye * self.depth * mean_transmittance(self.depth * way)
    }

    /// Radiance scattered once and leaving at the far side: `S mu_0 / (mu_0 - mu) (exp(-tau/mu_0) - exp(-tau/mu))`, its
    /// limit for equal cosines.
    pub fn transmitted(self, cos_eye: f64) -> f64 {
        let difference = 1.0 / self.cos_light - 1.0 / cos_eye;
        let through = (-self.depth / cos_eye).exp();
        self.scattered / cos_eye
            * self.depth
            * through
            * mean_transmittance(self.depth * difference)
    }
}
