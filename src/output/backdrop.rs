//! What a picture is composited over.

use std::path::Path;

use image::{ImageDecoder, ImageReader, imageops::FilterType};

use crate::error::{Error, Result};
use crate::scene::{Image, MAX_IMAGE_SIZE};

/// Linear radiance behind the volume, one colour or a picture.
#[derive(Clone, Debug, PartialEq)]
pub enum Backdrop {
    /// The same behind every pixel.
    Color([f64; 3]),
    /// By pixel, rows from the top.
    Picture(Vec<[f64; 3]>),
}

impl Backdrop {
    /// `image.background_image` stretched to the size, or `image.background`.
    ///
    /// # Errors
    /// [`Error::Io`] when the file cannot be read; [`Error::Invalid`] when it is neither PNG nor OpenEXR, larger than 16384 pixels on an
    /// edge, or damaged.
    pub fn of(image: &Image) -> Result<Self> {
        let Some(path) = &image.background_image else {
            return Ok(Self::Color(image.color_management.decode(image.background)));
        };
        let picture = read(path)?;
        let is_linear = matches!(
            picture,
            image::DynamicImage::ImageRgb32F(_) | image::DynamicImage::ImageRgba32F(_)
        );
        let [width, height] = image.size;
        let picture = picture.into_rgb32f();
        let stretched = if picture.dimensions() == (width, height) {
            picture
        } else {
            image::imageops::resize(&picture, width, height, FilterType::Triangle)
        };
        let linear = |c: [f64; 3]| {
            if is_linear {
                c
            } else {
                image.color_management.decode(c)
            }
        };
        let pixels = stretched.pixels().map(|p| linear(p.0.map(f64::from)));
        Ok(Self::Picture(pixels.collect()))
    }

    /// Behind a pixel, by its number.
    pub fn at(&self, pixel: usize) -> [f64; 3] {
        match self {
            Self::Color(color) => *color,
            Self::Picture(pixels) => pixels.get(pixel).copied().unwrap_or_default(),
        }
    }
}

fn read(path: &Path) -> Result<image::DynamicImage> {
    let invalid = |message: String| Error::invalid(path.display().to_string(), message);
    let reader = ImageReader::open(path)
        .and_then(ImageReader::with_guessed_format)
        .map_err(|e| Error::io(path, e))?;
    if !matches!(
        reader.format(),
        Some(image::ImageFormat::Png | image::ImageFormat::OpenExr)
    ) {
        return Err(invalid("is neither PNG nor OpenEXR".into()));
    }
    let decoder = reader.into_decoder().map_err(|e| invalid(e.to_string()))?;
    let (width, height) = decoder.dimensions();
    if width.max(height) > MAX_IMAGE_SIZE {
        return Err(invalid(format!(
            "{width} x {height} pixels; give at most {MAX_IMAGE_SIZE} on an edge"
        )));
    }
    image::DynamicImage::from_decoder(decoder).map_err(|e| invalid(e.to_string()))
}
