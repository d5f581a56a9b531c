//! Estimates of the field's gradient.

use glam::DVec3;

use super::{CubicKernel, Field};
use crate::scene::{Gradient, Interpolation};

/// From a point to the 27 points at most one voxel away on each axis, itself included.
fn offsets() -> impl Iterator<Item = DVec3> {
    (0..27).map(|i| DVec3::new(f64::from(i % 3), f64::from(i / 3 % 3), f64::from(i / 9)) - 1.0)
}

impl Field<'_> {
    /// World-space gradient at an index position, in values per mm; `None` outside the field.
    ///
    /// All estimators but the derivatives of the cubic kernels take differences of the trilinear field; where
    /// a tap would lie outside the field it is moved onto it.
    pub fn gradient_ws(&self, ix: DVec3, estimator: Gradient) -> Option<DVec3> {
        if !self.contains(ix) {
            return None;
        }
        let gradient_ix = match estimator {
            Gradient::CentralDifferences => self.central_differences(ix),
            Gradient::FourPoint => self.four_point(ix),
            Gradient::Regression => self.regression(ix),
            Gradient::Sobel => self.sobel(ix),
            Gradient::Bspline => self.derivative(ix, CubicKernel::Bspline),
            Gradient::CatmullRom => self.derivative(ix, CubicKernel::CatmullRom),
        };
        // Gradients transform by the inverse transpose of what moves points.
        Some(self.ix_from_world().matrix3.transpose() * gradient_ix)
    }

    fn tap(&self, ix: DVec3) -> f64 {
        self.sample_clamped(ix, Interpolation::Linear)
    }

    /// Between voxels of differences of their neighbours, over two voxels, or over one where the voxel is on the border.
    fn central_differences(&self, ix: DVec3) -> DVec3 {
        let last = self.last_ix();
        axes(|axis| {
            // Along the other axes taps do as well as voxels.
            let at_voxel = |voxel: f64| {
                let [mut below, mut above] = [ix; 2];
                below[axis] = (voxel - 1.0).max(0.0);
                above[axis] = (voxel + 1.0).min(last[axis]);
                (self.tap(above) - self.tap(below)) / (above[axis] - below[axis])
            };
            let first = ix[axis].floor().min(last[axis] - 1.0);
            let share = ix[axis] - first;
            (1.0 - share) * at_voxel(first) + share * at_voxel(first + 1.0)
        })
    }

    /// `(8 (F(+1) - F(-1)) - (F(+2) - F(-2))) / 12` on each axis.
    fn four_point(&self, ix: DVec3) -> DVec3 {
        axes(|axis| {
            let difference = |distance: f64| {
                let offset = DVec3::AXES[axis] * distance;
                self.tap(ix + offset) - self.tap(ix - offset)
            };
            (8.0 * difference(1.0) - difference(2.0)) / 12.0
        })
    }

    /// Slope of the plane that fits the 26 neighbours best, weighted by `1/distance` in voxels (Neumann,
    /// Csebfalvi, Koenig, Groeller 2000): `g_x = sum_k w_k x_k F_k / sum_k w_k x_k^2`.
    fn regression(&self, ix: DVec3) -> DVec3 {
        let (mut moments, mut norms) = (DVec3::ZERO, DVec3::ZERO);
        for offset in offsets().filter(|offset| *offset != DVec3::ZERO) {
            let weight = 1.0 / offset.length();
            moments += offset * (weight * self.tap(ix + offset));
            norms += offset * offset * weight;
        }
        moments / norms
    }

    /// Central differences on one axis, smoothed by `(1, 2, 1) / 4` on each of the others.
    fn sobel(&self, ix: DVec3) -> DVec3 {
        let mut gradient = DVec3::ZERO;
        for offset in offsets() {
            let smooth = (2.0 - offset.abs()) / 4.0;
            let weights = offset / 2.0
                * DVec3::new(
                    smooth.y * smooth.z,
                    smooth.z * smooth.x,
                    smooth.x * smooth.y,
                );
            gradient += weights * self.tap(ix + offset);
        }
        gradient
    }

    /// Derivative of the tri-cubic field: the kernel's derivative on one axis, the kernel on the others.
    fn derivative(&self, ix: DVec3, kernel: CubicKernel) -> DVec3 {
        let fraction = (ix - ix.floor()).to_array();
        axes(|axis| {
            let mut weights = fraction.map(|t| kernel.weights(t));
            weights[axis] = kernel.derivatives(fraction[axis]);
            self.sum_of_cube(ix, weights, |value| value)
        })
    }
}

fn axes(component: impl Fn(usize) -> f64) -> DVec3 {
    DVec3::new(component(0), component(1), component(2))
}
