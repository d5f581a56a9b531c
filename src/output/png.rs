//! PNG: opaque RGB, 8 or 16 bits per channel.

use std::fs::File;
use std::io::{BufReader, Cursor, Write};
use std::path::Path;

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder, ImageError};
use rayon::prelude::*;

use super::{Backdrop, Provenance, atomic};
use crate::error::{Error, Result};
use crate::picture::Picture;
use crate::scene::{ColorManagement, Image};

/// Bytes of the signature and of IHDR, which comes first and has a fixed size (PNG 1.2, sections 3.1 and 4.1.1).
const HEADER_BYTES: usize = 8 + 25;

/// First bytes of every file (PNG 1.2, section 3.1).
pub(super) const SIGNATURE: [u8; 8] = *b"\x89PNG\r\n\x1a\n";
/// What the decoder may allocate.
const READ_BYTES: usize = 64 << 20;

/// Keywords and texts before the pixels.
///
/// # Errors
/// What is wrong with the file.
pub(super) fn read_text(path: &Path) -> Result<Vec<(String, String)>, String> {
    let file = File::open(path).map_err(|e| e.to_string())?;
    let limits = ::png::Limits { bytes: READ_BYTES };
    let reader = ::png::Decoder::new_with_limits(BufReader::new(file), limits)
        .read_info()
        .map_err(|e| format!("is not a readable PNG: {e}"))?;
    let info = reader.info();
    let latin = info.uncompressed_latin1_text.iter();
    let latin = latin.map(|chunk| (chunk.keyword.clone(), chunk.text.clone()));
    let unicode = info.utf8_text.iter();
    let unicode = unicode.filter_map(|chunk| {
        let mut chunk = chunk.clone();
        // Others may compress theirs.
        chunk.decompress_text_with_limit(READ_BYTES).ok()?;
        Some((chunk.keyword.clone(), chunk.get_text().ok()?))
    });
    Ok(latin.chain(unicode).collect())
}

pub(super) fn write(
    path: &Path,
    picture: &Picture,
    image: &Image,
    backdrop: &Backdrop,
    provenance: Provenance,
) -> Result<()> {
    let encoded = encode(picture, image, backdrop).map_err(|e| match e {
        ImageError::IoError(source) => Error::io(path, source),
        other => Error::Encode {
            path: path.to_path_buf(),
            message: other.to_string(),
        },
    })?;
    let (header, body) = encoded.split_at(HEADER_BYTES.min(encoded.len()));
    let metadata = metadata(image.color_management, provenance);
    atomic::write(path, |file| {
        [header, &metadata, body]
            .into_iter()
            .try_for_each(|part| file.write_all(part))
            .map_err(|e| Error::io(path, e))
    })
}

fn encode(picture: &Picture, image: &Image, backdrop: &Backdrop) -> Result<Vec<u8>, ImageError> {
    let [width, height] = picture.size;
    let exposure = image.exposure.exp2();
    let row = |y: usize| {
        let pixels = y * width as usize..(y + 1) * width as usize;
        pixels.flat_map(move |i| {
            let linear = picture.pixel_over(i, exposure, backdrop.at(i));
            image.color_management.encode(linear)
        })
    };
    let rows = (0..height as usize).into_par_iter();
    // `as` saturates; adding one half before it rounds to nearest.
    let (color_type, samples): (_, Vec<u8>) = if image.png_bits == 16 {
        let quantized = |c: f64| (c * 65_535.0 + 0.5) as u16;
        // The encoder takes 16-bit samples in the machine's byte order.
        let bytes = rows.flat_map_iter(|y| row(y).map(quantized).flat_map(u16::to_ne_bytes));
        (ExtendedColorType::Rgb16, bytes.collect())
    } else {
        let quantized = |c: f64| (c * 255.0 + 0.5) as u8;
        let bytes = rows.flat_map_iter(|y| row(y).map(quantized));
        (ExtendedColorType::Rgb8, bytes.collect())
    };
    let mut encoded = Cursor::new(Vec::new());
    let (compression, filter) = (CompressionType::Default, FilterType::Adaptive);
    let encoder = PngEncoder::new_with_quality(&mut encoded, compression, filter);
    encoder.write_image(&samples, width, height, color_type)?;
    Ok(encoded.into_inner())
}

/// The chunks that `image` does not write: colour space and text.
fn metadata(colors: ColorManagement, provenance: Provenance) -> Vec<u8> {
    let mut chunks = Vec::new();
    if colors == ColorManagement::Linear {
        const PERCEPTUAL_INTENT: u8 = 0;
        push_chunk(&mut chunks, b"sRGB", &[PERCEPTUAL_INTENT]);
    }
    for (keyword, text) in provenance {
        if text.is_ascii() {
            let content = [keyword.as_bytes(), b"\0", text.as_bytes()].concat();
            push_chunk(&mut chunks, b"tEXt", &content);
        } else {
            // tEXt is Latin-1. iTXt is UTF-8: not compressed, no language, no translated keyword.
            let content = [keyword.as_bytes(), b"\0\0\0\0\0", text.as_bytes()].concat();
            push_chunk(&mut chunks, b"iTXt", &content);
        }
    }
    chunks
}

/// Length, type, content, CRC-32 of type and content (PNG 1.2, section 3.2).
fn push_chunk(chunks: &mut Vec<u8>, kind: &[u8; 4], content: &[u8]) {
    let mut crc = flate2::Crc::new();
    crc.update(kind);
    crc.update(content);
    chunks.extend((content.len() as u32).to_be_bytes());
    chunks.extend(kind);
    chunks.extend(content);
    chunks.extend(crc.sum().to_be_bytes());
}
