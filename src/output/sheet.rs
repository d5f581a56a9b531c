//! Contact sheets: pictures side by side, with captions.

use std::path::Path;

use embedded_graphics::mono_font::iso_8859_1::FONT_7X13;
use embedded_graphics::text::Alignment;

use super::canvas::{Canvas, quantized};
use crate::error::{Error, Result};
use crate::picture::Picture;
use crate::scene::Image;

const GAP: i32 = 6;
const LINE: i32 = 16;
const PAPER: [f64; 3] = [0.04, 0.045, 0.05];
const INK: [f64; 3] = [0.90, 0.91, 0.93];

/// A picture of a contact sheet.
#[derive(Clone, Debug)]
pub struct Frame {
    /// The picture.
    pub picture: Picture,
    /// Its background and colour management.
    pub image: Image,
    /// Lines below it, from the left; what is wider than the picture is cut off.
    pub caption: Vec<String>,
}

/// Writes pictures of one size, `columns` in a row, as PNG.
///
/// # Errors
/// [`Error::Invalid`] when there is none, or their sizes differ; [`Error::Io`], [`Error::Encode`].
pub fn write_sheet(path: &Path, frames: &[Frame], columns: u32) -> Result<()> {
    let size = frames.first().map(|f| f.picture.size);
    let Some([width, height]) = size.filter(|s| frames.iter().all(|f| f.picture.size == *s)) else {
        return Err(Error::invalid(
            "frames",
            "a contact sheet needs pictures, all of one size",
        ));
    };
    let lines = frames.iter().map(|f| f.caption.len()).max().unwrap_or(0) as i32;
    let cell = [width as i32 + GAP, height as i32 + GAP + lines * LINE];
    let columns = columns.clamp(1, frames.len() as u32);
    let rows = (frames.len() as u32).div_ceil(columns);
    let sheet = [columns * cell[0] as u32, rows * cell[1] as u32].map(|n| n + GAP as u32);
    let mut canvas = Canvas::new(sheet, PAPER);
    for (index, frame) in (0u32..).zip(frames) {
        let place = [index % columns, index / columns];
        let [left, top]: [i32; 2] = std::array::from_fn(|a| GAP + place[a] as i32 * cell[a]);
        let colors = frame.image.color_management;
        let background = colors.decode(frame.image.background);
        for (pixel, linear) in (0i32..).zip(frame.picture.over(background)) {
            let at = [left + pixel % width as i32, top + pixel / width as i32];
            canvas.set(at, quantized(colors.encode(linear)));
        }
        for (line, text) in (0i32..).zip(&frame.caption) {
            let letters = width as usize / FONT_7X13.character_size.width as usize;
            let text: String = text.chars().take(letters).collect();
            let base = top + height as i32 + LINE * line + LINE - 4;
            canvas.text(&text, [left + 1, base], (&FONT_7X13, Alignment::Left), INK);
        }
    }
    canvas.write(path)
}
