//! Cubic filter kernels.

/// A piecewise cubic kernel that reaches over four voxels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CubicKernel {
    /// Uniform B-spline, as an approximation: its weights are applied to the voxels themselves, not to the
    /// coefficients that would make it go through them (Sigg and Hadwiger 2005).
    Bspline,
    /// Catmull and Rom (1974); Keys's (1981) kernel with `a = -1/2`.
    CatmullRom,
}

impl CubicKernel {
    /// Both kernels.
    pub const ALL: [Self; 2] = [Self::Bspline, Self::CatmullRom];

    /// Weights of the voxels -1, 0, 1 and 2 at `t` of the way from voxel 0 to voxel 1.
    pub fn weights(self, t: f64) -> [f64; 4] {
        self.polynomials()
            .map(|[c0, c1, c2, c3]| c0 + t * (c1 + t * (c2 + t * c3)))
    }

    /// Derivatives of the weights by `t`.
    pub fn derivatives(self, t: f64) -> [f64; 4] {
        self.polynomials()
            .map(|[_, c1, c2, c3]| c1 + t * (2.0 * c2 + t * (3.0 * c3)))
    }

    /// Coefficients of 1, t, t^2, t^3 of each voxel's weight.
    fn polynomials(self) -> [[f64; 4]; 4] {
        let (divisor, coefficients) = match self {
            Self::Bspline => (
                6.0,
                [
                    [1.0, -3.0, 3.0, -1.0],
                    [4.0, 0.0, -6.0, 3.0],
                    [1.0, 3.0, 3.0, -3.0],
                    [0.0, 0.0, 0.0, 1.0],
                ],
            ),
            Self::CatmullRom => (
                2.0,
                [
                    [0.0, -1.0, 2.0, -1.0],
                    [2.0, 0.0, -5.0, 3.0],
                    [0.0, 1.0, 4.0, -3.0],
                    [0.0, 0.0, -1.0, 1.0],
                ],
            ),
        };
        coefficients.map(|polynomial| polynomial.map(|c| c / divisor))
    }
}
