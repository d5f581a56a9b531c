//! Cameras, and the view they resolve to.

use glam::{DQuat, DVec3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::validate::{Number, all_finite, finite, numbers, positive, require};
use crate::error::{Error, Result};
use crate::volume::Volume;

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
    /// Frames the volume, upright in LPS (superior is up).
    Auto {
        /// Turn about the vertical, degrees; 0 looks from anterior to posterior, positive from the patient's left. Default 30.
        #[serde(default = "default_azimuth")]
        azimuth: f64,
        /// Height above the horizon, degrees, -90 to 90. Default 20.
        #[serde(default = "default_elevation")]
        elevation: f64,
        /// Magnification, > 0; at 1 all of what is framed is in the picture. Default 1.
        #[serde(default = "default_zoom")]
        zoom: f64,
        /// What is framed. Default "volume"; "visible" for volumes without a scene.
        #[serde(default)]
        frame: Framed,
    },
}

/// What the automatic camera frames.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Framed {
    /// The bounding sphere of the whole volume, whatever can be seen of it.
    #[default]
    Volume,
    /// What the transfer function shows, tightly. The picture moves when that changes.
    Visible,
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
            frame: Framed::default(),
        }
    }
}

/// Full vertical angle of view of the automatic camera at zoom 1, degrees.
pub(super) const AUTO_FOV_Y: f64 = 30.0;

/// Below this sine between line of sight and `up`, rounding would decide which way is up.
const MIN_UP_SINE: f64 = 1e-6;

impl Camera {
    /// Checks everything that does not need the volume.
    ///
    /// # Errors
    /// [`Error::Invalid`] naming the key that is out of range, or the keys that leave the view undefined.
    pub fn validate(&self) -> Result<()> {
        match *self {
            Self::Perspective {
                eye,
                target,
                up,
                fov_y,
            } => {
                require(
                    fov_y > 0.0 && fov_y < 180.0,
                    "camera.fov_y",
                    Number(fov_y),
                    "an angle > 0 and < 180 (degrees)",
                )?;
                let fov_y = fov_y.to_radians();
                look_at(eye, target, up, Projection::Perspective { fov_y }).map(drop)
            }
            Self::Orthographic {
                eye,
                target,
                up,
                height,
            } => {
                require(
                    positive(height),
                    "camera.height",
                    Number(height),
                    "a number > 0 (mm)",
                )?;
                look_at(eye, target, up, Projection::Orthographic { height }).map(drop)
            }
            Self::Auto {
                azimuth,
                elevation,
                zoom,
                frame: _,
            } => {
                require(
                    finite(azimuth),
                    "camera.azimuth",
                    Number(azimuth),
                    "a finite number (degrees)",
                )?;
                require(
                    (-90.0..=90.0).contains(&elevation),
                    "camera.elevation",
                    Number(elevation),
                    "an angle from -90 to 90 (degrees)",
                )?;
                require(positive(zoom), "camera.zoom", Number(zoom), "a number > 0")
            }
        }
    }

    /// The view of a picture of `size` pixels. Only the automatic camera looks at the volume and at `size`; it frames
    /// the whole volume. [`super::Scene::view`] frames what can be seen, where that is asked for.
    ///
    /// # Errors
    /// As [`Camera::validate`].
    pub fn view(&self, volume: &Volume, size: [u32; 2]) -> Result<View> {
        self.validate()?;
        match *self {
            Self::Perspective {
                eye,
                target,
                up,
                fov_y,
            } => {
                let fov_y = fov_y.to_radians();
                look_at(eye, target, up, Projection::Perspective { fov_y })
            }
            Self::Orthographic {
                eye,
                target,
                up,
                height,
            } => look_at(eye, target, up, Projection::Orthographic { height }),
            Self::Auto {
                azimuth,
                elevation,
                zoom,
                frame: _,
            } => Ok(frame(volume, size, azimuth, elevation, zoom)),
        }
    }
}

