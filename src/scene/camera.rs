//! Cameras, and the view they resolve to.

use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A camera, in world space (mm, LPS).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "type", rename_all = "lowercase", deny_unknown_fields)]
pub enum Camera {
    /// Rays from one point.
    Perspective {
        /// Where rays start.
        eye: [f64; 3],
        /// What the middle of the picture shows.
        target: [f64; 3],
        /// Roughly up; not along the line of sight.
        up: [f64; 3],
        /// Full vertical angle of view, degrees, in (0,180).
        fov_y: f64,
    },
    /// Parallel rays.
    Orthographic {
        /// Middle of the plane where rays start.
        eye: [f64; 3],
        /// What the middle of the picture shows.
        target: [f64; 3],
        /// Roughly up; not along the line of sight.
        up: [f64; 3],
        /// Height of the picture, mm, > 0.
        height: f64,
    },
    /// Frames the whole volume, upright in LPS (superior is up).
    Auto {
        /// Turn about the vertical, degrees; 0 looks from anterior to posterior. Default 30.
        #[serde(default = "default_azimuth")]
        azimuth: f64,
        /// Height above the horizon, degrees, in [-90,90]. Default 20.
        #[serde(default = "default_elevation")]
        elevation: f64,
        /// Magnification, > 0; 1 frames the bounding sphere. Default 1.
        #[serde(default = "default_zoom")]
        zoom: f64,
    },
}

fn default_azimuth() -> f64 {
    30.0
}
fn default_elevation() -> f64 {
    20.0
}
fn default_zoom() -> f64 {
    1.0
}

impl Default for Camera {
    fn default() -> Self {
        Self::Auto {
            azimuth: default_azimuth(),
            elevation: default_elevation(),
            zoom: default_zoom(),
        }
    }
}

/// How rays leave the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// Full vertical angle of view, radians.
    Perspective {
        /// Radians.
        fov_y: f64,
    },
    /// Height of the picture, mm.
    Orthographic {
        /// mm.
        height: f64,
    },
}

/// A resolved camera: orthonormal `right`, `up`, `forward`, world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Where rays start (perspective), or the middle of the plane where they start.
    pub eye: DVec3,
    /// `forward x up`, to the right of the picture.
    pub right: DVec3,
    /// To the top of the picture.
    pub up: DVec3,
    /// Line of sight.
    pub forward: DVec3,
    /// Kind and extent.
    pub projection: Projection,
}

impl View {
    /// Origin and unit direction of the ray through a point of the picture, in pixels from the top left
    /// corner (pixel centres at +0.5).
    pub fn ray(&self, pixel: [f64; 2], size: [u32; 2]) -> (DVec3, DVec3) {
        let [w, h] = size.map(f64::from);
        let x = (2.0 * pixel[0] - w) / h;
        let y = 1.0 - 2.0 * pixel[1] / h;
        match self.projection {
            Projection::Perspective { fov_y } => {
                let t = (0.5 * fov_y).tan();
                let d = self.forward + self.right * (x * t) + self.up * (y * t);
                (self.eye, d / d.length())
            }
            Projection::Orthographic { height } => (
                self.eye + (self.right * x + self.up * y) * (0.5 * height),
                self.forward,
            ),
        }
    }
}
