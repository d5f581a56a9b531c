//! Cameras as rays: a scene's view, or a host's matrices.

use glam::{DAffine3, DMat3, DMat4, DVec2, DVec3, DVec4};

use crate::scene::{Projection, View};

/// How depth grows in the host's depth buffer (Vulkan: 0 to 1).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DepthRange {
    /// 0 near, 1 far.
    #[default]
    Normal,
    /// 1 near, 0 far ("reversed z").
    Reversed,
}

impl DepthRange {
    /// The depth of a cleared depth buffer.
    pub(crate) fn far(self) -> f32 {
        match self {
            Self::Normal => 1.0,
            Self::Reversed => 0.0,
        }
    }
}

/// Rays by pixel, world space: through `(px, py)` from the top left corner a ray starts at
/// `origin + px origin_dx + py origin_dy` and goes along `direction + px direction_dx + py direction_dy`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct RayBasis {
    pub(crate) origin: DVec3,
    pub(crate) origin_dx: DVec3,
    pub(crate) origin_dy: DVec3,
    pub(crate) direction: DVec3,
    pub(crate) direction_dx: DVec3,
    pub(crate) direction_dy: DVec3,
}

impl RayBasis {
    /// The rays of a scene's view.
    pub(crate) fn from_view(view: &View, size_px: [u32; 2]) -> Self {
        let [width, height] = size_px.map(f64::from);
        let corner = view.up - view.right * (width / height);
        let (dx, dy) = (view.right * (2.0 / height), -view.up * (2.0 / height));
        match view.projection {
            Projection::Perspective { fov_y } => {
                let t = (0.5 * fov_y).tan();
                Self {
                    origin: view.eye,
                    origin_dx: DVec3::ZERO,
                    origin_dy: DVec3::ZERO,
                    direction: view.forward + corner * t,
                    direction_dx: dx * t,
                    direction_dy: dy * t,
                }
            }
            Projection::Orthographic { height } => {
                let half = 0.5 * height;
                Self {
                    origin: view.eye + corner * half,
                    origin_dx: dx * half,
                    origin_dy: dy * half,
                    direction: view.forward,
                    direction_dx: DVec3::ZERO,
                    direction_dy: DVec3::ZERO,
                }
            }
        }
    }

    /// The rays of a host's camera: from the eye, or from the near plane of an orthographic projection, which may lie behind
    /// the eye. Perspective (off-centre and infinite too) or orthographic; any handedness. `None` when the matrices cannot
    /// be inverted.
    pub(crate) fn from_matrices(
        view_from_world: DMat4,
        clip_from_view: DMat4,
        depth: DepthRange,
        size_px: [u32; 2],
    ) -> Option<Self> {
        let world_from_view = invert(view_from_world)?;
        let view_from_clip = invert(clip_from_view)?;
        // View-space point at a depth inside (0, 1), where even infinite projections are finite.
        let point = |px: f64, py: f64, z: f64| {
            let ndc_x = 2.0 * px / f64::from(size_px[0]) - 1.0;
            let ndc_y = 2.0 * py / f64::from(size_px[1]) - 1.0;
            let p = view_from_clip * DVec4::new(ndc_x, ndc_y, z, 1.0);
            p.truncate() / p.w
        };
        let (nearest, near, far) = match depth {
            DepthRange::Normal => (0.0, 0.25, 0.75),
            DepthRange::Reversed => (1.0, 0.75, 0.25),
        };
        // Along the axis, away from the eye.
        let forward = (point(0.0, 0.0, far).z - point(0.0, 0.0, near).z).signum();
        let perspective = clip_from_view.z_axis.w != 0.0;
        let ray = |px: f64, py: f64| {
            let (a, b) = (point(px, py, near), point(px, py, far));
            // Scaled to unit depth along the axis, so that origins and directions are affine in the pixel.
            let direction = (b - a) / ((b.z - a.z) * forward);
            let origin = if perspective {
                DVec3::ZERO
            } else {
                point(px, py, nearest)
            };
            (
                world_from_view.transform_point3(origin),
                world_from_view.transform_vector3(direction),
            )
        };
        let ((origin, direction), x, y) = (ray(0.0, 0.0), ray(1.0, 0.0), ray(0.0, 1.0));
        let basis = Self {
            origin,
            origin_dx: x.0 - origin,
            origin_dy: y.0 - origin,
            direction,
            direction_dx: x.1 - direction,
            direction_dy: y.1 - direction,
        };
        let finite = [
            origin,
            direction,
            basis.origin_dx,
            basis.origin_dy,
            basis.direction_dx,
            basis.direction_dy,
        ]
        .iter()
        .all(|v| v.is_finite());
        finite.then_some(basis)
    }

    /// The smallest rectangle of the picture, first corner and last, in which points lie; `None` where one of them is not in front of
    /// the eye, or rays neither have an eye nor are parallel.
    pub(crate) fn rectangle_of(&self, points: &[DVec3]) -> Option<[DVec2; 2]> {
        let has_eye = self.origin_dx == DVec3::ZERO && self.origin_dy == DVec3::ZERO;
        let parallel = self.direction_dx == DVec3::ZERO && self.direction_dy == DVec3::ZERO;
        let [dx, dy] = match (has_eye, parallel) {
            (true, false) => [self.direction_dx, self.direction_dy],
            (false, true) => [self.origin_dx, self.origin_dy],
            _ => return None,
        };
        let pixel_from_world = DMat3::from_cols(dx, dy, self.direction).inverse();
        let none = [DVec2::INFINITY, DVec2::NEG_INFINITY];
        points.iter().try_fold(none, |[low, high], &point| {
            let at = pixel_from_world * (point - self.origin);
            let pixel = if has_eye {
                at.truncate() / at.z
            } else {
                at.truncate()
            };
            let seen = (parallel || at.z > 0.0) && pixel.is_finite();
            seen.then(|| [low.min(pixel), high.max(pixel)])
        })
    }
}

