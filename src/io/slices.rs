//! Pictures of one size, stacked: each is a slice, the first lies at z = 0.

use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;

use rayon::prelude::*;

use super::ReadOptions;
use super::components::{LUMA, Pick};
use super::decoded::Decoded;
use super::element::Element;
use super::grid::Grid;
use super::payload::{MAX_DEFLATE_RATIO, zeroed};
use super::source::bad;
use super::watched::watched;
use crate::error::Result;
use crate::volume::{VoxelType, Voxels};

/// One decoded picture, rows from the top.
pub(super) struct Picture {
    pub(super) columns: u32,
    pub(super) rows: u32,
    /// Samples of a pixel lie side by side.
    pub(super) channels: usize,
    pub(super) samples: Voxels,
}

impl Picture {
    fn element(&self) -> Element {
        match self.samples.voxel_type() {
            VoxelType::U8 => Element::U8,
            VoxelType::I8 => Element::I8,
            VoxelType::U16 => Element::U16,
            VoxelType::I16 => Element::I16,
            VoxelType::F32 => Element::F32,
        }
    }

    fn describe(&self) -> String {
        format!(
            "{} x {} pixels of {} x {}",
            self.columns,
            self.rows,
            self.channels,
            self.element()
        )
    }
}

/// Refuses a picture that claims far more pixels than a file of its length can code: at best 1032
/// bytes of eight pixels each become one.
pub(super) fn check_claim(path: &Path, [columns, rows]: [u32; 2], file_len: u64) -> Result<()> {
    let pixels = u64::from(columns) * u64::from(rows);
    if pixels / 8 <= file_len.saturating_mul(MAX_DEFLATE_RATIO) {
        return Ok(());
    }
    Err(bad(
        path,
        format!(
            "{columns} x {rows} pixels in {file_len} bytes: it is cut short or its header is wrong"
        ),
    ))
}

/// Decodes all slices in parallel, each straight to its place. `decode` gives slice `k`; `path_of` names it.
pub(super) fn stack(
    path: &Path,
    count: usize,
    decode: impl Fn(usize) -> Result<Picture> + Sync,
    path_of: impl Fn(usize) -> PathBuf + Sync,
    options: &ReadOptions<'_>,
) -> Result<(Decoded, Grid)> {
    let first = decode(0)?;
    let axes = [first.columns.into(), first.rows.into(), count as u64];
    let keys = "columns, rows, pictures";
    let grid = Grid::of_one(path, keys, axes, first.element(), &options.limits)?;
    let channels = first.channels;
    let pick = Pick::of(path, channels, channels >= 3, first.element(), options)?;
    let stack = Stack {
        first: &first,
        grid,
        pick,
        decode,
        path_of,
        progress: options.progress,
    };
    if pick == Pick::Color {
        return Ok((Decoded::Colors(stack.colors()?), grid));
    }
    let voxels = match &first.samples {
        Voxels::U8(_) => Voxels::U8(stack.fill(
            |v| match v {
                Voxels::U8(v) => Some(v),
                _ => None,
            },
            |x| x.round() as u8,
        )?),
        Voxels::I8(_) => Voxels::I8(stack.fill(
            |v| match v {
                Voxels::I8(v) => Some(v),
                _ => None,
            },
            |x| x.round() as i8,
        )?),
        Voxels::U16(_) => Voxels::U16(stack.fill(
            |v| match v {
                Voxels::U16(v) => Some(v),
                _ => None,
            },
            |x| x.round() as u16,
        )?),
        Voxels::I16(_) => Voxels::I16(stack.fill(
            |v| match v {
                Voxels::I16(v) => Some(v),
                _ => None,
            },
            |x| x.round() as i16,
        )?),
        Voxels::F32(_) => Voxels::F32(stack.fill(
            |v| match v {
                Voxels::F32(v) => Some(v),
                _ => None,
            },
            |x| x,
        )?),
    };
    Ok((voxels.into(), grid))
}

struct Stack<'a, D, P> {
    first: &'a Picture,
    grid: Grid,
    pick: Pick,
    decode: D,
    path_of: P,
    progress: Option<&'a dyn Fn(u64, u64)>,
}

impl<D, P> Stack<'_, D, P>
where
    D: Fn(usize) -> Result<Picture> + Sync,
    P: Fn(usize) -> PathBuf + Sync,
{
    fn fill<T: bytemuck::Zeroable + Copy + Into<f32> + Send + Sync>(
        &self,
        samples_of: impl Fn(&Voxels) -> Option<&Vec<T>> + Sync,
        from_luma: impl Fn(f32) -> T + Sync,
    ) -> Result<Vec<T>> {
        let pick = self.pick;
        self.slices(samples_of, |samples, channels, out| {
            pick_samples(samples, channels, pick, out, &from_luma);
        })
    }

    fn colors(&self) -> Result<Vec<[u8; 4]>> {
        self.slices(
            |v| match v {
                Voxels::U8(v) => Some(v),
                _ => None,
            },
            |samples: &[u8], channels, out: &mut [[u8; 4]]| {
                for (out, pixel) in out.iter_mut().zip(samples.chunks_exact(channels)) {
                    *out = [u8::MAX; 4];
                    for (to, &from) in out.iter_mut().zip(pixel) {
                        *to = from;
                    }
                }
            },
        )
    }

    /// Decodes all slices; `convert` makes voxels of the samples of one, of which each pixel has some.
    fn slices<S: Sync, T: bytemuck::Zeroable + Copy + Send + Sync>(
        &self,
        samples_of: impl Fn(&Voxels) -> Option<&Vec<S>> + Sync,
        convert: impl Fn(&[S], usize, &mut [T]) + Sync,
    ) -> Result<Vec<T>> {
        let Self {
            first,
            grid,
            decode,
            path_of,
            progress,
            ..
        } = self;
        let [x, y, z] = grid.size.map(|n| n as usize);
        let mut voxels = zeroed(grid.voxels)?;
        let slice_bytes = grid.bytes / z as u64;
        let slices = voxels.par_chunks_mut(x * y).enumerate();
        watched(*progress, grid.bytes, |done| {
            slices.try_for_each(|(k, out)| {
                let picture = decode(k)?;
                let same = [picture.columns, picture.rows] == [first.columns, first.rows]
                    && picture.channels == first.channels;
                match samples_of(&picture.samples) {
                    Some(samples) if same => {
                        convert(samples, picture.channels, out);
                        done.fetch_add(slice_bytes, Ordering::Relaxed);
                        Ok(())
                    }
                    _ => Err(bad(
                        &path_of(k),
                        format!(
                            "this picture has {}, the first one of the stack {}",
                            picture.describe(),
                            first.describe()
                        ),
                    )),
                }
            })
        })?;
        Ok(voxels)
    }
}

fn pick_samples<T: Copy + Into<f32>>(
    samples: &[T],
    channels: usize,
    pick: Pick,
    out: &mut [T],
    from_luma: &impl Fn(f32) -> T,
) {
    match pick {
        Pick::Component(0) if channels == 1 => {
            for (out, &sample) in out.iter_mut().zip(samples) {
                *out = sample;
            }
        }
        Pick::Component(c) => {
            for (out, &sample) in out.iter_mut().zip(samples.iter().skip(c).step_by(channels)) {
                *out = sample;
            }
        }
        Pick::Luma | Pick::Color => {
            for (out, pixel) in out.iter_mut().zip(samples.chunks_exact(channels)) {
                *out = from_luma(
                    pixel
                        .iter()
                        .zip(LUMA)
                        .map(|(&s, share)| s.into() * share)
                        .sum(),
                );
            }
        }
    }
}
