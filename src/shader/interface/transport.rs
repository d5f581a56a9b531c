//! Passes of the optical models: marched, traced, swept.

use super::{
    Access, Binding, PassInterface, PicturePasses, picture, sampled, storage_image, texel_buffer,
    uniform,
};
use crate::shader::GpuStruct as _;
use crate::shader::generated::{self, *};
use crate::shader::structs::SweepPush;

const TRANSPORT_SPEC_IDS: &[u32] = &[
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
    SPEC_GRADIENT,
    SPEC_LABELS,
    SPEC_MODEL,
    SPEC_PHASE,
    SPEC_GLOWS,
    SPEC_SHADOWS,
    SPEC_REFLECTANCE,
    SPEC_ENVIRONMENT,
    SPEC_CHROMATIC,
    SPEC_SCATTERED,
    SPEC_STORED_GRADIENTS,
    SPEC_PACKED_CELLS,
    SPEC_RUNS,
    SPEC_LOADS,
];

const fn transport_bindings(target: Access) -> [Binding; 25] {
    [
        uniform(BINDING_VOLUME),
        uniform(BINDING_FRAME),
        sampled(BINDING_ATLAS),
        sampled(BINDING_INDEX),
        sampled(BINDING_SKIP),
        sampled(BINDING_TRANSFER),
        sampled(BINDING_SCENE_DEPTH),
        storage_image(BINDING_TARGET, target),
        storage_image(BINDING_AUX, Access::Write),
        sampled(BINDING_LABELS),
        sampled(BINDING_LABEL_TABLE),
        uniform(BINDING_MEDIUM),
        sampled(BINDING_SHADOW),
        sampled(BINDING_SCATTERED),
        sampled(BINDING_ENVIRONMENT),
        sampled(BINDING_PHASE),
        storage_image(BINDING_THROUGH, Access::Write),
        sampled(BINDING_GRADIENTS),
        texel_buffer(BINDING_GRADIENTS_TEN_BITS, Access::Read),
        texel_buffer(BINDING_PACKED_CELLS, Access::Read),
        storage_image(BINDING_SKIP_LOADS, Access::Read),
        storage_image(BINDING_TRANSFER_LOADS, Access::Read),
        texel_buffer(BINDING_GRADIENTS_HALVES, Access::Read),
        texel_buffer(BINDING_GRADIENTS_IN_FOURS, Access::Read),
        storage_image(BINDING_INDEX_LOADS, Access::Read),
    ]
}

/// Max's optical models.
pub const TRANSPORT: PicturePasses = picture(
    [
        &generated::TRANSPORT,
        &generated::TRANSPORT_BLEND_RGBA8,
        &generated::TRANSPORT_BLEND_RGBA16F,
        &generated::TRANSPORT_BLEND_RGBA32F,
    ],
    [
        &transport_bindings(Access::Write),
        &transport_bindings(Access::ReadWrite),
    ],
    TRANSPORT_SPEC_IDS,
);

const PATHTRACE_SPEC_IDS: &[u32] = &[
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
    SPEC_LABELS,
    SPEC_PHASE,
    SPEC_GLOWS,
    SPEC_ENVIRONMENT,
    SPEC_GLOBAL_MAJORANT,
    SPEC_PACKED_CELLS,
    SPEC_RUNS,
    SPEC_LOADS,
];

const fn pathtrace_bindings(target: Access) -> [Binding; 22] {
    [
        uniform(BINDING_VOLUME),
        uniform(BINDING_FRAME),
        sampled(BINDING_ATLAS),
        sampled(BINDING_INDEX),
        sampled(BINDING_SKIP),
        sampled(BINDING_TRANSFER),
        sampled(BINDING_SCENE_DEPTH),
        storage_image(BINDING_TARGET, target),
        storage_image(BINDING_AUX, Access::Write),
        sampled(BINDING_LABELS),
        sampled(BINDING_LABEL_TABLE),
        uniform(BINDING_MEDIUM),
        sampled(BINDING_ENVIRONMENT),
        sampled(BINDING_PHASE),
        sampled(BINDING_MAJORANT),
        storage_image(BINDING_PATHS_SUM, Access::ReadWrite),
        storage_image(BINDING_PATHS_SQUARE, Access::ReadWrite),
        storage_image(BINDING_PATHS_THROUGH, Access::ReadWrite),
        texel_buffer(BINDING_PACKED_CELLS, Access::Read),
        storage_image(BINDING_SKIP_LOADS, Access::Read),
        storage_image(BINDING_TRANSFER_LOADS, Access::Read),
        storage_image(BINDING_INDEX_LOADS, Access::Read),
    ]
}

/// Multiple scattering by Monte Carlo.
pub const PATHTRACE: PicturePasses = picture(
    [
        &generated::PATHTRACE,
        &generated::PATHTRACE_BLEND_RGBA8,
        &generated::PATHTRACE_BLEND_RGBA16F,
        &generated::PATHTRACE_BLEND_RGBA32F,
    ],
    [
        &pathtrace_bindings(Access::Write),
        &pathtrace_bindings(Access::ReadWrite),
    ],
    PATHTRACE_SPEC_IDS,
);

/// One layer of a sweep of flux from a light.
pub const SHADOW_SWEEP: PassInterface = PassInterface {
    module: &generated::SHADOW_SWEEP,
    bindings: &[
        uniform(BINDING_VOLUME),
        sampled(BINDING_ATLAS),
        sampled(BINDING_INDEX),
        sampled(BINDING_SKIP),
        sampled(BINDING_TRANSFER),
        sampled(BINDING_LABELS),
        sampled(BINDING_LABEL_TABLE),
        uniform(BINDING_MEDIUM),
        storage_image(BINDING_SHADOW_STORE, Access::ReadWrite),
        texel_buffer(BINDING_PACKED_CELLS, Access::Read),
        storage_image(BINDING_SKIP_LOADS, Access::Read),
        storage_image(BINDING_TRANSFER_LOADS, Access::Read),
        storage_image(BINDING_INDEX_LOADS, Access::Read),
    ],
    push_constants: Some(SweepPush::LAYOUT),
    spec_ids: &[
        SPEC_INTERPOLATION,
        SPEC_BLOCKS_APART,
        SPEC_SKIPPING,
        SPEC_EMISSION,
        SPEC_MANUAL_FILTER,
        SPEC_UNIFORM_GRID,
        SPEC_EXACT_BINS,
        SPEC_LABELS,
        SPEC_PHASE,
        SPEC_GLOWS,
        SPEC_ENVIRONMENT,
        SPEC_PACKED_CELLS,
        SPEC_LOADS,
    ],
    local_size: [8, 8, 1],
};
