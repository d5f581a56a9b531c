//! Stacks of PNG and JPEG pictures: a folder or archive, in natural order of the names.
//!
//! Decoders: the `image` crate. Such files do not say how far pixels and pictures are apart; 1 mm is taken.

use std::io::Cursor;
use std::path::Path;

use glam::DVec3;
use image::{DynamicImage, ImageFormat, ImageReader};

use super::bundle::{Bundle, Member};
use super::formats::{BundleReader, FileReader};
use super::grid;
use super::slices::{Picture, check_claim, stack};
use super::source::bad;
use super::{Format, Limits, ReadOptions};
use crate::error::Result;
use crate::volume::{Rescale, Volume, Voxels};

pub(super) const FORMAT: Format = Format {
    name: "PNG and JPEG stacks",
    extensions: &["png", "jpg", "jpeg"],
    reads: "a folder or archive of pictures of one size, 8 or 16 bits, gray or colour",
    file: Some(FileReader {
        recognise: |head, _| kind_of(head).is_some(),
        read: refuse_one,
    }),
    bundle: Some(BundleReader {
        recognise: |bundle| bundle.members().iter().any(is_picture),
        read,
    }),
};

fn kind_of(head: &[u8]) -> Option<ImageFormat> {
    if head.starts_with(b"\x89PNG\r\n\x1a\n") {
        Some(ImageFormat::Png)
    } else if head.starts_with(b"\xff\xd8\xff") {
        Some(ImageFormat::Jpeg)
    } else {
        None
    }
}

fn is_picture(member: &Member) -> bool {
    kind_of(&member.head(8)).is_some()
}

fn refuse_one(path: &Path, _: &ReadOptions<'_>) -> Result<Volume> {
    Err(bad(
        path,
        "this is one picture; give the folder or archive that holds all slices".into(),
    ))
}

fn read(bundle: &Bundle, options: &ReadOptions<'_>) -> Result<Volume> {
    let path = bundle.path();
    if options.strict {
        return Err(bad(
            path,
            "pictures do not say how far they are apart, and volume.strict refuses to guess".into(),
        ));
    }
    let pictures: Vec<&Member> = bundle.members().iter().filter(|m| is_picture(m)).collect();
    let path_of = |k: usize| {
        let member = pictures.get(k);
        member.map_or_else(|| path.to_path_buf(), |member| bundle.path_of(member))
    };
    let limits = options.limits;
    let decode = |k: usize| match pictures.get(k) {
        Some(member) => decode(&path_of(k), member, &limits),
        None => Err(bad(path, "there is no picture".into())),
    };
    let (voxels, grid) = stack(path, pictures.len(), decode, path_of, options)?;
    let world_from_ix = grid::placement(path, "spacing", DVec3::AXES, DVec3::ZERO)?;
    grid::volume(path, voxels, grid, world_from_ix, Rescale::default())
}

fn decode(path: &Path, member: &Member, max: &Limits) -> Result<Picture> {
    let bytes = member.bytes(max)?;
    let damaged = |e: &dyn std::fmt::Display| bad(path, format!("cannot decode the picture: {e}"));
    let format = kind_of(&bytes).ok_or_else(|| bad(path, "this is no PNG or JPEG".into()))?;
    let size = ImageReader::with_format(Cursor::new(&bytes[..]), format)
        .into_dimensions()
        .map_err(|e| damaged(&e))?;
    check_claim(path, size.into(), bytes.len() as u64)?;
    let mut reader = ImageReader::with_format(Cursor::new(&bytes[..]), format);
    let mut limits = image::Limits::default();
    // What a slice takes, with room for colours and the decoder.
    limits.max_alloc = Some(max.max_bytes);
    reader.limits(limits);
    let image = reader.decode().map_err(|e| damaged(&e))?;
    let (columns, rows) = (image.width(), image.height());
    let (channels, samples) = match image {
        DynamicImage::ImageLuma8(i) => (1, Voxels::U8(i.into_raw())),
        DynamicImage::ImageLumaA8(i) => (2, Voxels::U8(i.into_raw())),
        DynamicImage::ImageRgb8(i) => (3, Voxels::U8(i.into_raw())),
        DynamicImage::ImageRgba8(i) => (4, Voxels::U8(i.into_raw())),
        DynamicImage::ImageLuma16(i) => (1, Voxels::U16(i.into_raw())),
        DynamicImage::ImageLumaA16(i) => (2, Voxels::U16(i.into_raw())),
        DynamicImage::ImageRgb16(i) => (3, Voxels::U16(i.into_raw())),
        DynamicImage::ImageRgba16(i) => (4, Voxels::U16(i.into_raw())),
        other => return Err(damaged(&format!("{:?} is not read", other.color()))),
    };
    Ok(Picture {
        columns,
        rows,
        channels,
        samples,
    })
}
