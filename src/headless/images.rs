//! Images that pictures are drawn into and read from.

use std::sync::Arc;

use ash::vk;

use crate::error::{Error, Result};
use crate::gpu::memory::MemoryLocation;
use crate::gpu::{Buffer, Context, CopyBox, Image, ImageInfo, OwnedDevice};
use crate::renderer::Settings;

/// Linear radiance and opacity.
pub(super) const PICTURE_FORMAT: vk::Format = vk::Format::R32G32B32A32_SFLOAT;
pub(super) const PICTURE_TEXEL_BYTES: u64 = 16;
/// Bytes of an image read back by one submission.
const READ_BACK_BYTES: u64 = 64 << 20;

pub(super) fn picture_image(
    context: &Arc<Context>,
    name: &str,
    [width, height]: [u32; 2],
) -> Result<Image> {
    Image::new(
        context,
        &ImageInfo {
            name,
            extent: [width, height, 1],
            format: PICTURE_FORMAT,
            three_dimensional: false,
            usage: vk::ImageUsageFlags::STORAGE
                | vk::ImageUsageFlags::TRANSFER_SRC
                | vk::ImageUsageFlags::TRANSFER_DST,
        },
    )
}

/// Where extinctions differ by channel, the image for what comes through each.
pub(super) fn through_image(
    context: &Arc<Context>,
    size: [u32; 2],
    settings: &Settings,
) -> Result<Option<Image>> {
    let [r, g, b] = settings.lighting.extinction;
    (r != g || g != b)
        .then(|| picture_image(context, "umbravox.picture.through", size))
        .transpose()
}

/// Texels of an image, in slabs of bounded size.
pub(super) fn read_back(
    device: &mut OwnedDevice,
    image: &Image,
    texel_bytes: u64,
) -> Result<Vec<u8>> {
    let [width, height, depth] = image.extent();
    let row_bytes = u64::from(width) * texel_bytes;
    // Slabs of whole slices, or of rows where a slice is too large (then there is one slice: pictures).
    let slice_bytes = row_bytes * u64::from(height);
    let (rows, slices) = if slice_bytes <= READ_BACK_BYTES {
        (
            height,
            (READ_BACK_BYTES / slice_bytes).clamp(1, depth.into()) as u32,
        )
    } else {
        ((READ_BACK_BYTES / row_bytes).max(1) as u32, 1)
    };
    let context = device.context().clone();
    let buffer = Buffer::new(
        &context,
        "umbravox.read_back",
        row_bytes * u64::from(rows) * u64::from(slices),
        vk::BufferUsageFlags::TRANSFER_DST,
        MemoryLocation::Readback,
    )?;
    let mut bytes = Vec::new();
    let total = slice_bytes * u64::from(depth);
    bytes
        .try_reserve_exact(total as usize)
        .map_err(|e| Error::OutOfMemory {
            heap: "host",
            what: "umbravox.read_back".into(),
            bytes: total,
            detail: e.to_string(),
        })?;
    for z in (0..depth).step_by(slices as usize) {
        for y in (0..height).step_by(rows as usize) {
            let extent = [width, rows.min(height - y), slices.min(depth - z)];
            let part = CopyBox::packed(0, [0, y, z], extent);
            device.copy_to_host(image, &buffer, part)?;
            let part_bytes = row_bytes * u64::from(extent[1]) * u64::from(extent[2]);
            bytes.extend_from_slice(&buffer.mapped()?[..part_bytes as usize]);
        }
    }
    Ok(bytes)
}

pub(super) fn texels(bytes: &[u8]) -> Vec<[f32; 4]> {
    bytemuck::pod_collect_to_vec(bytes)
}
