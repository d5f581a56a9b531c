//! What some pictures need beyond atlas, transfer function and light: the table of pre-integrated classification, and value ranges
//! of cells for projections of values.

use std::sync::Arc;

use ash::vk;

use super::pass_name;
use super::settings::Settings;
use crate::atlas::{Residency, TableImages, TransferTable, Visibility};
use crate::error::Result;
use crate::gpu::{Access, Buffer, Context, CopyBox, Filter, Image, ImageInfo, Recorder, Sampler};
use crate::pass::preintegrate::PreintegratePass;
use crate::scene::RayProjection;

/// Images that the device has, or will have once they have been recorded.
pub(super) struct Prepared {
    tables: Option<Tables>,
    range: Option<Image>,
    /// Nothing has been recorded yet.
    stale: bool,
}

struct Tables {
    images: TableImages,
    pass: PreintegratePass,
    nearest: Sampler,
}

impl Prepared {
    pub(super) fn new(
        context: &Arc<Context>,
        name: &str,
        table: &TransferTable,
        residency: &Residency,
        settings: &Settings,
    ) -> Result<Self> {
        let tables = table
            .preintegration()
            .map(|p| {
                Ok(Tables {
                    images: TableImages::new(context, name, p.entries(), settings.curve.emits())?,
                    pass: PreintegratePass::new(),
                    nearest: Sampler::new(
                        context,
                        &format!("{name}.integrals.nearest"),
                        Filter::Nearest,
                    )?,
                })
            })
            .transpose()?;
        let of_values = matches!(
            settings.march.projection,
            RayProjection::Maximum | RayProjection::Minimum | RayProjection::Mean
        );
        let range = of_values
            .then(|| {
                Image::new(
                    context,
                    &ImageInfo {
                        name: &format!("{name}.range"),
                        extent: residency.cells.counts(),
                        format: vk::Format::R32G32_SFLOAT,
                        three_dimensional: true,
                        usage: vk::ImageUsageFlags::SAMPLED | vk::ImageUsageFlags::TRANSFER_DST,
                    },
                )
            })
            .transpose()?;
        Ok(Self {
            tables,
            range,
            stale: true,
        })
    }

    pub(super) fn tables(&self) -> Option<&TableImages> {
        self.tables.as_ref().map(|t| &t.images)
    }

    pub(super) fn range(&self) -> Option<&Image> {
        self.range.as_ref()
    }

    /// See [`Image::forget`].
    pub(super) fn forget(&mut self) {
        if let Some(tables) = &self.tables {
            tables.images.forget();
        }
        if let Some(range) = &self.range {
            range.forget();
        }
        self.stale = true;
    }

    /// Records what is missing. `step`: length of a step in unit distances.
    pub(super) fn record(
        &mut self,
        context: &Arc<Context>,
        recorder: &mut Recorder<'_>,
        table: &TransferTable,
        residency: &Residency,
        settings: &Settings,
        step: f64,
    ) -> Result<()> {
        if !std::mem::take(&mut self.stale) {
            return Ok(());
        }
        if let (Some(tables), Some(preintegration)) = (&mut self.tables, table.preintegration()) {
            let texels = preintegration.texels(step);
            let from = staging(
                context,
                "umbravox.upload.integrals",
                bytemuck::cast_slice(&texels),
            )?;
            let Tables {
                images,
                pass,
                nearest,
            } = tables;
            let whole = CopyBox::packed(0, [0; 3], images.integrals.extent());
            recorder.upload(&from, &images.integrals, &[whole]);
            let emits = settings.curve.emits();
            recorder.pass(pass_name::PREINTEGRATE, |recorder| {
                pass.record(context, recorder, images, nearest, emits)
            })?;
        }
        if let Some(range) = &self.range {
            let interpolation = settings.march.interpolation;
            let ranges = Visibility::sample_ranges(residency, interpolation, table.samples());
            let from = staging(
                context,
                "umbravox.upload.range",
                bytemuck::cast_slice(&ranges),
            )?;
            recorder.upload(&from, range, &[CopyBox::packed(0, [0; 3], range.extent())]);
            recorder.use_image(range, Access::SampledRead);
            recorder.flush();
        }
        Ok(())
    }
}

fn staging(context: &Arc<Context>, name: &str, bytes: &[u8]) -> Result<Buffer> {
    Buffer::upload(context, name, bytes, vk::BufferUsageFlags::TRANSFER_SRC)
}
