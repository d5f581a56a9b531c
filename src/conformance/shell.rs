//! Pre-integration: thin features of the transfer function are never missed.

use glam::DVec3;

use super::check::Check;
use super::synthetic::{Subject, placed, point, sampled};
use crate::error::Result;
use crate::headless::Headless;
use crate::picture::Picture;
use crate::scene::Classification;

const SIZE: [u32; 2] = [48, 48];
const FINE: f64 = 0.02;
const COARSE: f64 = 1.0;

/// A shell one voxel thick, sampled every voxel, against itself sampled every fiftieth.
pub(super) fn checks(device: &Headless) -> Result<Vec<Check>> {
    let placement = placed([1.0; 3], [0.0, 0.0, 1.0], 0.0, [0.0; 3]);
    let middle = DVec3::splat(24.0);
    let volume = sampled([49; 3], placement, |ix| ix.distance(middle))?;
    let color = [0.9, 0.7, 0.4];
    let points = vec![
        point(0.0, color, 0.0),
        point(15.5, color, 0.0),
        point(16.0, color, 0.8),
        point(16.5, color, 0.0),
    ];
    let subject = Subject::new(volume, SIZE, 1.0, points);
    let picture = |classification, step| {
        let subject = subject.with(|scene| {
            scene.march.classification = Some(classification);
            scene.march.step = step;
        });
        subject.picture(device)
    };
    let converged = picture(Classification::Post, FINE)?;
    let of = |classification| -> Result<f64> {
        Ok(255.0 * rms(&picture(classification, COARSE)?, &converged))
    };
    Ok(vec![
        Check::new(
            "shell.preintegrated",
            "thin shell, step 1 against step 0.02, RMS",
            "1/255",
            of(Classification::Preintegrated)?,
            1.0,
        ),
        Check::noted(
            "shell.post",
            "the same with post-classification",
            "1/255",
            of(Classification::Post)?,
        ),
    ])
}

/// Of all channels of all pixels, linear.
fn rms(a: &Picture, b: &Picture) -> f64 {
    let channels = a.rgba.iter().flatten().zip(b.rgba.iter().flatten());
    let squares = channels.map(|(a, b)| f64::from(a - b).powi(2));
    (squares.sum::<f64>() / (4.0 * a.rgba.len() as f64)).sqrt()
}
