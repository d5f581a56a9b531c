//! Levels of detail: every level reproduces linear fields.

use glam::DVec3;

use super::check::{Check, Worst};
use super::synthetic::{Subject, difference, placed, point, sampled};
use crate::error::Result;
use crate::headless::Headless;

/// Values are rounded to 32 bits before they are filtered and after; the bands' opacity rises by 5 over the range of the values,
/// and rays pass some hundred samples.
const ROUNDING: f64 = 3e-5;
const BANDS: u32 = 4;
/// Voxels of the volume per voxel kept.
const REDUCTIONS: [f64; 3] = [2.0, 40.0, 120.0];

/// A ramp looks the same at any mixture of levels, without a step where they meet.
pub(super) fn checks(device: &Headless) -> Result<Vec<Check>> {
    let placement = placed([0.8, 1.1, 1.3], [0.0, 0.0, 1.0], 30.0, [0.0; 3]);
    let size = [58, 49, 40];
    let last = DVec3::new(57.0, 48.0, 39.0);
    let along = DVec3::new(0.5, 0.3, 0.2) / last;
    let volume = sampled(size, placement, |ix| ix.dot(along))?;
    let mut points = vec![point(0.0, [0.0; 3], 0.0)];
    for band in 0..BANDS {
        let middle = (f64::from(band) + 0.5) / f64::from(BANDS);
        let color = [0.9, 0.25 * f64::from(band), 0.4];
        points.push(point(middle - 0.06, color, 0.0));
        points.push(point(middle, color, 0.3));
        points.push(point(middle + 0.06, color, 0.0));
    }
    let mut session = Subject::new(volume, [40, 34], 1.0, points).session(device)?;
    let expected = session.frame()?;
    let mut worst = Worst::default();
    for data_reduction in REDUCTIONS {
        let mut settings = session.settings().clone();
        settings.storage.data_reduction = data_reduction;
        session.set_settings(settings)?;
        worst.add(difference(&expected, &session.frame()?));
    }
    Ok(vec![Check::new(
        "levels.ramp",
        "a linear field at mixed levels against the finest",
        "linear",
        worst.figure(),
        ROUNDING,
    )])
}
