//! The volume of gradients.
//!
//! Reads   atlas (SampledRead), index, packed corners (SampledGeneral), list of chunks (storage buffer the host wrote)
//! Writes  the volume of gradients (Storage), for the chunks listed
//! Grid    one workgroup for 4x4x4 voxels, or so many fours of them, 64 for a chunk of 16^3 voxels
//! Method  the estimators of glsl/include/gradient.glsl, at voxels
//! Limits  a dispatch takes at most `CHUNKS_A_DISPATCH` chunks
//! Twin    src/field/gradient.rs

use std::sync::Arc;

use ash::vk;

use super::{Reconstruction, Variants, gradient_constant, sampled, use_index, use_packed_cells};
use crate::atlas::{GRADIENT_CHUNK, GradientStore, GradientTexels, GradientVolume, Images};
use crate::error::Result;
use crate::gpu::{Access, Bound, Buffer, Context, Recorder, TexelBuffer, Uniforms};
use crate::shader::generated::*;
use crate::shader::interface;
use crate::shader::structs::PartPush;

/// Bounds one dispatch to about 4 million voxels.
const CHUNKS_A_DISPATCH: usize = 1024;
/// Workgroups of a chunk.
const GROUPS: u32 = (GRADIENT_CHUNK / 4).pow(3);

/// What the pass works on.
pub(crate) struct GradientsResources<'a> {
    pub(crate) images: &'a Images,
    pub(crate) gradients: &'a mut GradientVolume,
    /// Which chunks of 16^3 voxels.
    pub(crate) chunks: &'a [[i32; 4]],
    /// The volume's parameters.
    pub(crate) volume: Uniforms,
}

/// The pass.
#[derive(Default)]
pub(crate) struct GradientsPass {
    variants: Variants,
}

impl GradientsPass {
    /// Estimates the gradients of some chunks.
    pub(crate) fn record(
        &mut self,
        context: &Arc<Context>,
        recorder: &mut Recorder<'_>,
        reconstruction: Reconstruction,
        resources: GradientsResources<'_>,
    ) -> Result<()> {
        let GradientsResources {
            images,
            gradients,
            chunks,
            volume,
        } = resources;
        let mut constants = reconstruction.constants();
        constants.extend([
            (SPEC_GRADIENT, gradient_constant(gradients.estimator())),
            (SPEC_STORED_GRADIENTS, gradients.texels() as u32),
        ]);
        let pipeline = self
            .variants
            .get(context, &interface::GRADIENTS, constants)?;
        let list = Buffer::upload(
            context,
            "umbravox.gradients.chunks",
            bytemuck::cast_slice(chunks),
            vk::BufferUsageFlags::STORAGE_BUFFER,
        )?;
        if gradients.is_first_use() {
            match &gradients.store {
                GradientStore::Image(image) => recorder.clear(image),
                GradientStore::Pages(texels, _) if gradients.texels() == GradientTexels::Halves => {
                    recorder.fill_zero(texels.buffer());
                }
                // Whatever ten bits are, they are a number.
                GradientStore::Pages(..) => {}
            }
        }
        recorder.use_image(&images.atlas, Access::SampledRead);
        let mut bound = vec![
            (BINDING_VOLUME, Bound::Uniform(volume)),
            (
                BINDING_ATLAS,
                sampled(&images.atlas, images.atlas_sampler()),
            ),
            use_packed_cells(recorder, images),
            (BINDING_CHUNKS, Bound::Storage(&list)),
        ];
        bound.extend(use_index(recorder, images));
        // For kinds of texels that these are not others stand in, and nothing writes them.
        let filtered = gradients.image().unwrap_or(&images.light);
        recorder.use_image(filtered, Access::Storage);
        bound.push((BINDING_GRADIENTS_STORE, Bound::StorageImage(filtered)));
        for (binding, texels) in GradientVolume::texel_buffers(Some(gradients), &images.no_texels) {
            recorder.use_buffer(texels.buffer(), Access::Storage);
            bound.push((binding, Bound::Texels(texels)));
        }
        recorder.bind(pipeline, &bound)?;
        for (at, part) in chunks.chunks(CHUNKS_A_DISPATCH).enumerate() {
            let push = PartPush {
                first: (at * CHUNKS_A_DISPATCH) as u32,
                count: part.len() as u32,
            };
            recorder.dispatch(pipeline, &push, [push.count, GROUPS, 1]);
        }
        match &gradients.store {
            GradientStore::Image(image) => recorder.use_image(image, Access::SampledRead),
            GradientStore::Pages(texels, _) => {
                recorder.use_buffer(texels.buffer(), TexelBuffer::LOADED);
            }
        }
        recorder.flush();
        Ok(())
    }
}
