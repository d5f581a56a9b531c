//! Host mirrors of the structs in `glsl/include/structs.glsl` and of the push constants.
//!
//! Spaces: `_ix` voxel index, `_at` atlas texel, `_ws` world (mm). Lengths in steps unless the name says otherwise.

use super::layout::gpu_struct;
use super::{GpuStruct, StructLayout};

gpu_struct! {
    /// What stays the same while volume, transfer function and levels do.
    pub struct VolumeParams {
        /// Largest index on each axis, n - 1.
        pub field_ix: [f32; 3],
        /// Transfer-function bins per unit of a texture sample.
        pub bin_from_sample: f32,
        /// 1 / extent of the atlas.
        pub atlas_texel: [f32; 3],
        /// Texture sample at which bin 1 starts; bin 0 holds all below.
        pub first_sample: f32,
        /// Blocks on each axis.
        pub blocks: [i32; 3],
        /// Number of bins of the transfer function - 1.
        pub last_bin: f32,
        /// Skip cells on each axis.
        pub skip_extent: [i32; 3],
        /// Number of bins of the transfer function.
        pub bins: f32,
        /// World gradient of index x: columns of the inverse transpose of `world_from_ix`.
        pub gradient_x_ws: [f32; 3],
        /// Place on an axis of the preintegrated table of the last control point.
        pub table_end: f32,
        /// World gradient of index y.
        pub gradient_y_ws: [f32; 3],
        /// Cells of that table per bin, beyond the function's range.
        pub table_tail: f32,
        /// World gradient of index z.
        pub gradient_z_ws: [f32; 3],
        /// Texture samples per index unit that a texel of the volume of gradients counts.
        pub gradient_unit: f32,
        /// Rows of an index of the label map from one of the volume.
        pub label_ix_from_ix_x: [f32; 4],
        /// See `label_ix_from_ix_x`.
        pub label_ix_from_ix_y: [f32; 4],
        /// See `label_ix_from_ix_x`.
        pub label_ix_from_ix_z: [f32; 4],
        /// Pages in a row, and in a layer of rows: of packed corners, of gradients.
        pub pages: [u32; 4],
    }
}

gpu_struct! {
    /// What changes with the camera. A ray through pixel `(px, py)` starts at `origin + px origin_dx + py origin_dy` and
    /// goes along `direction + px direction_dx + py direction_dy`, whose length in world space is that of the `_ws`
    /// triple.
    pub struct FrameParams {
        /// Ray origin at pixel (0,0).
        pub origin_ix: [f32; 3],
        /// Step / unit distance of the transfer function.
        pub unit_exponent: f32,
        /// Change of the origin a pixel to the right.
        pub origin_dx_ix: [f32; 3],
        /// Opacity at which a ray stops; above 1: never.
        pub early_termination: f32,
        /// Change of the origin a pixel down.
        pub origin_dy_ix: [f32; 3],
        /// Opacity at which depth is taken.
        pub depth_threshold: f32,
        /// Index units per step, before normalization.
        pub direction_ix: [f32; 3],
        /// Length of a step, mm.
        pub step_mm: f32,
        /// Change of the direction a pixel to the right.
        pub direction_dx_ix: [f32; 3],
        /// Added to the light volume.
        pub light_bias: f32,
        /// Change of the direction a pixel down.
        pub direction_dy_ix: [f32; 3],
        /// Share of light without orientation.
        pub ambient: f32,
        /// World direction at pixel (0,0), before normalization.
        pub direction_ws: [f32; 3],
        /// Share of light by Lambert's law.
        pub diffuse: f32,
        /// Change of the world direction a pixel to the right.
        pub direction_dx_ws: [f32; 3],
        /// Depth value that means "nothing there".
        pub scene_depth_far: f32,
        /// Change of the world direction a pixel down.
        pub direction_dy_ws: [f32; 3],
        /// Seed of the jitter.
        pub jitter_seed: u32,
        /// Linear; alpha 1: composited under the volume, alpha 0 (and black): left out.
        pub background: [f32; 4],
        /// Unit, towards the light; w = 0: headlight.
        pub light_direction_ws: [f32; 4],
        /// Rows of index from clip space, for the host's depth image.
        pub ix_from_clip_x: [f32; 4],
        /// See `ix_from_clip_x`.
        pub ix_from_clip_y: [f32; 4],
        /// See `ix_from_clip_x`.
        pub ix_from_clip_z: [f32; 4],
        /// See `ix_from_clip_x`.
        pub ix_from_clip_w: [f32; 4],
        /// Width and height of the target.
        pub size_px: [u32; 2],
        /// Number of the picture, for the jitter.
        pub frame: u32,
        /// Values in the file's units from texture samples: factor.
        pub value_from_sample: f32,
        /// And summand.
        pub value_offset: f32,
        /// Factor on the radiance that leaves the volume.
        pub exposure: f32,
        /// A bit of a beam stands for `1 << beam_shift` segments.
        pub beam_shift: u32,
        /// Words of such bits for a beam; 0: there are no beams.
        pub beam_words: u32,
    }
}

