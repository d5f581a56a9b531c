//! TIFF: the pages of one file, or a folder or archive of files of one page.
//!
//! Decoder: the `tiff` crate (classic and BigTIFF, strips and tiles; uncompressed, LZW, Deflate, PackBits, JPEG).
//! How pages are meant and spaced is in the first page's description: OME-XML or ImageJ. Other files do not say it
//! reliably; 1 mm is taken.

mod claims;
mod description;

use std::fs::File;
use std::io::{BufReader, Cursor, Read, Seek};
use std::path::Path;

use ::tiff::ColorType;
use ::tiff::decoder::{Decoder, DecodingResult};
use ::tiff::tags::Tag;
use glam::DVec3;

use self::description::{Layout, Pages};
use super::bundle::{Bundle, Member};
use super::formats::{BundleReader, FileReader};
use super::narrow::Wide;
use super::slices::{Picture, check_claim, stack};
use super::source::bad;
use super::{Format, Limits, ReadOptions, grid};
use crate::error::{Error, Result};
use crate::volume::{Content, Metadata, Rescale, Volume, Voxels};

pub(super) const FORMAT: Format = Format {
    name: "TIFF",
    extensions: &["tif", "tiff", "ome.tif", "ome.tiff", "btf"],
    reads: "multi-page files, OME-TIFF and ImageJ included, and folders or archives of single pages",
    file: Some(FileReader {
        recognise: |head, _| is_tiff(head),
        read: read_pages,
    }),
    bundle: Some(BundleReader {
        recognise: |bundle| bundle.members().iter().any(is_member),
        read: read_folder,
    }),
};

/// Most pages that are looked for.
const MAX_PAGES: usize = 1 << 20;

fn is_tiff(head: &[u8]) -> bool {
    [b"II*\0", b"MM\0*", b"II+\0", b"MM\0+"]
        .iter()
        .any(|magic| head.starts_with(&magic[..]))
}

fn is_member(member: &Member) -> bool {
    is_tiff(&member.head(4))
}

fn read_pages(path: &Path, options: &ReadOptions<'_>) -> Result<Volume> {
    let limits = options.limits;
    let file = || File::open(path).map_err(|e| Error::io(path, e));
    claims::check(path, &mut BufReader::new(file()?))?;
    let open = || decoder(path, BufReader::new(file()?), &limits);
    let file_len = std::fs::metadata(path)
        .map_err(|e| Error::io(path, e))?
        .len();
    let mut first = open()?;
    let mut pages = 1;
    while first.more_images() {
        pages += 1;
        if pages > MAX_PAGES {
            return Err(bad(
                path,
                format!("more than {MAX_PAGES} pages, or pages in a circle"),
            ));
        }
        first.next_image().map_err(|e| damaged(path, &e))?;
    }
    first.seek_to_image(0).map_err(|e| damaged(path, &e))?;
    // A description that cannot be read is damage, not absence: pages would be taken for what they are not.
    let text = first
        .find_tag(Tag::ImageDescription)
        .and_then(|value| value.map(|v| v.into_string()).transpose())
        .map_err(|e| damaged(path, &e))?
        .unwrap_or_default();
    let resolution = [Tag::XResolution, Tag::YResolution].map(|tag| resolution(&mut first, tag));
    let color = first.colortype().map_err(|e| damaged(path, &e))?;
    let pages = Pages {
        count: pages,
        channels: channels_of(path, color)?,
        resolution,
    };
    let layout = Layout::of(path, &text, &pages, options)?;
    if layout.spacing.is_none() && options.strict {
        return Err(bad(
            path,
            "no OME-XML or ImageJ description says the spacing, and volume.strict refuses to guess"
                .into(),
        ));
    }
    let decode = |k: usize| {
        let mut decoder = open()?;
        decoder
            .seek_to_image(layout.page(k))
            .map_err(|e| damaged(path, &e))?;
        page(path, &mut decoder, file_len)
    };
    // Channels of several pages are picked by page.
    let channel = if layout.channels > 1 {
        None
    } else {
        options.channel
    };
    let picked = ReadOptions {
        channel,
        color: options.color,
        limits,
        progress: options.progress,
        ..ReadOptions::default()
    };
    let (voxels, grid) = stack(path, layout.slices, decode, |_| path.to_path_buf(), &picked)?;
    let spacing = layout.spacing.unwrap_or([1.0; 3]);
    let spacing = grid::positive_spacing(path, "PhysicalSize or spacing", spacing)?;
    let [x, y, z] = DVec3::AXES;
    let steps = [x * spacing.x, y * spacing.y, z * spacing.z];
    let world_from_ix = grid::placement(path, "spacing", steps, DVec3::ZERO)?;
    let volume = grid::volume(path, voxels, grid, world_from_ix, Rescale::default())?;
    let content = layout
        .is_ome
        .then(|| (Content::Microscopy, "OME-XML".into()));
    Ok(volume.with_metadata(Metadata {
        content,
        ..Metadata::default()
    }))
}

