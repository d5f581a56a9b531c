//! What the description of a TIFF file's first page says of all its pages.
//!
//! OME-XML (Open Microscopy Environment, *The OME-TIFF format*) and the `key=value` lines of ImageJ.

use std::path::Path;

use crate::error::Result;
use crate::io::ReadOptions;
use crate::io::source::bad;
use crate::io::units::millimetres;

/// What the pages themselves say.
pub(super) struct Pages {
    pub(super) count: usize,
    /// Samples of a pixel of the first.
    pub(super) channels: usize,
    /// Pixels per unit on x and y, which ImageJ's unit applies to.
    pub(super) resolution: [Option<f64>; 2],
}

/// Which page is which slice, of the time step and channel asked for.
pub(super) struct Layout {
    pub(super) slices: usize,
    pub(super) channels: usize,
    first_page: usize,
    pages_per_slice: usize,
    /// Millimetres, when the description says it.
    pub(super) spacing: Option<[f64; 3]>,
    /// The description is OME-XML, which microscopes write.
    pub(super) is_ome: bool,
}

impl Layout {
    /// Of a file with `pages`, from its description.
    pub(super) fn of(
        path: &Path,
        text: &str,
        file: &Pages,
        options: &ReadOptions<'_>,
    ) -> Result<Self> {
        let pages = file.count;
        let (counts, order, spacing) = if let Some(pixels) = ome_pixels(text) {
            let count = |key| {
                attribute(pixels, key)
                    .and_then(|n| n.parse().ok())
                    .unwrap_or(1)
            };
            let order = attribute(pixels, "DimensionOrder").unwrap_or("XYZCT");
            let counts = ["SizeZ", "SizeC", "SizeT"].map(count);
            // Samples of one page count as channels there.
            let [z, c, t] = counts;
            let in_page = file.channels > 1 && c == file.channels;
            let counts = if in_page { [z, 1, t] } else { counts };
            (counts, order, ome_spacing(pixels))
        } else if text.starts_with("ImageJ=") {
            let count = |key| line(text, key).and_then(|n| n.parse().ok()).unwrap_or(1);
            let [channels, frames] = ["channels", "frames"].map(count);
            let slices = match line(text, "slices") {
                Some(_) => count("slices"),
                None => pages / (channels * frames).max(1),
            };
            let spacing = imagej_spacing(text, file.resolution);
            ([slices, channels, frames], "XYCZT", spacing)
        } else {
            ([pages, 1, 1], "XYZCT", None)
        };
        let [slices, channels, times] = counts;
        let all = counts.iter().try_fold(1usize, |n, &m| n.checked_mul(m));
        if all != Some(pages) || slices == 0 {
            return Err(bad(
                path,
                format!(
                    "the description says {slices} slices, {channels} channels and {times} times, the file has \
                     {pages} pages; files whose pages are elsewhere are not read"
                ),
            ));
        }
        let channel = chosen(
            path,
            "channel",
            if channels > 1 { options.channel } else { None },
            channels,
        )?;
        let time = chosen(path, "timestep", options.timestep, times)?;
        let mut stride = 1;
        let (mut first_page, mut pages_per_slice) = (0, 1);
        for axis in order.chars().skip(2) {
            match axis {
                'Z' => {
                    pages_per_slice = stride;
                    stride *= slices;
                }
                'C' => {
                    first_page += channel * stride;
                    stride *= channels;
                }
                'T' => {
                    first_page += time * stride;
                    stride *= times;
                }
                _ => {
                    return Err(bad(
                        path,
                        format!("DimensionOrder {order:?} is not valid; XYZCT is, for one"),
                    ));
                }
            }
        }
        Ok(Self {
            slices,
            channels,
            first_page,
            pages_per_slice,
            spacing,
            is_ome: ome_pixels(text).is_some(),
        })
    }

    /// The page of slice `k`.
    pub(super) fn page(&self, k: usize) -> usize {
        self.first_page + k * self.pages_per_slice
    }
}

fn chosen(path: &Path, key: &str, asked: Option<u32>, count: usize) -> Result<usize> {
    let asked = asked.unwrap_or(0) as usize;
    if asked < count {
        return Ok(asked);
    }
    Err(bad(
        path,
        format!("volume.{key} {asked} of {count}; the first is 0"),
    ))
}

/// The start tag of the first `Pixels` element.
fn ome_pixels(text: &str) -> Option<&str> {
    if !text.contains("<OME") && !text.contains(":OME") {
        return None;
    }
    let at = text.find("Pixels ")?;
    let tag = text.get(at..)?;
    tag.get(..tag.find('>')?)
}

/// The value of an attribute in a start tag.
fn attribute<'a>(tag: &'a str, name: &str) -> Option<&'a str> {
    let (_, after) = tag.split_once(&format!(" {name}="))?;
    let quote = after.chars().next().filter(|c| matches!(c, '"' | '\''))?;
    after.get(1..)?.split(quote).next()
}

fn ome_spacing(pixels: &str) -> Option<[f64; 3]> {
    let size = |key: &str| -> Option<f64> {
        let number: f64 = attribute(pixels, key)?.parse().ok()?;
        let unit = attribute(pixels, &format!("{key}Unit")).unwrap_or("µm");
        Some(number * millimetres(unit)?)
    };
    let [x, y, z] = ["PhysicalSizeX", "PhysicalSizeY", "PhysicalSizeZ"].map(size);
    let x = x?;
    Some([x, y.unwrap_or(x), z.unwrap_or(x)])
}

fn imagej_spacing(text: &str, [x, y]: [Option<f64>; 2]) -> Option<[f64; 3]> {
    let mm = millimetres(line(text, "unit")?)?;
    let (x, y) = (mm / x?, mm / y?);
    let z = line(text, "spacing").and_then(|n| n.parse::<f64>().ok());
    Some([x, y, z.map_or(x, |z| z.abs() * mm)])
}

/// The value of a line `key=value`.
fn line<'a>(text: &'a str, key: &str) -> Option<&'a str> {
    text.lines()
        .find_map(|line| line.strip_prefix(key)?.strip_prefix('='))
        .map(str::trim)
}