gpu_struct! {
    /// Isosurfaces, by value ascending.
    pub struct SurfaceParams {
        /// Texture samples, four a vector.
        pub values: [[f32; 4]; 2],
        /// Linear, not premultiplied; opacity.
        pub colors: [[f32; 4]; 8],
        /// Surfaces.
        pub count: u32,
        /// Bisections of a segment that a surface crosses.
        pub bisections: u32,
        /// Unused.
        pub pad0: f32,
        /// Unused.
        pub pad1: f32,
    }
}

gpu_struct! {
    /// Tile of one dispatch of the march.
    pub struct MarchPush {
        /// First pixel.
        pub tile_px: [u32; 2],
        /// One past the last pixel.
        pub tile_end_px: [u32; 2],
        /// Number of the tile.
        pub beam_tile: u32,
        /// Beams of the tiles before.
        pub first_beam: u32,
        /// Where lists of its beams begin.
        pub first_listed: u32,
        /// Room of each.
        pub listed_by_run: u32,
    }
}

gpu_struct! {
    /// One direction of the light pass.
    pub struct LightPush {
        /// Index units per mm.
        pub direction_ix: [f32; 3],
        /// Where rays start.
        pub offset_mm: f32,
        /// Where rays end.
        pub radius_mm: f32,
        /// Samples of a ray at the finest level.
        pub parts: f32,
        /// Gamma / unit distance.
        pub exponent_mm: f32,
        /// Weight of the direction.
        pub weight: f32,
        /// Rays already in the mean.
        pub ray: u32,
        /// First entry of the work list.
        pub first: u32,
        /// Entries of this dispatch.
        pub count: u32,
        /// By how many parts each distance between samples is longer than the one before; 0: not at all.
        pub growth: f32,
    }
}

gpu_struct! {
    /// Part of the seam work list.
    pub struct PartPush {
        /// First entry.
        pub first: u32,
        /// Entries of this dispatch.
        pub count: u32,
    }
}

gpu_struct! {
    /// Pages of packed corners, one workgroup for a half of each.
    pub struct PackPush {
        /// First page of this dispatch.
        pub first: u32,
        /// Alignment.
        pub unused: u32,
        /// Pages in a row, and in a layer of rows.
        pub pages: [u32; 2],
    }
}

gpu_struct! {
    /// Where a brick lies: the reverse index, atlas to volume.
    pub struct BrickRecord {
        /// First texel of the brick in the atlas.
        pub origin_at: [u32; 3],
        /// Level of the brick.
        pub level: u32,
        /// The block it holds.
        pub block_bx: [i32; 3],
        /// Unused.
        pub pad0: u32,
    }
}

gpu_struct! {
    /// The bare march of the bench.
    pub struct BarePush {
        /// First pixel.
        pub tile_px: [u32; 2],
        /// One past the last pixel.
        pub tile_end_px: [u32; 2],
        /// 1 / extent of the texture.
        pub extent_texel: [f32; 3],
        /// Unused.
        pub pad0: f32,
    }
}

