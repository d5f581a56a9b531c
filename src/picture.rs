//! A rendered picture, before background and encoding.

/// Pixels row by row, row 0 at the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Linear radiance that reaches the eye from the volume alone (premultiplied, without the background), and
    /// accumulated opacity.
    pub rgba: Vec<[f32; 4]>,
    /// Distance along the ray, mm, at which accumulated opacity first reaches the scene's depth threshold;
    /// infinite where it never does.
    pub depth: Vec<f32>,
    /// Distance along the ray, mm, at which half the light from behind is left; infinite where more is.
    pub median_depth: Vec<f32>,
    /// What else each ray found; see `measured`.
    pub measure: Vec<f32>,
    /// What `measure` is.
    pub measured: Measured,
    /// Field samples that each ray took.
    pub samples: Vec<u32>,
}

/// What a projection measures of every ray besides its colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measured {
    /// Mean distance, mm, of what is seen, weighted by how much of it is; infinite where nothing is.
    ExpectedDepth,
    /// Optical depth of the whole ray.
    OpticalDepth,
    /// The value that was projected, in the file's own units; not a number where the volume is missed.
    Value,
}

impl Picture {
    /// Radiance of every pixel over a linear `background`: `C + (1 - A) background`.
    pub fn over(&self, background: [f64; 3]) -> impl Iterator<Item = [f64; 3]> {
        self.rgba.iter().map(move |&[r, g, b, a]| {
            let transparency = 1.0 - f64::from(a);
            let over = |c: f32, behind: f64| f64::from(c) + transparency * behind;
            [
                over(r, background[0]),
                over(g, background[1]),
                over(b, background[2]),
            ]
        })
    }
}
