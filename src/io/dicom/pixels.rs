//! From stored pixels to voxels.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};

use dicom_object::DefaultDicomObject;
use dicom_pixeldata::PixelDecoder;
use rayon::prelude::*;

use super::super::ReadOptions;
use super::super::bundle::Bundle;
use super::super::components::{LUMA, Pick};
use super::super::jpeg_size::claim_of;
use super::super::payload::reserve;
use super::super::source::bad;
use super::frame::{self, Frame, NUMBER_OF_FRAMES, PIXEL_DATA, PixelFormat};
use super::{Element, Grid};
use crate::error::{Error, Result};
use crate::volume::{Rescale, Voxels};

/// Transfer syntax of run lengths (PS3.5, A.4.2).
const RLE_LOSSLESS: &str = "1.2.840.10008.1.2.5";

/// How transfer syntaxes of JPEG 2000 start (PS3.5, A.4.4, A.4.9).
const JPEG_2000: [&str; 2] = ["1.2.840.10008.1.2.4.9", "1.2.840.10008.1.2.4.20"];

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

    /// The pixel in its allocated bits: others than those stored may hold overlays, or nothing.
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
) -> Result<Voxels> {
    let samples = frames
        .first()
        .map_or(1, |frame| frame.format.samples as usize);
    let decoder = Decoder {
        bundle,
        frames,
        grid,
        pick: Pick::of(bundle.path(), samples, samples > 1, options.channel)?,
    };
    let progress = options.progress;
    let whole = |value: i64, _: Rescale| value;
    let rescaled = |value: i64, r: Rescale| r.slope * value as f64 + r.intercept;
    Ok(match (encoding.element, encoding.apply) {
        (Element::U8, _) => Voxels::U8(decoder.run(|v, r| whole(v, r) as u8, progress)?),
        (Element::I8, _) => Voxels::I8(decoder.run(|v, r| whole(v, r) as i8, progress)?),
        (Element::U16, _) => Voxels::U16(decoder.run(|v, r| whole(v, r) as u16, progress)?),
        (Element::I16, false) => Voxels::I16(decoder.run(|v, r| whole(v, r) as i16, progress)?),
        (Element::I16, true) => Voxels::I16(decoder.run(|v, r| rescaled(v, r) as i16, progress)?),
        _ => Voxels::F32(decoder.run(|v, r| rescaled(v, r) as f32, progress)?),
    })
}

struct Decoder<'a> {
    bundle: &'a Bundle,
    frames: &'a [Frame],
    grid: Grid,
    pick: Pick,
}

impl Decoder<'_> {
    fn run<T: Copy + Default + Send>(
        &self,
        convert: impl Fn(i64, Rescale) -> T + Sync,
        progress: Option<&dyn Fn(u64, u64)>,
    ) -> Result<Vec<T>> {
        let mut voxels = reserve(self.grid.voxels)?;
        voxels.resize(self.grid.voxels, T::default());
        let slice = self.grid.voxels / self.frames.len().max(1);
        // Frames of one file are decoded together, so that it is opened once.
        let mut files: BTreeMap<usize, Vec<(&Frame, &mut [T])>> = BTreeMap::new();
        for (frame, out) in self.frames.iter().zip(voxels.chunks_mut(slice.max(1))) {
            files.entry(frame.member).or_default().push((frame, out));
        }
        let (done, all) = (AtomicU64::new(0), self.grid.bytes);
        let batches: Vec<_> = files.into_iter().collect();
        // Progress is told by the calling thread alone, between pieces of work.
        let per_report = (batches.len() / 32).max(16);
        let mut rest = batches.into_iter();
        loop {
            let piece: Vec<_> = rest.by_ref().take(per_report).collect();
            if piece.is_empty() {
                break;
            }
            piece.into_par_iter().try_for_each(|(member, frames)| {
                let bytes: u64 = frames.iter().map(|(_, out)| size_of_val(*out) as u64).sum();
                self.file(member, frames, &convert)?;
                done.fetch_add(bytes, Ordering::Relaxed);
                Ok::<(), Error>(())
            })?;
            if let Some(progress) = progress {
                progress(done.load(Ordering::Relaxed).min(all), all);
            }
        }
        Ok(voxels)
    }

    fn file<T: Send>(
        &self,
        member: usize,
        frames: Vec<(&Frame, &mut [T])>,
        convert: &(impl Fn(i64, Rescale) -> T + Sync),
    ) -> Result<()> {
        let Some(member) = self.bundle.members().get(member) else {
            return Err(bad(self.bundle.path(), "a file is gone".into()));
        };
        let path = self.bundle.path_of(member);
        let object = frame::open(&path, member)?;
        frames.into_par_iter().try_for_each(|(frame, out)| {
            decode_frame(&path, &object, frame, self.pick, out, convert)
        })
    }
}