gpu_struct! {
    /// Optical models beyond emission and absorption: what the medium is and what lights it. Radiance and its like are linear.
    pub struct MediumParams {
        /// Factors on the transfer function's extinction, by channel.
        pub extinction: [f32; 3],
        /// Length of a whole sample of the transfer-function table.
        pub sample_mm: f32,
        /// Factors on the transfer function's colour.
        pub albedo: [f32; 3],
        /// Length of a whole sample in unit distances.
        pub unit_exponent: f32,
        /// Parameters of the phase function.
        pub phase: [f32; 4],
        /// Strength per unit of a texture sample (signed), weight of highlights, exponent, roughness.
        pub surface: [f32; 4],
        /// Largest extinction per mm, least majorant per mm, scatterings of a path at most.
        pub tracking: [f32; 4],
        /// Radiance, or factor on the map; w > 0: drawn behind the volume.
        pub environment: [f32; 4],
        /// The map's axes in world space.
        pub environment_x: [f32; 4],
        /// See `environment_x`.
        pub environment_y: [f32; 4],
        /// Towards the map's upper edge.
        pub environment_z: [f32; 4],
        /// Rows of world from index.
        pub ws_from_ix_x: [f32; 4],
        /// See `ws_from_ix_x`.
        pub ws_from_ix_y: [f32; 4],
        /// See `ws_from_ix_x`.
        pub ws_from_ix_z: [f32; 4],
        /// Rows of index units per mm of world directions.
        pub ix_from_ws_x: [f32; 4],
        /// See `ix_from_ws_x`.
        pub ix_from_ws_y: [f32; 4],
        /// See `ix_from_ws_x`.
        pub ix_from_ws_z: [f32; 4],
        /// Points of the swept light volume.
        pub shadow_points: [i32; 3],
        /// Unit distance of the transfer function.
        pub unit_mm: f32,
        /// Points of the volume of scattered light.
        pub scatter_points: [i32; 3],
        /// Lights in use.
        pub light_count: u32,
        /// Unit vector towards the light, w = 0; or its position, mm, w = 1.
        pub light_place: [[f32; 4]; 8],
        /// Irradiance, or intensity; w: cutoff angle (radians), 0 for none.
        pub light_color: [[f32; 4]; 8],
        /// Along a spot's beam; w: angle up to which it is whole (radians).
        pub light_axis: [[f32; 4]; 8],
    }
}

gpu_struct! {
    /// Part of a sweep of flux.
    pub struct SweepPush {
        /// Index of the light.
        pub light: u32,
        /// Axis across the layers.
        pub axis: u32,
        /// Layer of points to compute.
        pub layer: i32,
        /// Layer nearer to the light; the same: the first one.
        pub previous: i32,
    }
}

gpu_struct! {
    /// Scattered light on its grid: one step of a solver.
    pub struct ScatterPush {
        /// Position of the eye, mm, w = 1; or the direction towards it, w = 0.
        pub eye: [f32; 4],
        /// Iteration, or layer of a sweep.
        pub step: u32,
        /// Directions of the discrete ordinates.
        pub bins: u32,
        /// Tiles of bins side by side in their images; of diffusion the colour; of a gathering the tile.
        pub columns: u32,
        /// What the step leaves out (`scatter_grid.glsl`).
        pub flags: u32,
        /// Factor on a step of relaxation.
        pub over_relaxation: f32,
        /// Of the phase function.
        pub mean_cosine: f32,
        /// Unused.
        pub pad0: f32,
        /// Unused.
        pub pad1: f32,
    }
}

/// Every mirror. A GLSL struct that the host fills or reads and that is missing here fails `tests/shaders.rs`.
pub const ALL: &[StructLayout] = &[
    VolumeParams::LAYOUT,
    FrameParams::LAYOUT,
    SurfaceParams::LAYOUT,
    MarchPush::LAYOUT,
    LightPush::LAYOUT,
    PartPush::LAYOUT,
    PackPush::LAYOUT,
    BrickRecord::LAYOUT,
    BarePush::LAYOUT,
    MediumParams::LAYOUT,
    SweepPush::LAYOUT,
    ScatterPush::LAYOUT,
];