fn invert(m: DMat4) -> Option<DMat4> {
    let inverse = m.inverse();
    (m.determinant() != 0.0 && inverse.is_finite()).then_some(inverse)
}

/// Index from clip space, for the points of a depth buffer.
pub(crate) fn ix_from_clip(
    ix_from_world: DAffine3,
    view_from_world: DMat4,
    clip_from_view: DMat4,
) -> DMat4 {
    DMat4::from(ix_from_world) * (clip_from_view * view_from_world).inverse()
}

#[cfg(test)]
mod tests {
    use glam::dcamera::rh::proj::vulkan::{
        orthographic, perspective, perspective_infinite_reverse,
    };
    use glam::dcamera::rh::view::look_to_mat4;
    use glam::{DMat4, DVec2, DVec3};

    use super::{DepthRange, RayBasis};
    use crate::scene::{Projection, View};

    const SIZE: [u32; 2] = [64, 48];

    fn view(projection: Projection) -> View {
        let forward = DVec3::new(0.2, 0.9, -0.3).normalize_or_zero();
        let right = forward.cross(DVec3::Z).normalize_or_zero();
        View {
            eye: DVec3::new(10.0, -50.0, 20.0),
            right,
            up: right.cross(forward),
            forward,
            projection,
        }
    }

    fn same(a: RayBasis, b: RayBasis) {
        for pixel in [[0.5, 0.5], [63.5, 0.5], [13.0, 40.0]] {
            let at = |r: RayBasis| {
                let o = r.origin + r.origin_dx * pixel[0] + r.origin_dy * pixel[1];
                let d = r.direction + r.direction_dx * pixel[0] + r.direction_dy * pixel[1];
                (o, d.normalize_or_zero())
            };
            let ((o1, d1), (o2, d2)) = (at(a), at(b));
            assert!(
                o1.distance(o2) < 1e-9 && d1.distance(d2) < 1e-9,
                "{o1} {o2}, {d1} {d2}"
            );
        }
    }

    #[test]
    fn matrices_give_the_rays_of_the_view() {
        let aspect = 64.0 / 48.0;
        let apex = view(Projection::Perspective { fov_y: 0.7 });
        let rays = RayBasis::from_view(&apex, SIZE);
        for (projection, depth) in [
            (perspective(0.7, aspect, 1.0, 500.0), DepthRange::Normal),
            (
                perspective_infinite_reverse(0.7, aspect, 1.0),
                DepthRange::Reversed,
            ),
        ] {
            let v = look_to_mat4(apex.eye, apex.forward, apex.up);
            same(
                rays,
                RayBasis::from_matrices(v, projection, depth, SIZE).unwrap(),
            );
        }
        let parallel = view(Projection::Orthographic { height: 30.0 });
        let v = look_to_mat4(parallel.eye, parallel.forward, parallel.up);
        let p = orthographic(-20.0, 20.0, -15.0, 15.0, 0.0, 100.0);
        same(
            RayBasis::from_view(&parallel, SIZE),
            RayBasis::from_matrices(v, p, DepthRange::Normal, SIZE).unwrap(),
        );
    }

    #[test]
    fn the_basis_is_the_view() {
        for projection in [
            Projection::Perspective { fov_y: 1.1 },
            Projection::Orthographic { height: 7.0 },
        ] {
            let view = view(projection);
            let rays = RayBasis::from_view(&view, SIZE);
            for pixel in [[0.5, 0.5], [40.5, 3.5]] {
                let (o, d) = view.ray(pixel, SIZE);
                let o2 = rays.origin + rays.origin_dx * pixel[0] + rays.origin_dy * pixel[1];
                let d2 =
                    rays.direction + rays.direction_dx * pixel[0] + rays.direction_dy * pixel[1];
                assert!(o.distance(o2) < 1e-9 && d.distance(d2.normalize_or_zero()) < 1e-9);
            }
        }
    }

    #[test]
    fn points_lie_in_the_pixels_whose_rays_meet_them() {
        for projection in [
            Projection::Perspective { fov_y: 0.7 },
            Projection::Orthographic { height: 30.0 },
        ] {
            let view = view(projection);
            let rays = RayBasis::from_view(&view, SIZE);
            let pixels = [[3.25, 40.0], [60.0, 7.5], [-12.0, 20.0]];
            let points = pixels.map(|pixel| {
                let (origin, direction) = view.ray(pixel, SIZE);
                origin + (20.0 + pixel[1]) * direction
            });
            let [low, high] = rays.rectangle_of(&points).unwrap();
            assert!(low.distance(DVec2::new(-12.0, 7.5)) < 1e-9, "{low}");
            assert!(high.distance(DVec2::new(60.0, 40.0)) < 1e-9, "{high}");
            let behind = [points[0], view.eye - view.forward];
            let seen = rays.rectangle_of(&behind).is_some();
            assert_eq!(seen, matches!(projection, Projection::Orthographic { .. }));
        }
    }

    #[test]
    fn singular_matrices_are_refused() {
        assert_eq!(
            RayBasis::from_matrices(DMat4::ZERO, DMat4::IDENTITY, DepthRange::Normal, SIZE),
            None
        );
    }
}
