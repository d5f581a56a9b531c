//! The host's cameras: a view as matrices, with normal or reversed depth, and depth buffers as they would draw them.

use glam::dcamera::rh::proj::vulkan::{orthographic, perspective, perspective_infinite_reverse};
use glam::dcamera::rh::view::look_to_mat4;
use glam::{DMat4, DVec3, DVec4};
use umbravox::embed::{DepthRange, FrameCamera};
use umbravox::scene::{Projection, View};

/// Projections that hosts use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum DepthKind {
    /// 0 near, 1 far.
    Normal,
    /// 1 near, 0 far.
    Reversed,
    /// 1 near, 0 at infinity; perspective only.
    ReversedInfinite,
}

/// Matrices of a view.
pub(crate) struct HostCamera {
    view_from_world: DMat4,
    clip_from_view: DMat4,
    range: DepthRange,
}

impl HostCamera {
    /// A view with depths between the distances `near` and `far` from the eye's plane, mm.
    pub(crate) fn new(view: &View, size: [u32; 2], kind: DepthKind, [near, far]: [f64; 2]) -> Self {
        let aspect = f64::from(size[0]) / f64::from(size[1]);
        // Exchanging the planes reverses depth.
        let (a, b) = match kind {
            DepthKind::Normal => (near, far),
            DepthKind::Reversed | DepthKind::ReversedInfinite => (far, near),
        };
        let projection = match view.projection {
            Projection::Perspective { fov_y } if kind == DepthKind::ReversedInfinite => {
                perspective_infinite_reverse(fov_y, aspect, near)
            }
            Projection::Perspective { fov_y } => perspective(fov_y, aspect, a, b),
            Projection::Orthographic { height } => {
                let (x, y) = (0.5 * height * aspect, 0.5 * height);
                orthographic(-x, x, -y, y, a, b)
            }
        };
        Self {
            view_from_world: look_to_mat4(view.eye, view.forward, view.up),
            clip_from_view: projection,
            range: match kind {
                DepthKind::Normal => DepthRange::Normal,
                DepthKind::Reversed | DepthKind::ReversedInfinite => DepthRange::Reversed,
            },
        }
    }

    pub(crate) fn frame_camera(&self) -> FrameCamera {
        FrameCamera::Matrices {
            view_from_world: self.view_from_world,
            clip_from_view: self.clip_from_view,
            depth: self.range,
        }
    }

    /// The depth that a rasterizer writes for a point; that of a cleared buffer for one outside the depth range.
    pub(crate) fn depth_of(&self, point_ws: DVec3) -> f32 {
        let clip = self.clip_from_view * self.view_from_world * point_ws.extend(1.0);
        let depth = (clip.z / clip.w) as f32;
        if clip.w > 0.0 && (0.0..=1.0).contains(&depth) {
            depth
        } else {
            self.cleared()
        }
    }

    /// What the depth buffer is cleared to.
    pub(crate) fn cleared(&self) -> f32 {
        match self.range {
            DepthRange::Normal => 1.0,
            DepthRange::Reversed => 0.0,
        }
    }

    /// The point that a depth means, at a place of the picture in pixels.
    pub(crate) fn point_ws(&self, pixel: [f64; 2], size: [u32; 2], depth: f32) -> DVec3 {
        let ndc = |i: usize| 2.0 * pixel[i] / f64::from(size[i]) - 1.0;
        let clip = DVec4::new(ndc(0), ndc(1), depth.into(), 1.0);
        let p = (self.clip_from_view * self.view_from_world).inverse() * clip;
        p.truncate() / p.w
    }
}
