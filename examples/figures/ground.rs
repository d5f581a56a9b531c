//! The ground and the sky behind the cloud of Max's figures.

use std::path::Path;

use image::RgbImage;
use umbravox::{Error, Result};

/// Where the figures of the optical models expect it.
pub(crate) const GROUND: &str = "out/ground.png";

const SIZE: [u32; 2] = [384, 288];
/// Row of the horizon.
const HORIZON: f64 = 100.0;
const SKY: [[f64; 3]; 2] = [[52.0, 98.0, 168.0], [170.0, 200.0, 226.0]];
const FIELDS: [[f64; 3]; 3] = [
    [94.0, 121.0, 58.0],
    [142.0, 138.0, 78.0],
    [70.0, 96.0, 52.0],
];

/// Writes it: fields of three colours in perspective, hazier towards the horizon, under a sky that pales towards it.
///
/// # Errors
/// [`Error::Encode`].
pub(crate) fn write() -> Result<()> {
    let picture = RgbImage::from_fn(SIZE[0], SIZE[1], |x, y| {
        let (x, y) = (f64::from(x) + 0.5, f64::from(y) + 0.5);
        let below = y - HORIZON;
        let color = if below < 0.0 {
            mix(SKY[1], SKY[0], (-below / HORIZON).sqrt())
        } else {
            let depth = 900.0 / (below + 4.0);
            let across = (x - 0.5 * f64::from(SIZE[0])) * depth / 60.0;
            let field = (depth.floor() + 2.0 * (across / 3.0).floor()).rem_euclid(3.0);
            mix(FIELDS[field as usize], SKY[1], (depth / 120.0).min(0.8))
        };
        image::Rgb(color.map(|c| c as u8))
    });
    picture.save(Path::new(GROUND)).map_err(|e| Error::Encode {
        path: GROUND.into(),
        message: e.to_string(),
    })
}

fn mix(a: [f64; 3], b: [f64; 3], share: f64) -> [f64; 3] {
    std::array::from_fn(|i| a[i] + (b[i] - a[i]) * share)
}
