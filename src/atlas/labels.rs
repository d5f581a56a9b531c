//! The device side of labels.

use std::sync::Arc;

use ash::vk;

use crate::error::{Error, Result};
use crate::gpu::{Access, Buffer, Context, CopyBox, Image, ImageInfo, Recorder};
use crate::scene::{LabelStyle, Labels};
use crate::volume::LabelIndices;

/// Entries in a row of the table: the shaders' `LABEL_ROW`.
const ROW: usize = 256;

/// A label map on the device, with what its labels do.
pub(crate) struct LabelImages {
    /// Where each voxel's label stands in the table.
    pub(crate) map: Image,
    /// By label, in rows of [`ROW`]: linear colour and its share, negative where the label is hidden.
    pub(crate) table: Image,
    map_stale: bool,
    table_stale: bool,
}

impl LabelImages {
    /// # Errors
    /// [`Error::OutOfMemory`], [`Error::Unsupported`] for extents beyond the device's limits.
    pub(crate) fn new(context: &Arc<Context>, name: &str, labels: &Labels) -> Result<Self> {
        let extent = labels.map().size();
        let max = context.capabilities().max_extent_3d;
        if extent.iter().any(|&n| n > max) {
            return Err(Error::Unsupported {
                device: context.capabilities().name.clone(),
                need: format!("a 3D image of {extent:?} texels for the labels"),
                have: format!("at most {max} on an axis"),
            });
        }
        let image = |part: &str, extent, format, three_dimensional| {
            Image::new(
                context,
                &ImageInfo {
                    name: &format!("{name}.{part}"),
                    extent,
                    format,
                    three_dimensional,
                    usage: vk::ImageUsageFlags::SAMPLED | vk::ImageUsageFlags::TRANSFER_DST,
                },
            )
        };
        let format = match labels.map().indices() {
            LabelIndices::U8(_) => vk::Format::R8_UINT,
            LabelIndices::U16(_) => vk::Format::R16_UINT,
        };
        let rows = labels.styles().len().div_ceil(ROW) as u32;
        Ok(Self {
            map: image("labels", extent, format, true)?,
            table: image(
                "label_table",
                [ROW as u32, rows, 1],
                vk::Format::R32G32B32A32_SFLOAT,
                false,
            )?,
            map_stale: true,
            table_stale: true,
        })
    }

    /// The styles changed, the map did not.
    pub(crate) fn restyle(&mut self) {
        self.table_stale = true;
    }

    /// See [`Image::forget`].
    pub(crate) fn forget(&mut self) {
        self.map.forget();
        self.table.forget();
        self.map_stale = true;
        self.table_stale = true;
    }

    /// Records what is missing.
    pub(crate) fn record(
        &mut self,
        context: &Arc<Context>,
        recorder: &mut Recorder<'_>,
        labels: &Labels,
    ) -> Result<()> {
        if !(self.map_stale || self.table_stale) {
            return Ok(());
        }
        let mut upload = |name: &str, bytes: &[u8], to: &Image| -> Result<()> {
            let from = Buffer::upload(context, name, bytes, vk::BufferUsageFlags::TRANSFER_SRC)?;
            recorder.upload(&from, to, &[CopyBox::packed(0, [0; 3], to.extent())]);
            recorder.use_image(to, Access::SampledRead);
            Ok(())
        };
        if self.map_stale {
            let bytes: &[u8] = match labels.map().indices() {
                LabelIndices::U8(indices) => indices,
                LabelIndices::U16(indices) => bytemuck::cast_slice(indices),
            };
            upload("umbravox.upload.labels", bytes, &self.map)?;
        }
        if self.table_stale {
            let mut texels: Vec<[f32; 4]> = labels.styles().iter().map(texel).collect();
            texels.resize(texels.len().next_multiple_of(ROW), [0.0; 4]);
            let bytes = bytemuck::cast_slice(&texels);
            upload("umbravox.upload.label_table", bytes, &self.table)?;
        }
        recorder.flush();
        self.map_stale = false;
        self.table_stale = false;
        Ok(())
    }
}

fn texel(style: &LabelStyle) -> [f32; 4] {
    let [r, g, b] = style.color.map(|c| c as f32);
    let share = if style.shown { style.tint as f32 } else { -1.0 };
    [r, g, b, share]
}
