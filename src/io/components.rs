//! Voxels of several numbers, of which a volume keeps one, or a colour.

use std::io::{self, Read};
use std::path::Path;

use super::ReadOptions;
use super::element::{Element, Stored};
use super::payload::read_full;
use super::source::bad;
use crate::error::Result;
use crate::scene::{Endian, VolumeColor};

/// Shares of red, green and blue in luminance (ITU-R BT.709, 3.2), of the values as stored.
pub(super) const LUMA: [f32; 3] = [0.2126, 0.7152, 0.0722];

/// Voxels that are decoded at a time.
const VOXELS_AT_ONCE: usize = 4096;

/// What of the numbers of a voxel is kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Pick {
    Component(usize),
    Luma,
    /// Red, green, blue and alpha, a byte each.
    Color,
}

impl Pick {
    /// The component asked for; else colours of 8 bits as they are, and luminance of others; else the first.
    pub(super) fn of(
        path: &Path,
        count: usize,
        colour: bool,
        element: Element,
        options: &ReadOptions<'_>,
    ) -> Result<Self> {
        let as_colors = options.color != Some(VolumeColor::TransferFunction);
        match options.channel.map(|c| c as usize) {
            Some(c) if c < count => Ok(Self::Component(c)),
            Some(c) => Err(bad(
                path,
                format!("volume.channel {c} of {count} channels; the first is 0"),
            )),
            None if colour && element == Element::U8 && matches!(count, 3 | 4) && as_colors => {
                tracing::info!(
                    "colours; volume.color \"transfer_function\" reads their luminance, volume.channel a channel"
                );
                Ok(Self::Color)
            }
            None if colour => {
                tracing::info!("colours; their luminance is read, volume.channel picks a channel");
                Ok(Self::Luma)
            }
            None => {
                if count > 1 {
                    tracing::info!(
                        "{count} channels, the first is read; volume.channel picks another"
                    );
                }
                Ok(Self::Component(0))
            }
        }
    }
}

/// Numbers of a voxel that lie side by side, and which of them is kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Components {
    pub(super) count: usize,
    pub(super) pick: Pick,
}

impl Components {
    /// Of voxels that are numbers.
    pub(super) const ONE: Self = Self {
        count: 1,
        pick: Pick::Component(0),
    };

    /// What a message calls a voxel's type.
    pub(super) fn of_type(self, element: Element) -> String {
        match self.count {
            1 => format!("type {element}"),
            count => format!("{count} x {element}"),
        }
    }

    /// Checks a number of components. Those of other than 8 and 16 bits and 32-bit floats are no colours.
    pub(super) fn of(
        path: &Path,
        count: u64,
        element: Element,
        colour: bool,
        options: &ReadOptions<'_>,
    ) -> Result<Self> {
        const MOST: u64 = 1 << 12;
        if !(1..=MOST).contains(&count) {
            return Err(bad(path, format!("{count} channels; 1 to {MOST} are read")));
        }
        let count = count as usize;
        let has_luma = matches!(element, Element::U8 | Element::U16 | Element::F32);
        let colour = colour && count >= 3 && has_luma;
        Ok(Self {
            count,
            pick: Pick::of(path, count, colour, element, options)?,
        })
    }
}

/// What is kept of voxels that a reader gives, in the byte order that they have.
pub(super) struct ComponentReader {
    voxels: Box<dyn Read>,
    components: Components,
    element: Element,
    endian: Endian,
    /// Bytes that were kept, and how many of them are handed out.
    kept: Vec<u8>,
    given: usize,
}

impl ComponentReader {
    pub(super) fn new(
        voxels: Box<dyn Read>,
        components: Components,
        element: Element,
        endian: Endian,
    ) -> Self {
        Self {
            voxels,
            components,
            element,
            endian,
            kept: Vec::new(),
            given: 0,
        }
    }

    fn refill(&mut self) -> io::Result<()> {
        let Components { count, pick } = self.components;
        let each = self.element.bytes() as usize;
        let mut bytes = vec![0; VOXELS_AT_ONCE * count * each];
        let got = read_full(&mut self.voxels, &mut bytes)?;
        let voxels = bytes
            .get(..got)
            .unwrap_or_default()
            .chunks_exact(count * each);
        self.kept.clear();
        self.given = 0;
        match pick {
            Pick::Component(c) => {
                let component = |voxel| <[u8]>::get(voxel, c * each..(c + 1) * each);
                self.kept.extend(voxels.filter_map(component).flatten());
            }
            Pick::Color => {
                for voxel in voxels {
                    let mut color = [u8::MAX; 4];
                    for (to, &from) in color.iter_mut().zip(voxel) {
                        *to = from;
                    }
                    self.kept.extend(color);
                }
            }
            Pick::Luma => {
                let swap = (self.endian == Endian::Big) != cfg!(target_endian = "big");
                for voxel in voxels {
                    match self.element {
                        Element::U8 => self
                            .kept
                            .push(luma::<u8>(voxel, swap, f32::from).round() as u8),
                        Element::U16 => {
                            let luma = luma::<u16>(voxel, swap, f32::from).round() as u16;
                            self.keep(luma, swap);
                        }
                        _ => {
                            let luma = luma::<f32>(voxel, swap, |v| v);
                            self.keep(luma, swap);
                        }
                    }
                }
            }
        }
        Ok(())
    }

    fn keep<T: Stored>(&mut self, value: T, swap: bool) {
        let value = if swap { value.swapped() } else { value };
        self.kept.extend(bytemuck::bytes_of(&value));
    }
}

fn luma<T: Stored>(voxel: &[u8], swap: bool, to_f32: impl Fn(T) -> f32) -> f32 {
    let shares = voxel.chunks_exact(size_of::<T>()).zip(LUMA);
    shares
        .map(|(bytes, share)| {
            let value: T = bytemuck::pod_read_unaligned(bytes);
            share * to_f32(if swap { value.swapped() } else { value })
        })
        .sum()
}

impl Read for ComponentReader {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        if self.given == self.kept.len() {
            self.refill()?;
        }
        let mut pending = self.kept.get(self.given..).unwrap_or_default();
        let got = pending.read(out)?;
        self.given += got;
        Ok(got)
    }
}
