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
    /// Share of the light from behind that comes through, by channel, where that differs by channel; else it is one minus the
    /// opacity.
    pub through: Option<Vec<[f32; 3]>>,
    /// Variance of every pixel's radiance, of pictures traced by Monte Carlo: that of the mean over its paths.
    pub variance: Option<Vec<[f32; 3]>>,
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
        self.composited(1.0, move |_| background)
    }

    /// `exposure` times the radiance of every pixel over what is `behind` it, by its number.
    pub fn composited(
        &self,
        exposure: f64,
        behind: impl Fn(usize) -> [f64; 3],
    ) -> impl Iterator<Item = [f64; 3]> {
        (0..self.rgba.len()).map(move |i| self.pixel_over(i, exposure, behind(i)))
    }

    /// One pixel of [`Picture::composited`].
    pub(crate) fn pixel_over(&self, pixel: usize, exposure: f64, behind: [f64; 3]) -> [f64; 3] {
        let [r, g, b, a] = self.rgba[pixel].map(f64::from);
        let through = match &self.through {
            Some(through) => through[pixel].map(f64::from),
            None => [1.0 - a; 3],
        };
        let color = [r, g, b];
        std::array::from_fn(|c| exposure * color[c] + through[c] * behind[c])
    }
}