fn decode_frame<T>(
    path: &Path,
    object: &DefaultDicomObject,
    frame: &Frame,
    pick: Pick,
    out: &mut [T],
    convert: &impl Fn(i64, Rescale) -> T,
) -> Result<()> {
    let format = frame.format;
    let [bytes_per_sample, samples] = [format.allocated / 8, format.samples].map(|n| n as usize);
    let wanted = out.len() * bytes_per_sample * samples;
    let element = object
        .get(PIXEL_DATA)
        .ok_or_else(|| bad(path, "PixelData is missing".into()))?;
    let decoded;
    let native;
    let pixels: &[u8] = if let Some(fragments) = element.fragments() {
        check_jpeg_sizes(path, object, fragments, frame)?;
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
    let Some(pixels) = pixels.get(..wanted) else {
        return Err(bad(
            path,
            format!(
                "frame {} has {} bytes of pixels; {} x {} pixels of {} bits need {wanted}: it is cut short or its \
                 header is wrong",
                frame.index,
                pixels.len(),
                frame.columns,
                frame.rows,
                frame.format.allocated
            ),
        ));
    };
    let value = |bytes: &[u8]| {
        let bits = bytes
            .iter()
            .rev()
            .fold(0u32, |bits, &byte| bits << 8 | u32::from(byte));
        format.value(bits)
    };
    if samples == 1 {
        for (out, bytes) in out.iter_mut().zip(pixels.chunks_exact(bytes_per_sample)) {
            *out = convert(value(bytes), frame.rescale);
        }
        return Ok(());
    }
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
    let pick = match pick {
        Pick::Luma if format.brightness_first && (!coded || run_length) => Pick::Component(0),
        other => other,
    };
    for (i, out) in out.iter_mut().enumerate() {
        let value = match pick {
            Pick::Component(kind) => sample(i, kind),
            Pick::Luma => {
                let shares = LUMA.iter().enumerate();
                let luma: f32 = shares
                    .map(|(kind, share)| share * sample(i, kind) as f32)
                    .sum();
                luma.round() as i64
            }
        };
        *out = convert(value, frame.rescale);
    }
    Ok(())
}

/// A picture inside that claims another size than the object would make a decoder allocate what nobody asked for.
fn check_jpeg_sizes(
    path: &Path,
    object: &DefaultDicomObject,
    fragments: &[Vec<u8>],
    frame: &Frame,
) -> Result<()> {
    if fragments.is_empty() {
        return Err(bad(path, "PixelData holds no fragment".into()));
    }
    let samples = frame.format.samples;
    // A picture may be cut into fragments. Of an object of one they are put together; of others, those of JPEG 2000 must
    // be one each: its decoder trusts that the size was looked at.
    let frames = object
        .get(NUMBER_OF_FRAMES)
        .and_then(|e| e.to_int::<usize>().ok())
        .unwrap_or(1);
    let whole = (frames == 1).then(|| fragments.concat());
    let pictures = whole.as_ref().map_or(fragments, std::slice::from_ref);
    let uid = object.meta().transfer_syntax();
    if pictures.len() != frames && JPEG_2000.iter().any(|start| uid.starts_with(start)) {
        return Err(bad(
            path,
            format!(
                "{} fragments of {frames} coded pictures; one each is read",
                pictures.len()
            ),
        ));
    }
    for (size, components) in pictures.iter().filter_map(|f| claim_of(f)) {
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
