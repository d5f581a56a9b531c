//! The march of emission and absorption, and the beams before it.

use super::super::generated::{self, *};
use super::{
    Access, Binding, PassInterface, PicturePasses, picture, sampled, storage_buffer, storage_image,
    storage_read, texel_buffer, uniform,
};

/// Specialization constants of both programs of the march, and the one that picks a classification where there are several.
macro_rules! march_spec_ids {
    ($($classification:ident)?) => {
        &[
            SPEC_INTERPOLATION,
            SPEC_BLOCKS_APART,
            SPEC_SKIPPING,
            SPEC_EMISSION,
            SPEC_LIGHT,
            SPEC_DIFFUSE,
            SPEC_JITTER,
            SPEC_AUX,
            SPEC_SCENE_DEPTH,
            SPEC_ENCODE_SRGB,
            SPEC_MANUAL_FILTER,
            SPEC_UNIFORM_GRID,
            SPEC_EXACT_BINS,
            $($classification,)?
            SPEC_GRADIENT,
            SPEC_XRAY,
            SPEC_LABELS,
            SPEC_DATA_COLOR,
            SPEC_STORED_GRADIENTS,
            SPEC_PACKED_CELLS,
            SPEC_RUNS,
            SPEC_LOADS,
            SPEC_BEAMS,
            SPEC_SEARCHED,
            SPEC_SHOWN_CELLS,
            SPEC_PAIRED,
        ]
    };
}

/// What both programs of the march bind, and the tables that one of them reads.
macro_rules! march_bindings {
    ($target:expr; $($table:ident)*; $($loads:ident)*) => {
        &[
            uniform(BINDING_VOLUME),
            uniform(BINDING_FRAME),
            sampled(BINDING_ATLAS),
            sampled(BINDING_INDEX),
            sampled(BINDING_SKIP),
            sampled(BINDING_TRANSFER),
            sampled(BINDING_LIGHT),
            sampled(BINDING_SCENE_DEPTH),
            storage_image(BINDING_TARGET, $target),
            storage_image(BINDING_AUX, Access::Write),
            $(sampled($table),)*
            sampled(BINDING_LABELS),
            sampled(BINDING_LABEL_TABLE),
            sampled(BINDING_COLOR),
            sampled(BINDING_GRADIENTS),
            texel_buffer(BINDING_GRADIENTS_TEN_BITS, Access::Read),
            texel_buffer(BINDING_PACKED_CELLS, Access::Read),
            storage_image(BINDING_SKIP_LOADS, Access::Read),
            storage_image(BINDING_TRANSFER_LOADS, Access::Read),
            $(storage_image($loads, Access::Read),)*
            texel_buffer(BINDING_GRADIENTS_HALVES, Access::Read),
            storage_read(BINDING_BEAM_TILES),
            storage_read(BINDING_BEAM_LIST),
            storage_read(BINDING_BEAM_RUNS),
            texel_buffer(BINDING_GRADIENTS_IN_FOURS, Access::Read),
            storage_image(BINDING_INDEX_LOADS, Access::Read),
        ]
    };
}

macro_rules! march_ends_bindings {
    ($target:expr) => {
        march_bindings!(
            $target;
            BINDING_PREINTEGRATED BINDING_PREINTEGRATED_EMISSION;
            BINDING_PREINTEGRATED_LOADS BINDING_PREINTEGRATED_EMISSION_LOADS
        )
    };
}

/// Emission and absorption, sampled at the middles of segments.
pub const MARCH: PicturePasses = picture(
    [
        &generated::MARCH,
        &generated::MARCH_BLEND_RGBA8,
        &generated::MARCH_BLEND_RGBA16F,
        &generated::MARCH_BLEND_RGBA32F,
    ],
    [
        march_bindings!(Access::Write; ;),
        march_bindings!(Access::ReadWrite; ;),
    ],
    march_spec_ids!(SPEC_CLASSIFICATION),
);

/// The same, sampled at the ends of segments and integrated between.
pub const MARCH_ENDS: PicturePasses = picture(
    [
        &generated::MARCH_ENDS,
        &generated::MARCH_ENDS_BLEND_RGBA8,
        &generated::MARCH_ENDS_BLEND_RGBA16F,
        &generated::MARCH_ENDS_BLEND_RGBA32F,
    ],
    [
        march_ends_bindings!(Access::Write),
        march_ends_bindings!(Access::ReadWrite),
    ],
    march_spec_ids!(),
);

/// [`MARCH`] into a target of any format, by rays of a subgroup that search together for what shows something.
pub const MARCH_VOTES: PassInterface = PassInterface {
    module: &generated::MARCH_VOTES,
    ..MARCH.any
};

/// [`MARCH_ENDS`] likewise.
pub const MARCH_ENDS_VOTES: PassInterface = PassInterface {
    module: &generated::MARCH_ENDS_VOTES,
    ..MARCH_ENDS.any
};

const BEAMS_SPEC_IDS: &[u32] = &[
    SPEC_SKIPPING,
    SPEC_JITTER,
    SPEC_AUX,
    SPEC_SCENE_DEPTH,
    SPEC_ENCODE_SRGB,
    SPEC_UNIFORM_GRID,
    SPEC_CLASSIFICATION,
    SPEC_XRAY,
    SPEC_RUNS,
    SPEC_LOADS,
    SPEC_CLEARED,
    SPEC_SHOWN_CELLS,
];

const fn beams_bindings(target: Access) -> [Binding; 10] {
    [
        uniform(BINDING_VOLUME),
        uniform(BINDING_FRAME),
        sampled(BINDING_SKIP),
        storage_image(BINDING_TARGET, target),
        storage_image(BINDING_AUX, Access::Write),
        storage_image(BINDING_SKIP_LOADS, Access::Read),
        storage_buffer(BINDING_BEAM_TILES),
        storage_buffer(BINDING_BEAM_LIST),
        storage_buffer(BINDING_BEAM_RUNS),
        texel_buffer(BINDING_SHOWN_CELLS, Access::Read),
    ]
}

/// Where the march has something to do.
pub const BEAMS: PicturePasses = picture(
    [
        &generated::BEAMS,
        &generated::BEAMS_BLEND_RGBA8,
        &generated::BEAMS_BLEND_RGBA16F,
        &generated::BEAMS_BLEND_RGBA32F,
    ],
    [
        &beams_bindings(Access::Write),
        &beams_bindings(Access::ReadWrite),
    ],
    BEAMS_SPEC_IDS,
);
