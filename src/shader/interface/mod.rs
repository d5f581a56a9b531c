//! What each pass binds, declared once: pipeline layouts and descriptor sets are built from it, and
//! `tests/shaders.rs` checks it against the SPIR-V.

mod march;
mod scatter;
mod transport;

pub use march::{BEAMS, MARCH, MARCH_ENDS, MARCH_ENDS_VOTES, MARCH_VOTES};
pub use scatter::{
    DIFFUSE_GATHER, DIFFUSION_RELAX, DIFFUSION_SOURCE, GRID_MEDIUM, ORDINATES_GATHER,
    ORDINATES_SOURCE, ORDINATES_SWEEP, ZONAL,
};
pub use transport::{PATHTRACE, SHADOW_SWEEP, TRANSPORT};

use super::generated::{self, *};
use super::structs::{BarePush, LightPush, MarchPush, PackPush, PartPush};
use super::{GpuStruct, Module, StructLayout};

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
    /// `imageBuffer` and its like.
    StorageTexelBuffer,
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

const fn binding(binding: u32, kind: DescriptorKind, access: Access) -> Binding {
    Binding {
        set: 0,
        binding,
        kind,
        access,
    }
}

const fn uniform(number: u32) -> Binding {
    binding(number, DescriptorKind::UniformBuffer, Access::Read)
}

const fn sampled(number: u32) -> Binding {
    binding(number, DescriptorKind::CombinedImageSampler, Access::Read)
}

const fn storage_read(number: u32) -> Binding {
    binding(number, DescriptorKind::StorageBuffer, Access::Read)
}

const fn storage_buffer(number: u32) -> Binding {
    binding(number, DescriptorKind::StorageBuffer, Access::ReadWrite)
}

const fn storage_image(number: u32, access: Access) -> Binding {
    binding(number, DescriptorKind::StorageImage, access)
}

const fn texel_buffer(number: u32, access: Access) -> Binding {
    binding(number, DescriptorKind::StorageTexelBuffer, access)
}

/// The programs of one kind of picture, by what they do with the target.
#[derive(Clone, Copy, Debug)]
pub struct PicturePasses {
    /// Into a target of any format, whose contents do not matter.
    pub any: PassInterface,
    /// Over what an `R8G8B8A8_UNORM` target holds.
    pub blend_rgba8: PassInterface,
    /// Over what an `R16G16B16A16_SFLOAT` target holds.
    pub blend_rgba16f: PassInterface,
    /// Over what an `R32G32B32A32_SFLOAT` target holds.
    pub blend_rgba32f: PassInterface,
}

