//! SPIR-V modules and the ids of their interface.
//!
//! Written by `cargo xtask shaders` from `glsl/`. Do not edit.

use super::{Module, include_spirv};

/// `spirv/bare.spv`.
pub static BARE: Module = Module {
    name: "bare",
    words: include_spirv!("bare.spv"),
};

/// `spirv/bare_light.spv`.
pub static BARE_LIGHT: Module = Module {
    name: "bare_light",
    words: include_spirv!("bare_light.spv"),
};

/// `spirv/beams.spv`.
pub static BEAMS: Module = Module {
    name: "beams",
    words: include_spirv!("beams.spv"),
};

/// `spirv/beams_blend_rgba16f.spv`.
pub static BEAMS_BLEND_RGBA16F: Module = Module {
    name: "beams_blend_rgba16f",
    words: include_spirv!("beams_blend_rgba16f.spv"),
};

/// `spirv/beams_blend_rgba32f.spv`.
pub static BEAMS_BLEND_RGBA32F: Module = Module {
    name: "beams_blend_rgba32f",
    words: include_spirv!("beams_blend_rgba32f.spv"),
};

/// `spirv/beams_blend_rgba8.spv`.
pub static BEAMS_BLEND_RGBA8: Module = Module {
    name: "beams_blend_rgba8",
    words: include_spirv!("beams_blend_rgba8.spv"),
};

/// `spirv/diffuse_gather.spv`.
pub static DIFFUSE_GATHER: Module = Module {
    name: "diffuse_gather",
    words: include_spirv!("diffuse_gather.spv"),
};

/// `spirv/diffusion_relax.spv`.
pub static DIFFUSION_RELAX: Module = Module {
    name: "diffusion_relax",
    words: include_spirv!("diffusion_relax.spv"),
};

/// `spirv/diffusion_source.spv`.
pub static DIFFUSION_SOURCE: Module = Module {
    name: "diffusion_source",
    words: include_spirv!("diffusion_source.spv"),
};

/// `spirv/extremum.spv`.
pub static EXTREMUM: Module = Module {
    name: "extremum",
    words: include_spirv!("extremum.spv"),
};

/// `spirv/extremum_blend_rgba16f.spv`.
pub static EXTREMUM_BLEND_RGBA16F: Module = Module {
    name: "extremum_blend_rgba16f",
    words: include_spirv!("extremum_blend_rgba16f.spv"),
};

/// `spirv/extremum_blend_rgba32f.spv`.
pub static EXTREMUM_BLEND_RGBA32F: Module = Module {
    name: "extremum_blend_rgba32f",
    words: include_spirv!("extremum_blend_rgba32f.spv"),
};

/// `spirv/extremum_blend_rgba8.spv`.
pub static EXTREMUM_BLEND_RGBA8: Module = Module {
    name: "extremum_blend_rgba8",
    words: include_spirv!("extremum_blend_rgba8.spv"),
};

/// `spirv/gradients.spv`.
pub static GRADIENTS: Module = Module {
    name: "gradients",
    words: include_spirv!("gradients.spv"),
};

/// `spirv/grid_medium.spv`.
pub static GRID_MEDIUM: Module = Module {
    name: "grid_medium",
    words: include_spirv!("grid_medium.spv"),
};

/// `spirv/isosurface.spv`.
pub static ISOSURFACE: Module = Module {
    name: "isosurface",
    words: include_spirv!("isosurface.spv"),
};

/// `spirv/isosurface_blend_rgba16f.spv`.
pub static ISOSURFACE_BLEND_RGBA16F: Module = Module {
    name: "isosurface_blend_rgba16f",
    words: include_spirv!("isosurface_blend_rgba16f.spv"),
};

/// `spirv/isosurface_blend_rgba32f.spv`.
pub static ISOSURFACE_BLEND_RGBA32F: Module = Module {
    name: "isosurface_blend_rgba32f",
    words: include_spirv!("isosurface_blend_rgba32f.spv"),
};

/// `spirv/isosurface_blend_rgba8.spv`.
pub static ISOSURFACE_BLEND_RGBA8: Module = Module {
    name: "isosurface_blend_rgba8",
    words: include_spirv!("isosurface_blend_rgba8.spv"),
};

/// `spirv/light_seam.spv`.
pub static LIGHT_SEAM: Module = Module {
    name: "light_seam",
    words: include_spirv!("light_seam.spv"),
};

/// `spirv/light_trace.spv`.
pub static LIGHT_TRACE: Module = Module {
    name: "light_trace",
    words: include_spirv!("light_trace.spv"),
};

