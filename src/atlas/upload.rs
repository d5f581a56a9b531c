//! Bricks on their way to the device, a bounded batch a frame.

use std::sync::Arc;

use ash::vk;
use rayon::prelude::*;

use super::colors::ColorBricks;
use super::{Images, Residency, SampleLengths, Store, TransferTable};
use crate::error::Result;
use crate::gpu::memory::MemoryLocation;
use crate::gpu::{Access, Buffer, Context, CopyBox, Image, Recorder};
use crate::volume::blocks::brick_extent;
use crate::volume::bricks::BrickBuilder;

/// Offsets of copies are multiples of this: of every texel size, and of the 4 that Vulkan asks for.
const COPY_ALIGNMENT: usize = 16;

/// What is still to be uploaded.
pub(crate) struct Uploads {
    /// Resident blocks; those before `next` are on the device.
    blocks: Vec<usize>,
    next: usize,
    transfer: bool,
    skip: bool,
    index: bool,
    light_cleared: bool,
}

impl Uploads {
    /// Everything.
    pub(crate) fn all(residency: &Residency) -> Self {
        let levels = &residency.selection.levels.by_block;
        Self {
            blocks: (0..levels.len()).filter(|&b| levels[b].is_some()).collect(),
            next: 0,
            transfer: true,
            skip: true,
            index: true,
            light_cleared: false,
        }
    }

    /// The leaps changed.
    pub(crate) fn leap_anew(&mut self) {
        self.skip = true;
    }

    /// The transfer function or the length of a sample changed.
    pub(crate) fn reclassify(&mut self) {
        self.transfer = true;
    }

    /// True when there is something to record.
    pub(crate) fn pending(&self) -> bool {
        !self.bricks_complete() || self.transfer || self.skip || self.index || !self.light_cleared
    }

    /// Bricks not on the device yet.
    pub(crate) fn missing_bricks(&self) -> usize {
        self.blocks.len() - self.next
    }

    /// True when every resident brick is on the device.
    pub(crate) fn bricks_complete(&self) -> bool {
        self.missing_bricks() == 0
    }

    /// Records the uploads of one frame, of about `budget` bytes of bricks, and tells how many there were.
    pub(crate) fn record(
        &mut self,
        context: &Arc<Context>,
        recorder: &mut Recorder<'_>,
        resources: &UploadResources<'_>,
        budget: usize,
    ) -> Result<u64> {
        let UploadResources {
            images,
            store,
            residency,
            table,
            lengths,
            leaps,
        } = *resources;
        let mut uploaded = 0;
        if self.next == 0 && !residency.layout.is_grid() {
            // Filters read the texel after a brick's last with weight 0, which only a number makes nothing.
            recorder.clear(&images.atlas);
            if let Some(color) = &images.color {
                recorder.clear(&color.image);
            }
        }
        if !self.bricks_complete() {
            uploaded += self.bricks(context, recorder, resources, budget)?;
            self.index = true;
        }
        if self.index {
            let ready = self.ready(store, residency);
            let texels = Images::index_texels(residency, |block| ready[block]);
            whole(
                context,
                recorder,
                "umbravox.upload.index",
                bytemuck::cast_slice(&texels),
                &images.index,
            )?;
            self.index = false;
        }
        if self.skip {
            whole(
                context,
                recorder,
                "umbravox.upload.skip",
                bytemuck::cast_slice(leaps),
                &images.skip,
            )?;
            self.skip = false;
        }
        if self.transfer {
            let texels = table.texels(lengths);
            let bytes: &[u8] = bytemuck::cast_slice(&texels);
            let staging = staging(context, "umbravox.upload.transfer", bytes)?;
            let extent = [table.bins() as u32, TransferTable::ROWS, 1];
            let part = CopyBox::packed(0, [0; 3], extent);
            recorder.upload(&staging, &images.transfer, &[part]);
            self.transfer = false;
        }
        if !self.light_cleared {
            recorder.clear(&images.light);
            self.light_cleared = true;
        }
        recorder.use_image(&images.atlas, Access::SampledRead);
        if let Some(color) = &images.color {
            recorder.use_image(&color.image, Access::SampledRead);
        }
        let texels = [&images.index, &images.skip, &images.transfer, &images.light];
        for image in texels {
            recorder.use_image(image, Access::SampledGeneral);
        }
        recorder.flush();
        Ok(uploaded)
    }

    /// By block: are all the texels of its brick on the device?
    fn ready(&self, store: &Store, residency: &Residency) -> Vec<bool> {
        let grid = store.grid();
        let mut copied = vec![false; grid.len()];
        for &block in &self.blocks[..self.next] {
            copied[block] = true;
        }
        if self.bricks_complete() || !residency.layout.is_grid() {
            return copied;
        }
        // Bricks that lie as their blocks do have their last texels from the next ones.
        let next = |corner: i32| [corner & 1, corner >> 1 & 1, corner >> 2];
        (0..grid.len())
            .map(|block| {
                (0..8).all(|corner| {
                    grid.neighbor(block, next(corner))
                        .is_none_or(|there| copied[there])
                })
            })
            .collect()
    }