/// `modules` in the order of the fields; `bindings` without and with reading of the target.
const fn picture(
    modules: [&'static Module; 4],
    bindings: [&'static [Binding]; 2],
    spec_ids: &'static [u32],
) -> PicturePasses {
    const fn pass(
        module: &'static Module,
        bindings: &'static [Binding],
        spec_ids: &'static [u32],
    ) -> PassInterface {
        PassInterface {
            module,
            bindings,
            push_constants: Some(MarchPush::LAYOUT),
            spec_ids,
            local_size: [8, 8, 1],
        }
    }
    PicturePasses {
        any: pass(modules[0], bindings[0], spec_ids),
        blend_rgba8: pass(modules[1], bindings[1], spec_ids),
        blend_rgba16f: pass(modules[2], bindings[1], spec_ids),
        blend_rgba32f: pass(modules[3], bindings[1], spec_ids),
    }
}

const EXTREMUM_SPEC_IDS: &[u32] = &[
    SPEC_INTERPOLATION,
    SPEC_BLOCKS_APART,
    SPEC_SKIPPING,
    SPEC_EMISSION,
    SPEC_JITTER,
    SPEC_AUX,
    SPEC_SCENE_DEPTH,
    SPEC_ENCODE_SRGB,
    SPEC_MANUAL_FILTER,
    SPEC_UNIFORM_GRID,
    SPEC_EXACT_BINS,
    SPEC_PROJECTION,
    SPEC_LABELS,
    SPEC_PACKED_CELLS,
    SPEC_RUNS,
    SPEC_LOADS,
];

const fn extremum_bindings(target: Access) -> [Binding; 14] {
    [
        uniform(BINDING_VOLUME),
        uniform(BINDING_FRAME),
        sampled(BINDING_ATLAS),
        sampled(BINDING_INDEX),
        sampled(BINDING_TRANSFER),
        sampled(BINDING_SCENE_DEPTH),
        storage_image(BINDING_TARGET, target),
        storage_image(BINDING_AUX, Access::Write),
        sampled(BINDING_RANGE),
        sampled(BINDING_LABELS),
        sampled(BINDING_LABEL_TABLE),
        texel_buffer(BINDING_PACKED_CELLS, Access::Read),
        storage_image(BINDING_TRANSFER_LOADS, Access::Read),
        storage_image(BINDING_INDEX_LOADS, Access::Read),
    ]
}

/// The largest, smallest or mean sample of each ray.
pub const EXTREMUM: PicturePasses = picture(
    [
        &generated::EXTREMUM,
        &generated::EXTREMUM_BLEND_RGBA8,
        &generated::EXTREMUM_BLEND_RGBA16F,
        &generated::EXTREMUM_BLEND_RGBA32F,
    ],
    [
        &extremum_bindings(Access::Write),
        &extremum_bindings(Access::ReadWrite),
    ],
    EXTREMUM_SPEC_IDS,
);

const ISOSURFACE_SPEC_IDS: &[u32] = &[
    SPEC_INTERPOLATION,
    SPEC_BLOCKS_APART,
    SPEC_SKIPPING,
    SPEC_LIGHT,
    SPEC_DIFFUSE,
    SPEC_JITTER,
    SPEC_AUX,
    SPEC_SCENE_DEPTH,
    SPEC_ENCODE_SRGB,
    SPEC_MANUAL_FILTER,
    SPEC_UNIFORM_GRID,
    SPEC_GRADIENT,
    SPEC_LABELS,
    SPEC_STORED_GRADIENTS,
    SPEC_PACKED_CELLS,
    SPEC_RUNS,
    SPEC_LOADS,
];

const fn isosurface_bindings(target: Access) -> [Binding; 19] {
    [
        uniform(BINDING_VOLUME),
        uniform(BINDING_FRAME),
        sampled(BINDING_ATLAS),
        sampled(BINDING_INDEX),
        sampled(BINDING_SKIP),
        sampled(BINDING_LIGHT),
        sampled(BINDING_SCENE_DEPTH),
        storage_image(BINDING_TARGET, target),
        storage_image(BINDING_AUX, Access::Write),
        uniform(BINDING_SURFACES),
        sampled(BINDING_LABELS),
        sampled(BINDING_LABEL_TABLE),
        sampled(BINDING_GRADIENTS),
        texel_buffer(BINDING_GRADIENTS_TEN_BITS, Access::Read),
        texel_buffer(BINDING_PACKED_CELLS, Access::Read),
        storage_image(BINDING_SKIP_LOADS, Access::Read),
        texel_buffer(BINDING_GRADIENTS_HALVES, Access::Read),
        texel_buffer(BINDING_GRADIENTS_IN_FOURS, Access::Read),
        storage_image(BINDING_INDEX_LOADS, Access::Read),
    ]
}

/// Surfaces of equal value.
pub const ISOSURFACE: PicturePasses = picture(
    [
        &generated::ISOSURFACE,
        &generated::ISOSURFACE_BLEND_RGBA8,
        &generated::ISOSURFACE_BLEND_RGBA16F,
        &generated::ISOSURFACE_BLEND_RGBA32F,
    ],
    [
        &isosurface_bindings(Access::Write),
        &isosurface_bindings(Access::ReadWrite),
    ],
    ISOSURFACE_SPEC_IDS,
);

/// Gradients at voxels.
pub const GRADIENTS: PassInterface = PassInterface {
    module: &generated::GRADIENTS,
    bindings: &[
        uniform(BINDING_VOLUME),
        sampled(BINDING_ATLAS),
        sampled(BINDING_INDEX),
        texel_buffer(BINDING_GRADIENTS_TEN_BITS, Access::Write),
        storage_read(BINDING_CHUNKS),
        texel_buffer(BINDING_PACKED_CELLS, Access::Read),
        texel_buffer(BINDING_GRADIENTS_HALVES, Access::Write),
        storage_image(BINDING_GRADIENTS_STORE, Access::Write),
        texel_buffer(BINDING_GRADIENTS_IN_FOURS, Access::Write),
        storage_image(BINDING_INDEX_LOADS, Access::Read),
    ],
    push_constants: Some(PartPush::LAYOUT),
    spec_ids: &[
        SPEC_INTERPOLATION,
        SPEC_BLOCKS_APART,
        SPEC_MANUAL_FILTER,
        SPEC_UNIFORM_GRID,
        SPEC_GRADIENT,
        SPEC_STORED_GRADIENTS,
        SPEC_PACKED_CELLS,
        SPEC_LOADS,
    ],
    local_size: [4, 4, 4],
};

/// Corners of voxel cells, packed.
pub const PACK_CELLS: PassInterface = PassInterface {
    module: &generated::PACK_CELLS,
    bindings: &[
        sampled(BINDING_ATLAS),
        texel_buffer(BINDING_PACKED_CELLS_STORE, Access::Write),
    ],
    push_constants: Some(PackPush::LAYOUT),
    spec_ids: &[SPEC_PACKED_CELLS],
    local_size: [128, 1, 1],
};

/// The table of pre-integrated classification.
pub const PREINTEGRATE: PassInterface = PassInterface {
    module: &generated::PREINTEGRATE,
    bindings: &[
        sampled(BINDING_INTEGRALS),
        storage_image(BINDING_PREINTEGRATED_STORE, Access::Write),
        storage_image(BINDING_PREINTEGRATED_EMISSION_STORE, Access::Write),
        storage_image(BINDING_INTEGRALS_LOADS, Access::Read),
    ],
    push_constants: None,
    spec_ids: &[SPEC_EMISSION, SPEC_LOADS],
    local_size: [8, 8, 1],
};

/// One direction of local ambient occlusion.
pub const LIGHT_TRACE: PassInterface = PassInterface {
    module: &generated::LIGHT_TRACE,
    bindings: &[
        uniform(BINDING_VOLUME),
        sampled(BINDING_ATLAS),
        sampled(BINDING_INDEX),
        sampled(BINDING_SKIP),
        sampled(BINDING_TRANSFER),
        storage_read(BINDING_BRICKS),
        storage_read(BINDING_WORK),
        storage_image(BINDING_LIGHT_STORE, Access::ReadWrite),
        sampled(BINDING_LABELS),
        sampled(BINDING_LABEL_TABLE),
        texel_buffer(BINDING_PACKED_CELLS, Access::Read),
        storage_image(BINDING_SKIP_LOADS, Access::Read),
        storage_image(BINDING_TRANSFER_LOADS, Access::Read),
        storage_image(BINDING_INDEX_LOADS, Access::Read),
    ],
    push_constants: Some(LightPush::LAYOUT),
    spec_ids: &[
        SPEC_INTERPOLATION,
        SPEC_BLOCKS_APART,
        SPEC_SKIPPING,
        SPEC_EMISSION,
        SPEC_MANUAL_FILTER,
        SPEC_UNIFORM_GRID,
        SPEC_EXACT_BINS,
        SPEC_LABELS,
        SPEC_COUNT,
        SPEC_PACKED_CELLS,
        SPEC_GROWTH,
        SPEC_RUNS,
        SPEC_LOADS,
    ],
    local_size: [4, 4, 4],
};

/// Light on the borders of bricks.
pub const LIGHT_SEAM: PassInterface = PassInterface {
    module: &generated::LIGHT_SEAM,
    bindings: &[
        uniform(BINDING_VOLUME),
        sampled(BINDING_INDEX),
        storage_read(BINDING_BRICKS),
        storage_read(BINDING_WORK),
        storage_image(BINDING_LIGHT_STORE, Access::ReadWrite),
        storage_image(BINDING_INDEX_LOADS, Access::Read),
    ],
    push_constants: Some(PartPush::LAYOUT),
    spec_ids: &[SPEC_UNIFORM_GRID, SPEC_RUNS, SPEC_LOADS],
    local_size: [4, 4, 4],
};

/// The bench's bare march.
pub const BARE: PassInterface = PassInterface {
    module: &generated::BARE,
    bindings: &[
        uniform(BINDING_VOLUME),
        uniform(BINDING_FRAME),
        sampled(BINDING_TRANSFER),
        storage_image(BINDING_TARGET, Access::Write),
        sampled(BINDING_VOXELS),
        texel_buffer(BINDING_PACKED_CELLS, Access::Read),
        storage_image(BINDING_TRANSFER_LOADS, Access::Read),
    ],
    push_constants: Some(BarePush::LAYOUT),
    spec_ids: &[
        SPEC_EMISSION,
        SPEC_EXACT_BINS,
        SPEC_PACKED_CELLS,
        SPEC_RUNS,
        SPEC_LOADS,
    ],
    local_size: [8, 8, 1],
};

/// The bench's bare light.
pub const BARE_LIGHT: PassInterface = PassInterface {
    module: &generated::BARE_LIGHT,
    bindings: &[
        uniform(BINDING_VOLUME),
        sampled(BINDING_TRANSFER),
        storage_read(BINDING_BRICKS),
        storage_read(BINDING_WORK),
        storage_image(BINDING_LIGHT_STORE, Access::Write),
        sampled(BINDING_VOXELS),
        texel_buffer(BINDING_PACKED_CELLS, Access::Read),
        storage_image(BINDING_TRANSFER_LOADS, Access::Read),
    ],
    push_constants: Some(LightPush::LAYOUT),
    spec_ids: &[
        SPEC_EMISSION,
        SPEC_UNIFORM_GRID,
        SPEC_EXACT_BINS,
        SPEC_PACKED_CELLS,
        SPEC_RUNS,
        SPEC_LOADS,
    ],
    local_size: [4, 4, 4],
};

/// Every pass. A module in `spirv/` that is missing here fails `tests/shaders.rs`.
pub const PASSES: &[PassInterface] = &[
    MARCH.any,
    MARCH_VOTES,
    MARCH_ENDS_VOTES,
    MARCH.blend_rgba8,
    MARCH.blend_rgba16f,
    MARCH.blend_rgba32f,
    MARCH_ENDS.any,
    MARCH_ENDS.blend_rgba8,
    MARCH_ENDS.blend_rgba16f,
    MARCH_ENDS.blend_rgba32f,
    BEAMS.any,
    BEAMS.blend_rgba8,
    BEAMS.blend_rgba16f,
    BEAMS.blend_rgba32f,
    EXTREMUM.any,
    EXTREMUM.blend_rgba8,
    EXTREMUM.blend_rgba16f,
    EXTREMUM.blend_rgba32f,
    ISOSURFACE.any,
    ISOSURFACE.blend_rgba8,
    ISOSURFACE.blend_rgba16f,
    ISOSURFACE.blend_rgba32f,
    TRANSPORT.any,
    TRANSPORT.blend_rgba8,
    TRANSPORT.blend_rgba16f,
    TRANSPORT.blend_rgba32f,
    PATHTRACE.any,
    PATHTRACE.blend_rgba8,
    PATHTRACE.blend_rgba16f,
    PATHTRACE.blend_rgba32f,
    GRADIENTS,
    PACK_CELLS,
    PREINTEGRATE,
    LIGHT_TRACE,
    LIGHT_SEAM,
    SHADOW_SWEEP,
    GRID_MEDIUM,
    ORDINATES_SOURCE,
    ORDINATES_SWEEP,
    ORDINATES_GATHER,
    DIFFUSION_SOURCE,
    DIFFUSION_RELAX,
    DIFFUSE_GATHER,
    ZONAL,
    BARE,
    BARE_LIGHT,
];