/// `spirv/march.spv`.
pub static MARCH: Module = Module {
    name: "march",
    words: include_spirv!("march.spv"),
};

/// `spirv/march_blend_rgba16f.spv`.
pub static MARCH_BLEND_RGBA16F: Module = Module {
    name: "march_blend_rgba16f",
    words: include_spirv!("march_blend_rgba16f.spv"),
};

/// `spirv/march_blend_rgba32f.spv`.
pub static MARCH_BLEND_RGBA32F: Module = Module {
    name: "march_blend_rgba32f",
    words: include_spirv!("march_blend_rgba32f.spv"),
};

/// `spirv/march_blend_rgba8.spv`.
pub static MARCH_BLEND_RGBA8: Module = Module {
    name: "march_blend_rgba8",
    words: include_spirv!("march_blend_rgba8.spv"),
};

/// `spirv/march_ends.spv`.
pub static MARCH_ENDS: Module = Module {
    name: "march_ends",
    words: include_spirv!("march_ends.spv"),
};

/// `spirv/march_ends_blend_rgba16f.spv`.
pub static MARCH_ENDS_BLEND_RGBA16F: Module = Module {
    name: "march_ends_blend_rgba16f",
    words: include_spirv!("march_ends_blend_rgba16f.spv"),
};

/// `spirv/march_ends_blend_rgba32f.spv`.
pub static MARCH_ENDS_BLEND_RGBA32F: Module = Module {
    name: "march_ends_blend_rgba32f",
    words: include_spirv!("march_ends_blend_rgba32f.spv"),
};

/// `spirv/march_ends_blend_rgba8.spv`.
pub static MARCH_ENDS_BLEND_RGBA8: Module = Module {
    name: "march_ends_blend_rgba8",
    words: include_spirv!("march_ends_blend_rgba8.spv"),
};

/// `spirv/march_ends_votes.spv`.
pub static MARCH_ENDS_VOTES: Module = Module {
    name: "march_ends_votes",
    words: include_spirv!("march_ends_votes.spv"),
};

/// `spirv/march_votes.spv`.
pub static MARCH_VOTES: Module = Module {
    name: "march_votes",
    words: include_spirv!("march_votes.spv"),
};

/// `spirv/ordinates_gather.spv`.
pub static ORDINATES_GATHER: Module = Module {
    name: "ordinates_gather",
    words: include_spirv!("ordinates_gather.spv"),
};

/// `spirv/ordinates_source.spv`.
pub static ORDINATES_SOURCE: Module = Module {
    name: "ordinates_source",
    words: include_spirv!("ordinates_source.spv"),
};

/// `spirv/ordinates_sweep.spv`.
pub static ORDINATES_SWEEP: Module = Module {
    name: "ordinates_sweep",
    words: include_spirv!("ordinates_sweep.spv"),
};

/// `spirv/pack_cells.spv`.
pub static PACK_CELLS: Module = Module {
    name: "pack_cells",
    words: include_spirv!("pack_cells.spv"),
};

/// `spirv/pathtrace.spv`.
pub static PATHTRACE: Module = Module {
    name: "pathtrace",
    words: include_spirv!("pathtrace.spv"),
};

/// `spirv/pathtrace_blend_rgba16f.spv`.
pub static PATHTRACE_BLEND_RGBA16F: Module = Module {
    name: "pathtrace_blend_rgba16f",
    words: include_spirv!("pathtrace_blend_rgba16f.spv"),
};

/// `spirv/pathtrace_blend_rgba32f.spv`.
pub static PATHTRACE_BLEND_RGBA32F: Module = Module {
    name: "pathtrace_blend_rgba32f",
    words: include_spirv!("pathtrace_blend_rgba32f.spv"),
};

/// `spirv/pathtrace_blend_rgba8.spv`.
pub static PATHTRACE_BLEND_RGBA8: Module = Module {
    name: "pathtrace_blend_rgba8",
    words: include_spirv!("pathtrace_blend_rgba8.spv"),
};

/// `spirv/preintegrate.spv`.
pub static PREINTEGRATE: Module = Module {
    name: "preintegrate",
    words: include_spirv!("preintegrate.spv"),
};

/// `spirv/shadow_sweep.spv`.
pub static SHADOW_SWEEP: Module = Module {
    name: "shadow_sweep",
    words: include_spirv!("shadow_sweep.spv"),
};

/// `spirv/transport.spv`.
pub static TRANSPORT: Module = Module {
    name: "transport",
    words: include_spirv!("transport.spv"),
};

/// `spirv/transport_blend_rgba16f.spv`.
pub static TRANSPORT_BLEND_RGBA16F: Module = Module {
    name: "transport_blend_rgba16f",
    words: include_spirv!("transport_blend_rgba16f.spv"),
};

