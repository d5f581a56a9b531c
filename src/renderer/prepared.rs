//! What some pictures need beyond atlas, transfer function and light: the table of pre-integrated classification, and value ranges
//! of cells for projections of values.

use std::sync::Arc;

use ash::vk;

use super::pass_name;
use super::settings::Settings;
use crate::atlas::{Residency, TableImages, TransferTable, UploadResources, Visibility};
use crate::error::Result;
use crate::gpu::{Access, Buffer, Context, CopyBox, Image, ImageInfo, Recorder};
use crate::pass::preintegrate::PreintegratePass;
use crate::scene::RayProjection;

/// Images that the device has, or will have once they have been recorded.
pub(super) struct Prepared {
    images: PreparedImages,
    pass: PreintegratePass,
    /// What the images are to hold has not been recorded yet.
    stale: bool,
}

/// The images for one kind of picture.
pub(super) struct PreparedImages {
    kind: Kind,
    tables: Option<TableImages>,
    range: Option<Image>,
}

/// What the extents of the images follow from.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Kind {
    /// Entries of the pre-integrated table, and whether something emits.
    tables: Option<(u32, bool)>,
    /// Skip cells, where their ranges are looked up.
    range: Option<[u32; 3]>,
}

impl Kind {
    fn new(table: &TransferTable, residency: &Residency, settings: &Settings) -> Self {
        let of_values = matches!(
            settings.march.projection,
            RayProjection::Maximum | RayProjection::Minimum | RayProjection::Mean
        );
        Self {
            tables: table
                .preintegration()
                .map(|p| (p.entries(), settings.curve.emits())),
            range: of_values.then(|| residency.cells.counts()),
        }
    }
}

impl PreparedImages {
    fn new(context: &Arc<Context>, name: &str, kind: Kind) -> Result<Self> {
        let tables = kind
            .tables
            .map(|(entries, emits)| TableImages::new(context, name, entries, emits))
            .transpose()?;
        let range = kind
            .range
            .map(|extent| {
                Image::new(
                    context,
                    &ImageInfo {
                        name: &format!("{name}.range"),
                        extent,
                        format: vk::Format::R32G32_SFLOAT,
                        three_dimensional: true,
                        usage: vk::ImageUsageFlags::SAMPLED | vk::ImageUsageFlags::TRANSFER_DST,
                    },
                )
            })
            .transpose()?;
        Ok(Self {
            kind,
            tables,
            range,
        })
    }
}

impl Prepared {
    pub(super) fn new(
        context: &Arc<Context>,
        name: &str,
        table: &TransferTable,
        residency: &Residency,
        settings: &Settings,
    ) -> Result<Self> {
        let kind = Kind::new(table, residency, settings);
        Ok(Self {
            images: PreparedImages::new(context, name, kind)?,
            pass: PreintegratePass::default(),
            stale: true,
        })
    }

    /// The images that other settings need; `None` where those that are there have the same extents. Compiled pipelines stay in any
    /// case.
    pub(super) fn other_images(
        &self,
        context: &Arc<Context>,
        name: &str,
        table: &TransferTable,
        residency: &Residency,
        settings: &Settings,
    ) -> Result<Option<PreparedImages>> {
        let kind = Kind::new(table, residency, settings);
        (kind != self.images.kind)
            .then(|| PreparedImages::new(context, name, kind))
            .transpose()
    }

    /// Transfer function, step or residency changed: all is recorded again, into other images where there are some.
    pub(super) fn renew(&mut self, images: Option<PreparedImages>) {
        if let Some(images) = images {
            self.images = images;
        }
        self.stale = true;
    }

    pub(super) fn tables(&self) -> Option<&TableImages> {
        self.images.tables.as_ref()
    }

    pub(super) fn range(&self) -> Option<&Image> {
        self.images.range.as_ref()
    }

    /// See [`Image::forget`].
    pub(super) fn forget(&mut self) {
        self.images.tables.iter().for_each(TableImages::forget);
        self.images.range.iter().for_each(Image::forget);
        self.stale = true;
    }

    /// Records what is missing.
    pub(super) fn record(
        &mut self,
        context: &Arc<Context>,
        recorder: &mut Recorder<'_>,
        resources: &UploadResources<'_>,
        settings: &Settings,
    ) -> Result<()> {
        if !std::mem::take(&mut self.stale) {
            return Ok(());
        }
        let UploadResources {
            store,
            residency,
            table,
            ..
        } = *resources;
        let PreparedImages { tables, range, .. } = &self.images;
        if let (Some(images), Some(preintegration)) = (tables, table.preintegration()) {
            let texels = preintegration.texels(step_length(settings, store.volume.min_spacing()));
            let from = staging(
                context,
                "umbravox.upload.integrals",
                bytemuck::cast_slice(&texels),
            )?;
            let nearest = &resources.images.nearest;
            let pass = &mut self.pass;
            let whole = CopyBox::packed(0, [0; 3], images.integrals.extent());
            recorder.upload(&from, &images.integrals, &[whole]);
            let emits = settings.curve.emits();
            recorder.pass(pass_name::PREINTEGRATE, |recorder| {
                pass.record(context, recorder, images, nearest, emits)
            })?;
        }
        if let Some(range) = range {
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

/// Length of a step in unit distances of the transfer function.
fn step_length(settings: &Settings, voxel_mm: f64) -> f64 {
    settings.march.step * voxel_mm / settings.curve.unit_distance
}

fn staging(context: &Arc<Context>, name: &str, bytes: &[u8]) -> Result<Buffer> {
    Buffer::upload(context, name, bytes, vk::BufferUsageFlags::TRANSFER_SRC)
}