fn read_folder(bundle: &Bundle, options: &ReadOptions<'_>) -> Result<Volume> {
    let path = bundle.path();
    let files: Vec<&Member> = bundle.members().iter().filter(|m| is_member(m)).collect();
    if let &[one] = files.as_slice() {
        return match one.file() {
            Some(file) => read_pages(file, options),
            None => Err(bad(
                path,
                "the archive holds one TIFF file; give it unpacked".into(),
            )),
        };
    }
    if options.strict {
        return Err(bad(
            path,
            "single pages do not say how far they are apart, and volume.strict refuses to guess"
                .into(),
        ));
    }
    let path_of = |k: usize| {
        let file = files.get(k);
        file.map_or_else(|| path.to_path_buf(), |file| bundle.path_of(file))
    };
    let limits = options.limits;
    let decode = |k: usize| {
        let file = files
            .get(k)
            .ok_or_else(|| bad(path, "there is no page".into()))?;
        let bytes = file.bytes(&limits)?;
        let path = path_of(k);
        claims::check(&path, &mut Cursor::new(&bytes[..]))?;
        let mut decoder = decoder(&path, Cursor::new(&bytes[..]), &limits)?;
        if decoder.more_images() {
            return Err(bad(
                &path,
                "one of several files has several pages itself".into(),
            ));
        }
        page(&path, &mut decoder, bytes.len() as u64)
    };
    let (voxels, grid) = stack(path, files.len(), decode, path_of, options)?;
    let world_from_ix = grid::placement(path, "spacing", DVec3::AXES, DVec3::ZERO)?;
    grid::volume(path, voxels, grid, world_from_ix, Rescale::default())
}

fn damaged(path: &Path, error: &::tiff::TiffError) -> Error {
    bad(path, format!("cannot decode the TIFF file: {error}"))
}

fn decoder<R: Read + Seek>(path: &Path, reader: R, limits: &Limits) -> Result<Decoder<R>> {
    let decoder = Decoder::new(reader).map_err(|e| damaged(path, &e))?;
    let mut allowed = ::tiff::decoder::Limits::default();
    let bytes = usize::try_from(limits.max_bytes).unwrap_or(usize::MAX);
    allowed.decoding_buffer_size = bytes;
    allowed.intermediate_buffer_size = bytes;
    Ok(decoder.with_limits(allowed))
}

/// Pixels per unit of length.
fn resolution<R: Read + Seek>(decoder: &mut Decoder<R>, tag: Tag) -> Option<f64> {
    match decoder.find_tag(tag).ok()?? {
        ::tiff::decoder::ifd::Value::Rational(n, d) => Some(f64::from(n) / f64::from(d)),
        _ => None,
    }
    .filter(|r| r.is_finite() && *r > 0.0)
}

fn page<R: Read + Seek>(path: &Path, decoder: &mut Decoder<R>, file_len: u64) -> Result<Picture> {
    let error = |e: ::tiff::TiffError| damaged(path, &e);
    let (columns, rows) = decoder.dimensions().map_err(error)?;
    check_claim(path, [columns, rows], file_len)?;
    let color = decoder.colortype().map_err(error)?;
    let channels = channels_of(path, color)?;
    if color.bit_depth() < 8 {
        return Err(bad(
            path,
            format!(
                "{} bits per pixel are not read; 8 to 64 are",
                color.bit_depth()
            ),
        ));
    }
    let samples = match decoder.read_image().map_err(error)? {
        DecodingResult::U8(v) => Voxels::U8(v),
        DecodingResult::I8(v) => Voxels::I8(v),
        DecodingResult::U16(v) => Voxels::U16(v),
        DecodingResult::I16(v) => Voxels::I16(v),
        DecodingResult::F32(v) => Voxels::F32(v),
        DecodingResult::F16(v) => Voxels::F32(v.into_iter().map(f32::from).collect()),
        DecodingResult::U32(v) => float(path, &v)?,
        DecodingResult::I32(v) => float(path, &v)?,
        DecodingResult::U64(v) => float(path, &v)?,
        DecodingResult::I64(v) => float(path, &v)?,
        DecodingResult::F64(v) => float(path, &v)?,
    };
    let wanted = (columns as usize)
        .checked_mul(rows as usize)
        .and_then(|n| n.checked_mul(channels));
    if wanted != Some(samples.len()) {
        return Err(bad(
            path,
            format!(
                "a page of {columns} x {rows} pixels of {channels} samples has {} samples; planes of samples that \
                 lie apart are not read",
                samples.len()
            ),
        ));
    }
    Ok(Picture {
        columns,
        rows,
        channels,
        samples,
    })
}

fn channels_of(path: &Path, color: ColorType) -> Result<usize> {
    Ok(match color {
        ColorType::Gray(_) | ColorType::Palette(_) => 1,
        ColorType::GrayA(_) => 2,
        ColorType::RGB(_) => 3,
        ColorType::RGBA(_) => 4,
        ColorType::Multiband { num_samples, .. } => num_samples.into(),
        other => return Err(bad(path, format!("pixels of {other:?} are not read"))),
    })
}

/// Wide samples as floats: the type must not depend on what one page happens to hold.
fn float<T: Wide>(path: &Path, wide: &[T]) -> Result<Voxels> {
    let floats: Option<Vec<f32>> = wide.iter().map(|v| v.to_f32()).collect();
    floats.map(Voxels::F32).ok_or_else(|| {
        bad(
            path,
            "some samples of 32 or 64 bits cannot be held exactly by a 32-bit float".into(),
        )
    })
}