/// `spirv/transport_blend_rgba32f.spv`.
pub static TRANSPORT_BLEND_RGBA32F: Module = Module {
    name: "transport_blend_rgba32f",
    words: include_spirv!("transport_blend_rgba32f.spv"),
};

/// `spirv/transport_blend_rgba8.spv`.
pub static TRANSPORT_BLEND_RGBA8: Module = Module {
    name: "transport_blend_rgba8",
    words: include_spirv!("transport_blend_rgba8.spv"),
};

/// `spirv/zonal.spv`.
pub static ZONAL: Module = Module {
    name: "zonal",
    words: include_spirv!("zonal.spv"),
};

/// Every module, by name.
#[rustfmt::skip]
pub static MODULES: &[&Module] = &[
    &BARE,
    &BARE_LIGHT,
    &BEAMS,
    &BEAMS_BLEND_RGBA16F,
    &BEAMS_BLEND_RGBA32F,
    &BEAMS_BLEND_RGBA8,
    &DIFFUSE_GATHER,
    &DIFFUSION_RELAX,
    &DIFFUSION_SOURCE,
    &EXTREMUM,
    &EXTREMUM_BLEND_RGBA16F,
    &EXTREMUM_BLEND_RGBA32F,
    &EXTREMUM_BLEND_RGBA8,
    &GRADIENTS,
    &GRID_MEDIUM,
    &ISOSURFACE,
    &ISOSURFACE_BLEND_RGBA16F,
    &ISOSURFACE_BLEND_RGBA32F,
    &ISOSURFACE_BLEND_RGBA8,
    &LIGHT_SEAM,
    &LIGHT_TRACE,
    &MARCH,
    &MARCH_BLEND_RGBA16F,
    &MARCH_BLEND_RGBA32F,
    &MARCH_BLEND_RGBA8,
    &MARCH_ENDS,
    &MARCH_ENDS_BLEND_RGBA16F,
    &MARCH_ENDS_BLEND_RGBA32F,
    &MARCH_ENDS_BLEND_RGBA8,
    &MARCH_ENDS_VOTES,
    &MARCH_VOTES,
    &ORDINATES_GATHER,
    &ORDINATES_SOURCE,
    &ORDINATES_SWEEP,
    &PACK_CELLS,
    &PATHTRACE,
    &PATHTRACE_BLEND_RGBA16F,
    &PATHTRACE_BLEND_RGBA32F,
    &PATHTRACE_BLEND_RGBA8,
    &PREINTEGRATE,
    &SHADOW_SWEEP,
    &TRANSPORT,
    &TRANSPORT_BLEND_RGBA16F,
    &TRANSPORT_BLEND_RGBA32F,
    &TRANSPORT_BLEND_RGBA8,
    &ZONAL,
];

pub const BINDING_VOLUME: u32 = 0;

pub const BINDING_FRAME: u32 = 1;

pub const BINDING_ATLAS: u32 = 2;

pub const BINDING_INDEX: u32 = 3;

pub const BINDING_SKIP: u32 = 4;

pub const BINDING_TRANSFER: u32 = 5;

pub const BINDING_LIGHT: u32 = 6;

pub const BINDING_SCENE_DEPTH: u32 = 7;

pub const BINDING_TARGET: u32 = 8;

pub const BINDING_AUX: u32 = 9;

pub const BINDING_BRICKS: u32 = 10;

pub const BINDING_WORK: u32 = 11;

pub const BINDING_LIGHT_STORE: u32 = 12;

pub const BINDING_VOXELS: u32 = 13;

pub const BINDING_PREINTEGRATED: u32 = 14;

pub const BINDING_PREINTEGRATED_EMISSION: u32 = 15;

pub const BINDING_INTEGRALS: u32 = 16;

pub const BINDING_PREINTEGRATED_STORE: u32 = 17;

pub const BINDING_PREINTEGRATED_EMISSION_STORE: u32 = 18;

pub const BINDING_RANGE: u32 = 19;

pub const BINDING_SURFACES: u32 = 20;

pub const BINDING_LABELS: u32 = 21;

pub const BINDING_LABEL_TABLE: u32 = 22;

pub const BINDING_MEDIUM: u32 = 23;

pub const BINDING_SHADOW: u32 = 24;

pub const BINDING_SHADOW_STORE: u32 = 25;

pub const BINDING_SCATTERED: u32 = 26;

pub const BINDING_ENVIRONMENT: u32 = 27;

pub const BINDING_PHASE: u32 = 28;

pub const BINDING_THROUGH: u32 = 29;

