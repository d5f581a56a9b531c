//! Compute pipelines, made from a pass's declared interface.

use std::sync::Arc;

use ash::vk;

use super::context::Context;
use super::frame_slot::{FrameSlot, Uniforms};
use super::retire::Retired;
use crate::error::Result;
use crate::shader::{DescriptorKind, PassInterface};

/// One specialization of a pass.
pub(crate) struct Pipeline {
    context: Arc<Context>,
    pub(super) interface: &'static PassInterface,
    pub(super) handle: vk::Pipeline,
    pub(super) layout: vk::PipelineLayout,
    pub(super) set_layout: vk::DescriptorSetLayout,
}

/// What is bound to one binding of a pass.
#[derive(Clone, Copy)]
pub(crate) enum Bound<'a> {
    /// A part of the frame's uniform buffer.
    Uniform(Uniforms),
    /// A storage buffer.
    Storage(&'a super::Buffer),
    /// An image with a sampler. `general`: it stays in `GENERAL`.
    Sampled {
        image: &'a super::Image,
        sampler: &'a super::Sampler,
        general: bool,
    },
    /// A storage image.
    StorageImage(&'a super::Image),
    /// A storage texel buffer.
    Texels(&'a super::TexelBuffer),
    /// A host's view with a sampler, in a stated layout.
    SampledView {
        view: vk::ImageView,
        layout: vk::ImageLayout,
        sampler: &'a super::Sampler,
    },
    /// A host's view as a storage image, in `GENERAL`.
    StorageView(vk::ImageView),
}

fn descriptor_type(kind: DescriptorKind) -> vk::DescriptorType {
    match kind {
        DescriptorKind::UniformBuffer => vk::DescriptorType::UNIFORM_BUFFER,
        DescriptorKind::StorageBuffer => vk::DescriptorType::STORAGE_BUFFER,
        DescriptorKind::CombinedImageSampler => vk::DescriptorType::COMBINED_IMAGE_SAMPLER,
        DescriptorKind::SampledImage => vk::DescriptorType::SAMPLED_IMAGE,
        DescriptorKind::Sampler => vk::DescriptorType::SAMPLER,
        DescriptorKind::StorageImage => vk::DescriptorType::STORAGE_IMAGE,
        DescriptorKind::StorageTexelBuffer => vk::DescriptorType::STORAGE_TEXEL_BUFFER,
    }
}

impl Pipeline {
    /// Specializes a pass; ids that `constants` leaves out keep the shader's defaults. Booleans are 0 or 1.
    pub(crate) fn new(
        context: &Arc<Context>,
        interface: &'static PassInterface,
        constants: &[(u32, u32)],
    ) -> Result<Self> {
        let device = &context.device;
        let name = interface.module.name;
        let bindings: Vec<_> = interface
            .bindings
            .iter()
            .map(|b| {
                vk::DescriptorSetLayoutBinding::default()
                    .binding(b.binding)
                    .descriptor_type(descriptor_type(b.kind))
                    .descriptor_count(1)
                    .stage_flags(vk::ShaderStageFlags::COMPUTE)
            })
            .collect();
        let mut pipeline = Self {
            context: context.clone(),
            interface,
            handle: vk::Pipeline::null(),
            layout: vk::PipelineLayout::null(),
            set_layout: vk::DescriptorSetLayout::null(),
        };
        let set_info = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings);
        // SAFETY: the device is alive; bindings are distinct (checked against the SPIR-V by tests). Whatever fails
        // below, the pipeline's Drop destroys what was made (null handles are ignored by Vulkan).
        pipeline.set_layout = unsafe { device.create_descriptor_set_layout(&set_info, None) }
            .map_err(|e| context.vulkan_error("vkCreateDescriptorSetLayout", name, e))?;
        let push_ranges: Vec<_> = interface
            .push_constants
            .iter()
            .map(|layout| {
                vk::PushConstantRange::default()
                    .stage_flags(vk::ShaderStageFlags::COMPUTE)
                    .size(layout.size as u32)
            })
            .collect();
        let set_layouts = [pipeline.set_layout];
        let layout_info = vk::PipelineLayoutCreateInfo::default()
            .set_layouts(&set_layouts)
            .push_constant_ranges(&push_ranges);
        // SAFETY: the set layout is alive; push constants are at most 128 bytes (checked by tests).
        pipeline.layout = unsafe { device.create_pipeline_layout(&layout_info, None) }
            .map_err(|e| context.vulkan_error("vkCreatePipelineLayout", name, e))?;
        pipeline.handle = pipeline.compile(constants)?;
        context.debug.name(pipeline.handle, name);
        Ok(pipeline)
    }

    fn compile(&self, constants: &[(u32, u32)]) -> Result<vk::Pipeline> {
        let context = &self.context;
        let device = &context.device;
        let name = self.interface.module.name;
        let code = vk::ShaderModuleCreateInfo::default().code(self.interface.module.words);
        // SAFETY: the words are SPIR-V that CI validates for Vulkan 1.2 core.
        let module = unsafe { device.create_shader_module(&code, None) }
            .map_err(|e| context.vulkan_error("vkCreateShaderModule", name, e))?;
        let entries: Vec<_> = constants
            .iter()
            .enumerate()
            .map(|(i, &(id, _))| vk::SpecializationMapEntry {
                constant_id: id,
                offset: 4 * i as u32,
                size: 4,
            })
            .collect();
        let data: Vec<u8> = constants
            .iter()
            .flat_map(|(_, value)| value.to_ne_bytes())
            .collect();
        let specialization = vk::SpecializationInfo::default()
            .map_entries(&entries)
            .data(&data);
        let stage = vk::PipelineShaderStageCreateInfo::default()
            .stage(vk::ShaderStageFlags::COMPUTE)
            .module(module)
            .name(c"main")
            .specialization_info(&specialization);
        let info = vk::ComputePipelineCreateInfo::default()
            .stage(stage)
            .layout(self.layout);
        // SAFETY: module and layout are alive and match each other; the cache is null or the host's, which by contract
        // is valid and not used elsewhere while we record.
        let made =
            unsafe { device.create_compute_pipelines(context.pipeline_cache, &[info], None) };
        // SAFETY: pipelines do not need their modules once made.
        unsafe { device.destroy_shader_module(module, None) };
        match made {
            Ok(pipelines) => Ok(pipelines[0]),
            Err((_, e)) => Err(context.vulkan_error("vkCreateComputePipelines", name, e)),
        }
    }
}

impl Drop for Pipeline {
    fn drop(&mut self) {
        self.context
            .retire
            .push(Retired::Pipeline(self.handle, self.layout, self.set_layout));
    }
}

/// A descriptor set that binds `bound` (binding number, what) to a pipeline's interface.
///
/// # Safety
/// Views given by the host are valid until the frame completes; `slot` is that of the frame.
pub(super) unsafe fn descriptor_set(
    context: &Context,
    slot: &FrameSlot,
    pipeline: &Pipeline,
    bound: &[(u32, Bound<'_>)],
) -> Result<vk::DescriptorSet> {
    let device = &context.device;
    let layouts = [pipeline.set_layout];
    let info = vk::DescriptorSetAllocateInfo::default()
        .descriptor_pool(slot.descriptors)
        .set_layouts(&layouts);
    // SAFETY: pool and layout are alive; the pool is the frame's alone.
    let set = unsafe { device.allocate_descriptor_sets(&info) }
        .map_err(|e| {
            context.vulkan_error(
                "vkAllocateDescriptorSets",
                pipeline.interface.module.name,
                e,
            )
        })?
        .remove(0);
    for binding in pipeline.interface.bindings {
        let Some((_, what)) = bound.iter().find(|(number, _)| *number == binding.binding) else {
            unreachable!(
                "{} binding {} is not bound",
                pipeline.interface.module.name, binding.binding
            )
        };
        let mut images = [vk::DescriptorImageInfo::default()];
        let mut buffers = [vk::DescriptorBufferInfo::default()];
        let mut texels = [vk::BufferView::null()];
        let write = vk::WriteDescriptorSet::default()
            .dst_set(set)
            .dst_binding(binding.binding)
            .descriptor_type(descriptor_type(binding.kind));
        let write = match *what {
            Bound::Uniform(Uniforms { offset, bytes }) => {
                buffers[0] = vk::DescriptorBufferInfo {
                    buffer: slot.uniform_buffer().handle(),
                    offset,
                    range: bytes,
                };
                write.buffer_info(&buffers)
            }
            Bound::Storage(buffer) => {
                buffers[0] = vk::DescriptorBufferInfo {
                    buffer: buffer.handle(),
                    offset: 0,
                    range: vk::WHOLE_SIZE,
                };
                write.buffer_info(&buffers)
            }
            Bound::Sampled {
                image,
                sampler,
                general,
            } => {
                images[0] = vk::DescriptorImageInfo {
                    sampler: sampler.handle(),
                    image_view: image.view(),
                    image_layout: if general {
                        vk::ImageLayout::GENERAL
                    } else {
                        vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL
                    },
                };
                write.image_info(&images)
            }
            Bound::SampledView {
                view,
                layout,
                sampler,
            } => {
                images[0] = vk::DescriptorImageInfo {
                    sampler: sampler.handle(),
                    image_view: view,
                    image_layout: layout,
                };
                write.image_info(&images)
            }
            Bound::StorageImage(image) => {
                images[0] = vk::DescriptorImageInfo {
                    sampler: vk::Sampler::null(),
                    image_view: image.view(),
                    image_layout: vk::ImageLayout::GENERAL,
                };
                write.image_info(&images)
            }
            Bound::Texels(buffer) => {
                texels[0] = buffer.view();
                write.texel_buffer_view(&texels)
            }
            Bound::StorageView(view) => {
                images[0] = vk::DescriptorImageInfo {
                    sampler: vk::Sampler::null(),
                    image_view: view,
                    image_layout: vk::ImageLayout::GENERAL,
                };
                write.image_info(&images)
            }
        };
        // SAFETY: the set is fresh and in no command buffer yet; resources are alive and of the kind declared.
        unsafe { device.update_descriptor_sets(&[write], &[]) };
    }
    Ok(set)
}