    fn bricks(
        &mut self,
        context: &Arc<Context>,
        recorder: &mut Recorder<'_>,
        resources: &UploadResources<'_>,
        budget: usize,
    ) -> Result<u64> {
        let UploadResources {
            images,
            store,
            residency,
            ..
        } = *resources;
        let levels = &residency.selection.levels;
        let grid = store.grid();
        let builder = BrickBuilder::new(&store.volume, grid, levels)?;
        let colors = images
            .color
            .as_ref()
            .map(|color| ColorBricks::new(&store.volume, grid, levels, color.management))
            .transpose()?;
        let values_of = |block| builder.bytes(block);
        let colors_of = |block| colors.as_ref().map_or(0, |colors| colors.bytes(block));
        let mut total = 0;
        let fit = self.blocks[self.next..].iter().take_while(|&&block| {
            let first = total == 0;
            total += padded(values_of(block)) + padded(colors_of(block));
            first || total <= budget
        });
        let batch = &self.blocks[self.next..self.next + fit.count()];
        let stage = Stage {
            context,
            residency,
            batch,
        };
        let write = |block, to: &mut [u8]| builder.write(block, to);
        let mut uploaded = stage.upload(recorder, &images.atlas, values_of, write)?;
        if let (Some(to), Some(colors)) = (&images.color, &colors) {
            let write = |block, to: &mut [u8]| colors.write(block, to);
            uploaded += stage.upload(recorder, &to.image, colors_of, write)?;
        }
        self.next += batch.len();
        Ok(uploaded)
    }
}

const fn padded(bytes: usize) -> usize {
    bytes.next_multiple_of(COPY_ALIGNMENT)
}

/// Bricks that are uploaded together.
struct Stage<'a> {
    context: &'a Arc<Context>,
    residency: &'a Residency,
    batch: &'a [usize],
}

impl Stage<'_> {
    /// Makes the bricks and records their copies into an image. Tells how many bytes there were.
    fn upload(
        &self,
        recorder: &mut Recorder<'_>,
        to: &Image,
        bytes_of: impl Fn(usize) -> usize,
        write: impl Fn(usize, &mut [u8]) + Sync,
    ) -> Result<u64> {
        let layout = &self.residency.layout;
        let sizes: Vec<usize> = self.batch.iter().map(|&b| padded(bytes_of(b))).collect();
        let total = sizes.iter().sum();
        let mut staging = Buffer::new(
            self.context,
            "umbravox.upload.bricks",
            total as u64,
            vk::BufferUsageFlags::TRANSFER_SRC,
            MemoryLocation::Upload,
        )?;
        let mut rest = &mut staging.mapped_mut()?[..total];
        let mut parts = Vec::with_capacity(sizes.len());
        for &bytes in &sizes {
            let (part, tail) = rest.split_at_mut(bytes);
            parts.push(part);
            rest = tail;
        }
        parts
            .into_par_iter()
            .zip(self.batch)
            .for_each(|(part, &block)| write(block, part));
        let mut offset = 0;
        let mut boxes = Vec::with_capacity(sizes.len());
        let levels = &self.residency.selection.levels.by_block;
        for (&block, &bytes) in self.batch.iter().zip(&sizes) {
            if let (Some(origin), Some(level)) = (layout.origins()[block], levels[block]) {
                boxes.push(CopyBox {
                    buffer_offset: offset,
                    buffer_row: [brick_extent(level); 2],
                    origin,
                    extent: layout.copy_extent(block),
                });
            }
            offset += bytes as u64;
        }
        recorder.upload(&staging, to, &boxes);
        Ok(total as u64)
    }
}

/// What uploads read and write.
#[derive(Clone, Copy)]
pub(crate) struct UploadResources<'a> {
    pub(crate) images: &'a Images,
    pub(crate) store: &'a Store,
    pub(crate) residency: &'a Residency,
    pub(crate) table: &'a TransferTable,
    pub(crate) lengths: SampleLengths,
    pub(crate) leaps: &'a [u32],
}

fn staging(context: &Arc<Context>, name: &str, bytes: &[u8]) -> Result<Buffer> {
    Buffer::upload(context, name, bytes, vk::BufferUsageFlags::TRANSFER_SRC)
}

/// Uploads a whole image from tightly packed texels.
fn whole(
    context: &Arc<Context>,
    recorder: &mut Recorder<'_>,
    name: &str,
    bytes: &[u8],
    to: &Image,
) -> Result<()> {
    let staging = staging(context, name, bytes)?;
    recorder.upload(&staging, to, &[CopyBox::packed(0, [0; 3], to.extent())]);
    Ok(())
}
