//! What each pass binds, declared once: pipeline layouts and descriptor sets are built from it, and
//! `tests/shaders.rs` checks it against the SPIR-V.

use super::{Module, StructLayout};

/// The interface of one compute pass.
#[derive(Clone, Copy, Debug)]
pub struct PassInterface {
    /// The shader.
    pub module: &'static Module,
    /// Descriptors that the shader uses, by set and binding ascending.
    pub bindings: &'static [Binding],
    /// Mirror of the push constants, `None` when the shader has none.
    pub push_constants: Option<StructLayout>,
    /// Ids of the specialization constants, ascending.
    pub spec_ids: &'static [u32],
    /// Invocations of a workgroup on x, y, z.
    pub local_size: [u32; 3],
}

/// One descriptor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Binding {
    /// Descriptor set.
    pub set: u32,
    /// Binding within the set.
    pub binding: u32,
    /// Kind of descriptor.
    pub kind: DescriptorKind,
    /// What the shader does with it; uniform buffers, sampled images and samplers are only read.
    pub access: Access,
}

/// Kinds of descriptors, as in `VkDescriptorType`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum DescriptorKind {
    /// `uniform` block.
    UniformBuffer,
    /// `buffer` block.
    StorageBuffer,
    /// `sampler3D` and its like: image and sampler in one.
    CombinedImageSampler,
    /// `texture3D` and its like.
    SampledImage,
    /// `sampler`.
    Sampler,
    /// `image3D` and its like.
    StorageImage,
}

/// What a shader does with a descriptor: `readonly`, `writeonly` or neither in GLSL.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Access {
    /// Reads only.
    Read,
    /// Writes only.
    Write,
    /// Reads and writes.
    ReadWrite,
}

/// Every pass. A module in `spirv/` that is missing here fails `tests/shaders.rs`.
pub const PASSES: &[PassInterface] = &[];
