//! A small raster to draw plots and captions on.

use std::convert::Infallible;
use std::io::Cursor;
use std::path::Path;

use embedded_graphics::mono_font::{MonoFont, MonoTextStyle};
use embedded_graphics::pixelcolor::Rgb888;
use embedded_graphics::prelude::*;
use embedded_graphics::primitives::{Line, PrimitiveStyle, Rectangle};
use embedded_graphics::text::{Alignment, Text};
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};

use super::write_bytes;
use crate::error::{Error, Result};

/// Display colours, 8 bits a channel; what is drawn outside is not drawn.
pub(super) struct Canvas {
    size: [u32; 2],
    rgb: Vec<[u8; 3]>,
}

impl Canvas {
    pub(super) fn new([width, height]: [u32; 2], color: [f64; 3]) -> Self {
        Self {
            size: [width, height],
            rgb: vec![quantized(color); width as usize * height as usize],
        }
    }

    pub(super) fn set(&mut self, [x, y]: [i32; 2], rgb: [u8; 3]) {
        let [width, height] = self.size;
        if let (Ok(x), Ok(y)) = (u32::try_from(x), u32::try_from(y))
            && x < width
            && y < height
        {
            self.rgb[y as usize * width as usize + x as usize] = rgb;
        }
    }

    pub(super) fn fill(&mut self, [x, y]: [i32; 2], [width, height]: [u32; 2], color: [f64; 3]) {
        let area = Rectangle::new(Point::new(x, y), Size::new(width, height));
        let Ok(()) = area
            .into_styled(PrimitiveStyle::with_fill(embedded(color)))
            .draw(self);
    }

    pub(super) fn line(&mut self, from: [i32; 2], to: [i32; 2], width: u32, color: [f64; 3]) {
        let [from, to] = [from, to].map(|[x, y]| Point::new(x, y));
        let Ok(()) = Line::new(from, to)
            .into_styled(PrimitiveStyle::with_stroke(embedded(color), width))
            .draw(self);
    }

    /// Writes with the base line's start, middle or end at a place. Letters outside of Latin-1 become `?`.
    pub(super) fn text(
        &mut self,
        text: &str,
        [x, y]: [i32; 2],
        (font, alignment): (&MonoFont<'_>, Alignment),
        color: [f64; 3],
    ) {
        let style = MonoTextStyle::new(font, embedded(color));
        let Ok(_) = Text::with_alignment(text, Point::new(x, y), style, alignment).draw(self);
    }

    /// Writes a PNG.
    pub(super) fn write(&self, path: &Path) -> Result<()> {
        let mut encoded = Cursor::new(Vec::new());
        let [width, height] = self.size;
        let (compression, filter) = (CompressionType::Best, FilterType::Adaptive);
        PngEncoder::new_with_quality(&mut encoded, compression, filter)
            .write_image(
                self.rgb.as_flattened(),
                width,
                height,
                ExtendedColorType::Rgb8,
            )
            .map_err(|e| Error::Encode {
                path: path.to_path_buf(),
                message: e.to_string(),
            })?;
        write_bytes(path, &encoded.into_inner())
    }
}

/// Nearest 8-bit display colour.
pub(super) fn quantized(color: [f64; 3]) -> [u8; 3] {
    // `as` saturates; adding one half before it rounds to nearest.
    color.map(|c| (c * 255.0 + 0.5) as u8)
}

fn embedded(color: [f64; 3]) -> Rgb888 {
    let [r, g, b] = quantized(color);
    Rgb888::new(r, g, b)
}

impl OriginDimensions for Canvas {
    fn size(&self) -> Size {
        let [width, height] = self.size;
        Size::new(width, height)
    }
}

impl DrawTarget for Canvas {
    type Color = Rgb888;
    type Error = Infallible;

    fn draw_iter<I>(&mut self, pixels: I) -> Result<(), Infallible>
    where
        I: IntoIterator<Item = Pixel<Rgb888>>,
    {
        for Pixel(point, color) in pixels {
            self.set([point.x, point.y], [color.r(), color.g(), color.b()]);
        }
        Ok(())
    }
}
