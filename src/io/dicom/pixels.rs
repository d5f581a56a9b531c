//! From stored pixels to voxels.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::atomic::Ordering;

use bytemuck::Pod;
use dicom_object::DefaultDicomObject;
use dicom_pixeldata::PixelDecoder;
use rayon::prelude::*;

use super::super::bundle::{Bundle, Member};
use super::super::components::{LUMA, Pick};
use super::super::decoded::Decoded;
use super::super::jpeg_size::claim_of;
use super::super::payload::zeroed;
use super::super::source::bad;
use super::super::watched::watched;
use super::super::{Limits, ReadOptions};
use super::claims::NativePixels;
use super::frame::{self, Frame, PIXEL_DATA, PixelFormat};
use super::{Element, Grid};
use crate::error::{Error, Result};
use crate::volume::{Rescale, Voxels};

/// Transfer syntax of run lengths (PS3.5, A.4.2).
const RLE_LOSSLESS: &str = "1.2.840.10008.1.2.5";

/// What the voxels become.
pub(super) struct Encoding {
    pub(super) element: Element,
    /// Of the whole volume. Frames that differ are brought to it.
    pub(super) rescale: Rescale,
    /// Whether each frame's own rescale is applied to its pixels.
    apply: bool,
}

impl Encoding {
    /// The smallest type that holds every frame: as stored when all frames have one rescale; else i16 when every
    /// rescaled value must be a whole number of that type; else f32.
    pub(super) fn common(path: &Path, frames: &[Frame]) -> Result<Self> {
        let Some(first) = frames.first() else {
            return Err(bad(path, "the series holds no picture".into()));
        };
        if frames.iter().all(|f| f.rescale == first.rescale) && first.format.allocated <= 16 {
            let element = match (first.format.allocated, first.format.signed) {
                (8, false) => Element::U8,
                (8, true) => Element::I8,
                (_, false) => Element::U16,
                (_, true) => Element::I16,
            };
            return Ok(Self {
                element,
                rescale: first.rescale,
                apply: false,
            });
        }
        let fits = |f: &Frame| {
            let (least, most) = f.format.range();
            let [a, b] = [least, most].map(|s| f.rescale.slope * s + f.rescale.intercept);
            f.rescale.slope.fract() == 0.0
                && f.rescale.intercept.fract() == 0.0
                && a.min(b) >= f64::from(i16::MIN)
                && a.max(b) <= f64::from(i16::MAX)
        };
        let element = if frames.iter().all(fits) {
            Element::I16
        } else {
            Element::F32
        };
        Ok(Self {
            element,
            rescale: Rescale::default(),
            apply: true,
        })
    }
}

impl PixelFormat {
    /// Smallest and largest stored pixel.
    fn range(self) -> (f64, f64) {
        let values = (self.stored as f64).exp2();
        if self.signed {
            (-values / 2.0, values / 2.0 - 1.0)
        } else {
            (0.0, values - 1.0)
        }
    }

    /// Bytes of a pixel.
    fn bytes(self) -> usize {
        (self.allocated / 8) as usize
    }

    /// Whether all allocated bits are the value.
    fn is_full(self) -> bool {
        self.stored == self.allocated
    }

    /// The pixel in its allocated bits: others than those stored may hold overlays, or nothing.
    #[inline]
    fn value(self, bits: u32) -> i64 {
        let bits = u64::from(bits) >> (self.high_bit + 1 - self.stored);
        let unused = 64 - self.stored;
        if self.signed {
            (bits << unused) as i64 >> unused
        } else {
            (bits << unused >> unused) as i64
        }
    }
}