pub const BINDING_MAJORANT: u32 = 30;

pub const BINDING_PATHS_SUM: u32 = 31;

pub const BINDING_PATHS_SQUARE: u32 = 32;

pub const BINDING_PATHS_THROUGH: u32 = 33;

pub const BINDING_GRID_MEDIUM: u32 = 34;

pub const BINDING_GRID_EMISSION: u32 = 35;

pub const BINDING_GRID_MEDIUM_STORE: u32 = 36;

pub const BINDING_GRID_EMISSION_STORE: u32 = 37;

pub const BINDING_BINS: u32 = 38;

pub const BINDING_PHASE_MATRIX: u32 = 39;

pub const BINDING_INTENSITY_STORE: u32 = 40;

pub const BINDING_SOURCE_STORE: u32 = 41;

pub const BINDING_FLUENCE_STORE: u32 = 42;

pub const BINDING_SCATTERED_STORE: u32 = 43;

pub const BINDING_RESIDUAL: u32 = 44;

pub const BINDING_COLOR: u32 = 45;

pub const BINDING_GRADIENTS: u32 = 46;

pub const BINDING_GRADIENTS_TEN_BITS: u32 = 47;

pub const BINDING_CHUNKS: u32 = 48;

pub const BINDING_PACKED_CELLS: u32 = 49;

pub const BINDING_PACKED_CELLS_STORE: u32 = 50;

pub const BINDING_SKIP_LOADS: u32 = 51;

pub const BINDING_TRANSFER_LOADS: u32 = 52;

pub const BINDING_PREINTEGRATED_LOADS: u32 = 53;

pub const BINDING_PREINTEGRATED_EMISSION_LOADS: u32 = 54;

pub const BINDING_GRADIENTS_HALVES: u32 = 55;

pub const BINDING_BEAM_TILES: u32 = 56;

pub const BINDING_BEAM_LIST: u32 = 57;

pub const BINDING_BEAM_RUNS: u32 = 58;

pub const BINDING_GRADIENTS_STORE: u32 = 59;

pub const BINDING_SHOWN_CELLS: u32 = 60;

pub const BINDING_INTEGRALS_LOADS: u32 = 61;

pub const BINDING_GRADIENTS_IN_FOURS: u32 = 62;

pub const BINDING_INDEX_LOADS: u32 = 63;

pub const SPEC_INTERPOLATION: u32 = 0;

pub const SPEC_BLOCKS_APART: u32 = 1;

pub const SPEC_SKIPPING: u32 = 2;

pub const SPEC_EMISSION: u32 = 3;

pub const SPEC_LIGHT: u32 = 4;

pub const SPEC_DIFFUSE: u32 = 5;

pub const SPEC_JITTER: u32 = 6;

pub const SPEC_AUX: u32 = 7;

pub const SPEC_SCENE_DEPTH: u32 = 8;

pub const SPEC_ENCODE_SRGB: u32 = 9;

pub const SPEC_MANUAL_FILTER: u32 = 10;

pub const SPEC_UNIFORM_GRID: u32 = 11;

pub const SPEC_EXACT_BINS: u32 = 12;

pub const SPEC_CLASSIFICATION: u32 = 13;

pub const SPEC_GRADIENT: u32 = 14;

pub const SPEC_XRAY: u32 = 15;

pub const SPEC_PROJECTION: u32 = 16;

pub const SPEC_LABELS: u32 = 17;

pub const SPEC_MODEL: u32 = 18;

pub const SPEC_PHASE: u32 = 19;

pub const SPEC_GLOWS: u32 = 20;

pub const SPEC_SHADOWS: u32 = 21;

pub const SPEC_REFLECTANCE: u32 = 22;

pub const SPEC_ENVIRONMENT: u32 = 23;

pub const SPEC_CHROMATIC: u32 = 24;

pub const SPEC_SCATTERED: u32 = 25;

pub const SPEC_GLOBAL_MAJORANT: u32 = 26;

pub const SPEC_COUNT: u32 = 27;

pub const SPEC_DATA_COLOR: u32 = 28;

pub const SPEC_STORED_GRADIENTS: u32 = 29;

pub const SPEC_PACKED_CELLS: u32 = 30;

pub const SPEC_GROWTH: u32 = 31;

pub const SPEC_RUNS: u32 = 32;

pub const SPEC_LOADS: u32 = 33;

pub const SPEC_BEAMS: u32 = 34;

pub const SPEC_CLEARED: u32 = 35;

pub const SPEC_SEARCHED: u32 = 36;

pub const SPEC_SHOWN_CELLS: u32 = 37;

pub const SPEC_PAIRED: u32 = 38;