/// Orthonormal view from `eye` to `target`.
fn look_at(eye: [f64; 3], target: [f64; 3], up: [f64; 3], projection: Projection) -> Result<View> {
    for (at, vector) in [("eye", eye), ("target", target), ("up", up)] {
        require(
            all_finite(vector),
            &format!("camera.{at}"),
            numbers(vector),
            "three finite numbers (mm)",
        )?;
    }
    let [eye_ws, target_ws] = [eye, target].map(DVec3::from_array);
    let forward = (target_ws - eye_ws).try_normalize().ok_or_else(|| {
        Error::invalid(
            "camera.target",
            format!("{target:?} is where the eye is; give another point, to look at"),
        )
    })?;
    let across = DVec3::from_array(up)
        .try_normalize()
        .map(|up| forward.cross(up))
        .filter(|across| across.length() > MIN_UP_SINE)
        .ok_or_else(|| {
            Error::invalid(
                "camera.up",
                format!("{up:?} is 0 or along the line of sight; give a vector that is neither"),
            )
        })?;
    let right = across.normalize();
    Ok(View {
        eye: eye_ws,
        right,
        up: right.cross(forward),
        forward,
        projection,
    })
}

/// Upright in LPS (superior, +z, is up), with the volume's bounding sphere just inside the shorter side of the
/// picture at zoom 1. Zoom narrows the angle of view, so that the eye never enters the volume.
fn frame(volume: &Volume, size: [u32; 2], azimuth: f64, elevation: f64, zoom: f64) -> View {
    let (center, radius) = bounding_sphere(volume);
    let [right, up, backward] = auto_axes(azimuth, elevation);
    let [width, height] = size.map(f64::from);
    let tan_half = (0.5 * AUTO_FOV_Y.to_radians()).tan();
    let narrower = (tan_half * (width / height).min(1.0)).atan();
    View {
        eye: center + backward * (radius / narrower.sin()),
        right,
        up,
        forward: -backward,
        projection: Projection::Perspective {
            fov_y: 2.0 * (tan_half / zoom).atan(),
        },
    }
}

/// Right, up and backward (towards the eye) of the automatic camera; angles in degrees.
pub(super) fn auto_axes(azimuth: f64, elevation: f64) -> [DVec3; 3] {
    let (sin_a, cos_a) = azimuth.to_radians().sin_cos();
    let (sin_e, cos_e) = elevation.to_radians().sin_cos();
    let backward = DVec3::new(sin_a * cos_e, -cos_a * cos_e, sin_e);
    // Derivative of `backward` by elevation: perpendicular to it, and defined at the poles.
    let up = DVec3::new(-sin_a * sin_e, cos_a * sin_e, cos_e);
    [up.cross(backward), up, backward]
}

/// Centre and radius (mm) of the smallest sphere about the middle of the field that holds its eight corners.
fn bounding_sphere(volume: &Volume) -> (DVec3, f64) {
    let world_from_ix = volume.world_from_ix();
    let last_ix = DVec3::from_array(volume.size().map(|n| f64::from(n - 1)));
    let center = world_from_ix.transform_point3(0.5 * last_ix);
    let radius = (0..8u32)
        .map(|corner| {
            let is_far = |axis: u32| f64::from(corner >> axis & 1);
            let corner_ix = last_ix * DVec3::new(is_far(0), is_far(1), is_far(2));
            world_from_ix.transform_point3(corner_ix).distance(center)
        })
        .fold(0.0, f64::max);
    (center, radius)
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
    /// The view turned about the middle of the volume by `degrees`, around the picture's vertical; positive
    /// moves the eye to the picture's right.
    pub fn orbited(&self, volume: &Volume, degrees: f64) -> Self {
        let (center, _) = bounding_sphere(volume);
        let turn = DQuat::from_axis_angle(self.up, degrees.to_radians());
        Self {
            eye: center + turn * (self.eye - center),
            right: turn * self.right,
            up: self.up,
            forward: turn * self.forward,
            projection: self.projection,
        }
    }

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

    /// Where a picture of `size` pixels shows a point of the world, in pixels from the top left corner: the inverse of
    /// [`View::ray`]. `None` where no ray goes, at the eye of a perspective view and behind it.
    pub fn pixel(&self, point_ws: DVec3, size: [u32; 2]) -> Option<[f64; 2]> {
        let [w, h] = size.map(f64::from);
        let from_eye = point_ws - self.eye;
        let half_height = match self.projection {
            Projection::Perspective { fov_y } => (0.5 * fov_y).tan() * from_eye.dot(self.forward),
            Projection::Orthographic { height } => 0.5 * height,
        };
        (half_height > 0.0).then(|| {
            let x = from_eye.dot(self.right) / half_height;
            let y = from_eye.dot(self.up) / half_height;
            [0.5 * (x * h + w), 0.5 * h * (1.0 - y)]
        })
    }
}