/// Decodes all frames at once, each straight to its place.
pub(super) fn decode(
    bundle: &Bundle,
    frames: &[Frame],
    encoding: &Encoding,
    grid: Grid,
    options: &ReadOptions<'_>,
) -> Result<Decoded> {
    let samples = frames
        .first()
        .map_or(1, |frame| frame.format.samples as usize);
    let element = encoding.element;
    let pick = Pick::of(bundle.path(), samples, samples > 1, element, options)?;
    let decoder = Decoder {
        bundle,
        frames,
        grid,
        limits: options.limits,
        as_stored: !encoding.apply,
        pick,
    };
    let progress = options.progress;
    let whole = |value: i64, _: Rescale| value;
    let rescaled = |value: i64, r: Rescale| r.slope * value as f64 + r.intercept;
    Ok(Decoded::Numbers(match (element, encoding.apply) {
        (Element::U8, false) if pick == Pick::Color => {
            let gray = |v: i64, _: Rescale| [v as u8, v as u8, v as u8, u8::MAX];
            let color = |color: Color, _: Rescale| color.rgba();
            return Ok(Decoded::Colors(decoder.run(gray, color, progress)?));
        }
        (Element::U8, _) => Voxels::U8(decoder.numbers(|v, r| whole(v, r) as u8, progress)?),
        (Element::I8, _) => Voxels::I8(decoder.numbers(|v, r| whole(v, r) as i8, progress)?),
        (Element::U16, _) => Voxels::U16(decoder.numbers(|v, r| whole(v, r) as u16, progress)?),
        (Element::I16, false) => Voxels::I16(decoder.numbers(|v, r| whole(v, r) as i16, progress)?),
        (Element::I16, true) => {
            Voxels::I16(decoder.numbers(|v, r| rescaled(v, r) as i16, progress)?)
        }
        _ => Voxels::F32(decoder.numbers(|v, r| rescaled(v, r) as f32, progress)?),
    }))
}

struct Decoder<'a> {
    bundle: &'a Bundle,
    frames: &'a [Frame],
    grid: Grid,
    limits: Limits,
    /// Voxels are pixels as they are: of the same type, not rescaled.
    as_stored: bool,
    pick: Pick,
}

/// How pixels of one sample and colours become voxels.
struct Convert<G, C> {
    gray: G,
    color: C,
}

impl Decoder<'_> {
    /// Of colours the number that is picked.
    fn numbers<T: Pod + Send + Sync>(
        &self,
        convert: impl Fn(i64, Rescale) -> T + Send + Sync,
        progress: Option<&dyn Fn(u64, u64)>,
    ) -> Result<Vec<T>> {
        let picked = |color: Color, rescale| convert(color.number(self.pick), rescale);
        self.run(&convert, picked, progress)
    }

    fn run<T: Pod + Send + Sync>(
        &self,
        gray: impl Fn(i64, Rescale) -> T + Send + Sync,
        color: impl Fn(Color, Rescale) -> T + Send + Sync,
        progress: Option<&dyn Fn(u64, u64)>,
    ) -> Result<Vec<T>> {
        let convert = Convert { gray, color };
        let mut voxels = zeroed(self.grid.voxels)?;
        let slice = self.grid.voxels / self.frames.len().max(1);
        // Frames of one file are decoded together, so that it is opened once.
        let mut files: BTreeMap<usize, Vec<(&Frame, &mut [T])>> = BTreeMap::new();
        for (frame, out) in self.frames.iter().zip(voxels.chunks_mut(slice.max(1))) {
            files.entry(frame.member).or_default().push((frame, out));
        }
        let batches: Vec<_> = files.into_iter().collect();
        watched(progress, self.grid.bytes, |done| {
            batches.into_par_iter().try_for_each(|(member, frames)| {
                let bytes: u64 = frames.iter().map(|(_, out)| size_of_val(*out) as u64).sum();
                self.file(member, frames, &convert)?;
                done.fetch_add(bytes, Ordering::Relaxed);
                Ok::<(), Error>(())
            })
        })?;
        Ok(voxels)
    }

    fn file<T: Pod + Send>(
        &self,
        member: usize,
        frames: Vec<(&Frame, &mut [T])>,
        convert: &Convert<impl Fn(i64, Rescale) -> T + Sync, impl Fn(Color, Rescale) -> T + Sync>,
    ) -> Result<()> {
        let Some(member) = self.bundle.members().get(member) else {
            return Err(bad(self.bundle.path(), "a file is gone".into()));
        };
        let path = self.bundle.path_of(member);
        let native = frames.first().and_then(|(frame, _)| frame.native_pixels());
        if let Some(native) = native {
            return frames.into_par_iter().try_for_each(|(frame, out)| {
                self.native_frame(&path, member, native, frame, out, &convert.gray)
            });
        }
        let object = frame::open(&path, member, &self.limits)?;
        frames
            .into_par_iter()
            .try_for_each(|(frame, out)| decode_frame(&path, &object, frame, out, convert))
    }

    /// Uncompressed pixels, from the file straight to their place where nothing is to be converted.
    fn native_frame<T: Pod>(
        &self,
        path: &Path,
        member: &Member,
        native: NativePixels,
        frame: &Frame,
        out: &mut [T],
        convert: &impl Fn(i64, Rescale) -> T,
    ) -> Result<()> {
        let wanted = out.len().saturating_mul(frame.format.bytes());
        let before = (wanted as u64).saturating_mul(frame.index.into());
        let there = native.bytes.saturating_sub(before).min(wanted as u64) as usize;
        let offset = native.offset.saturating_add(before);
        let big = native.big_endian;
        if self.as_stored && size_of::<T>() == frame.format.bytes() {
            let bytes: &mut [u8] = bytemuck::cast_slice_mut(out);
            let got = member.read_at(offset, bytes.get_mut(..there).unwrap_or_default())?;
            check_whole(path, frame, got, wanted)?;
            clean_pixels(bytes, big, frame.format);
            return Ok(());
        }
        let mut bytes = zeroed(there)?;
        let got = member.read_at(offset, &mut bytes)?;
        check_whole(path, frame, got, wanted)?;
        convert_pixels(&bytes, big, frame, out, convert);
        Ok(())
    }
}

