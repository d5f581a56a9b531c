//! Pictures of radiance from all around.

use std::path::Path;

use crate::error::{Error, Result};

/// Largest width of a map, pixels.
#[cfg(feature = "image-io")]
const MAX_WIDTH: usize = 16_384;

/// An equirectangular picture of linear radiance; rows from the upper edge, columns as [`super::Environment::path`] says.
#[derive(Clone, Debug, PartialEq)]
pub struct EnvironmentMap {
    size: [u32; 2],
    radiance: Vec<[f32; 3]>,
}

impl EnvironmentMap {
    /// # Errors
    /// [`Error::Invalid`] when the number of pixels is not that of the size, or radiance is negative or not finite.
    pub fn new(size: [u32; 2], radiance: Vec<[f32; 3]>) -> Result<Self> {
        let at = "lighting.environment";
        let pixels = size[0] as usize * size[1] as usize;
        if pixels == 0 || pixels != radiance.len() {
            let message = format!("{} pixels for a map of {size:?}", radiance.len());
            return Err(Error::invalid(at, message));
        }
        if let Some(bad) = radiance
            .iter()
            .flatten()
            .find(|c| !(c.is_finite() && **c >= 0.0))
        {
            let message = format!("the map holds {bad}; radiance is finite and >= 0");
            return Err(Error::invalid(at, message));
        }
        Ok(Self { size, radiance })
    }

    /// Reads OpenEXR or Radiance HDR.
    ///
    /// # Errors
    /// [`Error::Io`] when the file cannot be read; [`Error::Invalid`] when it is neither, too large (16384 x 8192 at most), damaged,
    /// or as for [`EnvironmentMap::new`]; [`Error::Invalid`] in builds without the feature `image-io`.
    pub fn read(path: &Path) -> Result<Self> {
        let bytes = std::fs::read(path).map_err(|e| Error::io(path, e))?;
        let (size, radiance) =
            decode(&bytes).map_err(|m| Error::invalid(path.display().to_string(), m))?;
        Self::new(size, radiance)
    }

    /// Width and height, pixels.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Pixels by rows.
    pub fn radiance(&self) -> &[[f32; 3]] {
        &self.radiance
    }
}

type Decoded = std::result::Result<([u32; 2], Vec<[f32; 3]>), String>;

/// Claims are checked before pixels are decoded.
#[cfg(feature = "image-io")]
fn check_size(width: usize, height: usize) -> std::result::Result<(), String> {
    if width == 0 || height == 0 || width > MAX_WIDTH || height > MAX_WIDTH / 2 {
        return Err(format!(
            "a map of {width} x {height} pixels; give at most {MAX_WIDTH} x {}",
            MAX_WIDTH / 2
        ));
    }
    Ok(())
}

#[cfg(not(feature = "image-io"))]
fn decode(_bytes: &[u8]) -> Decoded {
    Err("this build reads no pictures (feature \"image-io\")".into())
}

#[cfg(feature = "image-io")]
fn decode(bytes: &[u8]) -> Decoded {
    use image::{ImageDecoder, codecs::hdr::HdrDecoder, codecs::openexr::OpenExrDecoder};
    let cursor = std::io::Cursor::new(bytes);
    if bytes.starts_with(b"#?") {
        let decoder = HdrDecoder::new(cursor).map_err(|e| e.to_string())?;
        return pixels(decoder);
    }
    if !bytes.starts_with(&[0x76, 0x2f, 0x31, 0x01]) {
        return Err("is neither OpenEXR nor Radiance HDR".into());
    }
    let decoder = OpenExrDecoder::new(cursor).map_err(|e| e.to_string())?;
    return pixels(decoder);

    fn pixels(decoder: impl ImageDecoder) -> Decoded {
        let (width, height) = decoder.dimensions();
        check_size(width as usize, height as usize)?;
        let picture = image::DynamicImage::from_decoder(decoder).map_err(|e| e.to_string())?;
        let picture = picture.into_rgb32f();
        let radiance = picture.pixels().map(|p| p.0).collect();
        Ok(([width, height], radiance))
    }
}
