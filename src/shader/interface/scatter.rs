//! Passes on the grid of scattered light.

use super::{Access, PassInterface, sampled, storage_buffer, storage_image, texel_buffer, uniform};
use crate::shader::GpuStruct as _;
use crate::shader::generated::{self, *};
use crate::shader::structs::ScatterPush;

/// Of passes on the grid that know lights and phase function.
const GRID_SPEC_IDS: &[u32] = &[
    SPEC_INTERPOLATION,
    SPEC_BLOCKS_APART,
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
];

/// The medium, averaged over the cells of the grid of scattered light.
pub const GRID_MEDIUM: PassInterface = PassInterface {
    module: &generated::GRID_MEDIUM,
    bindings: &[
        uniform(BINDING_VOLUME),
        sampled(BINDING_ATLAS),
        sampled(BINDING_INDEX),
        sampled(BINDING_TRANSFER),
        sampled(BINDING_LABELS),
        sampled(BINDING_LABEL_TABLE),
        uniform(BINDING_MEDIUM),
        storage_image(BINDING_GRID_MEDIUM_STORE, Access::Write),
        storage_image(BINDING_GRID_EMISSION_STORE, Access::Write),
        texel_buffer(BINDING_PACKED_CELLS, Access::Read),
        storage_image(BINDING_TRANSFER_LOADS, Access::Read),
        storage_image(BINDING_INDEX_LOADS, Access::Read),
    ],
    push_constants: None,
    spec_ids: &[
        SPEC_INTERPOLATION,
        SPEC_BLOCKS_APART,
        SPEC_EMISSION,
        SPEC_MANUAL_FILTER,
        SPEC_UNIFORM_GRID,
        SPEC_EXACT_BINS,
        SPEC_LABELS,
        SPEC_GLOWS,
        SPEC_PACKED_CELLS,
        SPEC_LOADS,
    ],
    local_size: [4, 4, 4],
};

/// Discrete ordinates: redistribution by the phase function.
pub const ORDINATES_SOURCE: PassInterface = PassInterface {
    module: &generated::ORDINATES_SOURCE,
    bindings: &[
        uniform(BINDING_VOLUME),
        uniform(BINDING_MEDIUM),
        sampled(BINDING_SHADOW),
        sampled(BINDING_PHASE),
        sampled(BINDING_GRID_MEDIUM),
        sampled(BINDING_GRID_EMISSION),
        sampled(BINDING_BINS),
        sampled(BINDING_PHASE_MATRIX),
        storage_image(BINDING_INTENSITY_STORE, Access::Read),
        storage_image(BINDING_SOURCE_STORE, Access::Write),
        storage_image(BINDING_FLUENCE_STORE, Access::ReadWrite),
        storage_buffer(BINDING_RESIDUAL),
    ],
    push_constants: Some(ScatterPush::LAYOUT),
    spec_ids: GRID_SPEC_IDS,
    local_size: [4, 4, 4],
};

/// Discrete ordinates: propagation by one layer.
pub const ORDINATES_SWEEP: PassInterface = PassInterface {
    module: &generated::ORDINATES_SWEEP,
    bindings: &[
        uniform(BINDING_VOLUME),
        uniform(BINDING_MEDIUM),
        sampled(BINDING_ENVIRONMENT),
        sampled(BINDING_GRID_MEDIUM),
        sampled(BINDING_BINS),
        storage_image(BINDING_INTENSITY_STORE, Access::ReadWrite),
        storage_image(BINDING_SOURCE_STORE, Access::Read),
    ],
    push_constants: Some(ScatterPush::LAYOUT),
    spec_ids: GRID_SPEC_IDS,
    local_size: [8, 8, 1],
};