fn decode_frame<T>(
    path: &Path,
    object: &DefaultDicomObject,
    frame: &Frame,
    out: &mut [T],
    convert: &Convert<impl Fn(i64, Rescale) -> T, impl Fn(Color, Rescale) -> T>,
) -> Result<()> {
    let format = frame.format;
    let [bytes_per_sample, samples] = [format.bytes(), format.samples as usize];
    let wanted = out.len() * bytes_per_sample * samples;
    let element = object
        .get(PIXEL_DATA)
        .ok_or_else(|| bad(path, "PixelData is missing".into()))?;
    let decoded;
    let native;
    let pixels: &[u8] = if let Some(fragments) = element.fragments() {
        check_jpeg_sizes(path, fragments, frame)?;
        decoded = object.decode_pixel_data_frame(frame.index).map_err(|e| {
            bad(
                path,
                format!("cannot decode the pixels: {}", frame::chain(&e)),
            )
        })?;
        decoded.data()
    } else {
        native = element
            .to_bytes()
            .map_err(|e| bad(path, format!("PixelData is damaged: {e}")))?;
        let start = wanted.saturating_mul(frame.index as usize);
        native.get(start..).unwrap_or_default()
    };
    check_whole(path, frame, pixels.len(), wanted)?;
    if samples == 1 {
        convert_pixels(pixels, false, frame, out, &convert.gray);
        return Ok(());
    }
    let value = |bytes: &[u8]| {
        let bits = bytes
            .iter()
            .rev()
            .fold(0u32, |bits, &byte| bits << 8 | u32::from(byte));
        format.value(bits)
    };
    let coded = element.fragments().is_some();
    // Pixels between one sample of a kind and the next, and between one kind and the next.
    let [step, plane] = if format.planar && !coded {
        [1, out.len()]
    } else {
        [samples, 1]
    };
    let sample = |pixel: usize, kind: usize| {
        let at = (pixel * step + kind * plane) * bytes_per_sample;
        value(pixels.get(at..at + bytes_per_sample).unwrap_or_default())
    };
    // JPEG and JPEG 2000 decoders give red, green and blue.
    let run_length = object.meta().transfer_syntax() == RLE_LOSSLESS;
    let brightness_first = format.brightness_first && (!coded || run_length);
    for (i, out) in out.iter_mut().enumerate() {
        let color = Color {
            samples: [0, 1, 2].map(|kind| sample(i, kind)),
            brightness_first,
            is_wide: bytes_per_sample > 1,
        };
        *out = (convert.color)(color, frame.rescale);
    }
    Ok(())
}

/// Three samples of a pixel.
struct Color {
    samples: [i64; 3],
    /// Y, CB and CR instead of red, green and blue.
    brightness_first: bool,
    /// Of more than 8 bits.
    is_wide: bool,
}

fn luma(rgb: [f32; 3]) -> i64 {
    let shares = LUMA.iter().zip(rgb);
    let luma: f32 = shares.map(|(share, sample)| share * sample).sum();
    luma.round() as i64
}

impl Color {
    fn number(&self, pick: Pick) -> i64 {
        match pick {
            Pick::Component(kind) => self.samples.get(kind).copied().unwrap_or_default(),
            Pick::Luma | Pick::Color if self.brightness_first && !self.is_wide => {
                let [r, g, b, _] = self.rgba();
                luma([r, g, b].map(f32::from))
            }
            Pick::Luma | Pick::Color if self.brightness_first => {
                let [y, ..] = self.samples;
                y
            }
            Pick::Luma | Pick::Color => luma(self.samples.map(|sample| sample as f32)),
        }
    }

    /// Of samples of 8 bits. `YBR_FULL` to RGB: PS3.3, C.7.6.3.1.2.
    fn rgba(&self) -> [u8; 4] {
        let [a, b, c] = self.samples.map(|sample| sample as f32);
        let rgb = if self.brightness_first {
            let (blue, red) = (b - 128.0, c - 128.0);
            [
                a + 1.402 * red,
                a - 0.344_136 * blue - 0.714_136 * red,
                a + 1.772 * blue,
            ]
        } else {
            [a, b, c]
        };
        let [r, g, b] = rgb.map(|channel| channel.round() as u8);
        [r, g, b, u8::MAX]
    }
}

fn check_whole(path: &Path, frame: &Frame, have: usize, wanted: usize) -> Result<()> {
    if have >= wanted {
        return Ok(());
    }
    Err(bad(
        path,
        format!(
            "frame {} has {have} bytes of pixels; {} x {} pixels of {} bits need {wanted}: it is cut short or its \
             header is wrong",
            frame.index, frame.columns, frame.rows, frame.format.allocated
        ),
    ))
}

/// Pixels of 8 or 16 bits in the machine's byte order, without the bits that are not theirs: [`PixelFormat::value`] in the
/// pixels' own type.
fn clean_pixels(bytes: &mut [u8], big: bool, format: PixelFormat) {
    let swapped = big != cfg!(target_endian = "big");
    if format.is_full() && !(swapped && format.bytes() == 2) {
        return;
    }
    let (above, unused) = (
        format.allocated - 1 - format.high_bit,
        format.allocated - format.stored,
    );
    if format.bytes() == 1 {
        for byte in bytes {
            let bits = *byte << above;
            *byte = if format.signed {
                (bits as i8 >> unused) as u8
            } else {
                bits >> unused
            };
        }
        return;
    }
    for pixel in bytes.as_chunks_mut().0 {
        let bits = if swapped {
            u16::from_ne_bytes(*pixel).swap_bytes()
        } else {
            u16::from_ne_bytes(*pixel)
        } << above;
        let value = if format.signed {
            (bits as i16 >> unused) as u16
        } else {
            bits >> unused
        };
        *pixel = value.to_ne_bytes();
    }
}

fn convert_pixels<T>(
    bytes: &[u8],
    big: bool,
    frame: &Frame,
    out: &mut [T],
    convert: &impl Fn(i64, Rescale) -> T,
) {
    fn each<T, const N: usize>(bytes: &[u8], out: &mut [T], voxel: impl Fn([u8; N]) -> T) {
        for (out, &pixel) in out.iter_mut().zip(bytes.as_chunks().0) {
            *out = voxel(pixel);
        }
    }
    let voxel = |bits: u32| convert(frame.format.value(bits), frame.rescale);
    match (frame.format.bytes(), big) {
        (1, _) => each(bytes, out, |[b]| voxel(b.into())),
        (2, false) => each(bytes, out, |b| voxel(u16::from_le_bytes(b).into())),
        (2, true) => each(bytes, out, |b| voxel(u16::from_be_bytes(b).into())),
        (_, false) => each(bytes, out, |b| voxel(u32::from_le_bytes(b))),
        (_, true) => each(bytes, out, |b| voxel(u32::from_be_bytes(b))),
    }
}

/// A picture inside that claims another size than the object would make a decoder allocate what nobody asked for.
fn check_jpeg_sizes(path: &Path, fragments: &[Vec<u8>], frame: &Frame) -> Result<()> {
    if fragments.is_empty() {
        return Err(bad(path, "PixelData holds no fragment".into()));
    }
    let samples = frame.format.samples;
    for (size, components) in fragments.iter().filter_map(|f| claim_of(f)) {
        if size.map(u64::from) != [frame.columns, frame.rows] || components > samples {
            return Err(bad(
                path,
                format!(
                    "a coded picture has {size:?} pixels of {components} samples; the header says {} x {} of {samples}",
                    frame.columns, frame.rows
                ),
            ));
        }
    }
    Ok(())
}