/// Discrete ordinates: what is scattered towards the eye.
pub const ORDINATES_GATHER: PassInterface = PassInterface {
    module: &generated::ORDINATES_GATHER,
    bindings: &[
        uniform(BINDING_VOLUME),
        uniform(BINDING_MEDIUM),
        sampled(BINDING_PHASE),
        sampled(BINDING_BINS),
        storage_image(BINDING_INTENSITY_STORE, Access::Read),
        storage_image(BINDING_SCATTERED_STORE, Access::Write),
    ],
    push_constants: Some(ScatterPush::LAYOUT),
    spec_ids: &[
        SPEC_INTERPOLATION,
        SPEC_BLOCKS_APART,
        SPEC_EMISSION,
        SPEC_MANUAL_FILTER,
        SPEC_UNIFORM_GRID,
        SPEC_EXACT_BINS,
        SPEC_LABELS,
        SPEC_PHASE,
        SPEC_GLOWS,
        SPEC_PACKED_CELLS,
        SPEC_LOADS,
    ],
    local_size: [4, 4, 4],
};

/// Source of diffusion, and of the zonal method.
pub const DIFFUSION_SOURCE: PassInterface = PassInterface {
    module: &generated::DIFFUSION_SOURCE,
    bindings: &[
        uniform(BINDING_VOLUME),
        uniform(BINDING_MEDIUM),
        sampled(BINDING_SHADOW),
        sampled(BINDING_GRID_MEDIUM),
        sampled(BINDING_GRID_EMISSION),
        storage_image(BINDING_SOURCE_STORE, Access::ReadWrite),
        storage_image(BINDING_FLUENCE_STORE, Access::ReadWrite),
    ],
    push_constants: Some(ScatterPush::LAYOUT),
    spec_ids: GRID_SPEC_IDS,
    local_size: [4, 4, 4],
};

/// Diffusion: half a step of relaxation.
pub const DIFFUSION_RELAX: PassInterface = PassInterface {
    module: &generated::DIFFUSION_RELAX,
    bindings: &[
        uniform(BINDING_VOLUME),
        uniform(BINDING_MEDIUM),
        sampled(BINDING_ENVIRONMENT),
        sampled(BINDING_GRID_MEDIUM),
        storage_image(BINDING_SOURCE_STORE, Access::ReadWrite),
        storage_image(BINDING_FLUENCE_STORE, Access::ReadWrite),
        storage_buffer(BINDING_RESIDUAL),
    ],
    push_constants: Some(ScatterPush::LAYOUT),
    spec_ids: GRID_SPEC_IDS,
    local_size: [4, 4, 4],
};

/// Diffusion and the zonal method: what is scattered towards the eye.
pub const DIFFUSE_GATHER: PassInterface = PassInterface {
    module: &generated::DIFFUSE_GATHER,
    bindings: &[
        uniform(BINDING_VOLUME),
        uniform(BINDING_MEDIUM),
        sampled(BINDING_GRID_MEDIUM),
        storage_image(BINDING_SOURCE_STORE, Access::ReadWrite),
        storage_image(BINDING_FLUENCE_STORE, Access::ReadWrite),
        storage_image(BINDING_SCATTERED_STORE, Access::Write),
    ],
    push_constants: Some(ScatterPush::LAYOUT),
    spec_ids: GRID_SPEC_IDS,
    local_size: [4, 4, 4],
};

/// The zonal method: one exchange between all zones.
pub const ZONAL: PassInterface = PassInterface {
    module: &generated::ZONAL,
    bindings: &[
        uniform(BINDING_VOLUME),
        uniform(BINDING_MEDIUM),
        sampled(BINDING_ENVIRONMENT),
        sampled(BINDING_GRID_MEDIUM),
        sampled(BINDING_BINS),
        storage_image(BINDING_SOURCE_STORE, Access::ReadWrite),
        storage_image(BINDING_FLUENCE_STORE, Access::ReadWrite),
        storage_buffer(BINDING_RESIDUAL),
    ],
    push_constants: Some(ScatterPush::LAYOUT),
    spec_ids: GRID_SPEC_IDS,
    local_size: [8, 8, 1],
};
