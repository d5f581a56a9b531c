// Structs that the host mirrors (src/shader/structs.rs), field by field. Nothing else.
// Spaces: _ix voxel index, _at atlas texel, _ws world (mm). Lengths in steps unless the name says otherwise.

// What stays the same while volume, transfer function and levels do.
struct VolumeParams {
    vec3 field_ix;          // largest index on each axis, n - 1
    float bin_from_sample;  // transfer-function bins per unit of a texture sample
    vec3 atlas_texel;       // 1 / extent of the atlas
    float first_sample;     // texture sample at which bin 1 starts; bin 0 holds all below
    ivec3 blocks;           // blocks on each axis
    float last_bin;         // number of bins of the transfer function - 1
    ivec3 skip_extent;      // skip cells on each axis
    float bins;             // number of bins of the transfer function
    vec3 gradient_x_ws;     // world gradient of index x: columns of the inverse transpose of world_from_ix
    float table_end;        // place on an axis of the preintegrated table of the last control point
    vec3 gradient_y_ws;
    float table_tail;       // cells of that table per bin, beyond the function's range
    vec3 gradient_z_ws;
    float gradient_unit;    // texture samples per index unit that a texel of the volume of gradients counts
    vec4 label_ix_from_ix_x;  // rows of an index of the label map from one of the volume
    vec4 label_ix_from_ix_y;
    vec4 label_ix_from_ix_z;
    uvec4 pages;            // pages in a row, and in a layer of rows: of packed corners, of gradients
};

// What changes with the camera. A ray through pixel (px, py) starts at origin + px origin_dx + py origin_dy and goes
// along direction + px direction_dx + py direction_dy, whose length in world space is that of the _ws triple.
struct FrameParams {
    vec3 origin_ix;
    float unit_exponent;      // step / unit distance of the transfer function
    vec3 origin_dx_ix;
    float early_termination;  // opacity at which a ray stops; above 1: never
    vec3 origin_dy_ix;
    float depth_threshold;    // opacity at which depth is taken
    vec3 direction_ix;        // index units per step, before normalization
    float step_mm;
    vec3 direction_dx_ix;
    float light_bias;         // added to the light volume
    vec3 direction_dy_ix;
    float ambient;
    vec3 direction_ws;
    float diffuse;
    vec3 direction_dx_ws;
    float scene_depth_far;    // depth value that means "nothing there"
    vec3 direction_dy_ws;
    uint jitter_seed;
    vec4 background;          // linear, alpha 1: composited under the volume; alpha 0: left out
    vec4 light_direction_ws;  // unit, towards the light; w = 0: headlight
    vec4 ix_from_clip_x;      // rows of index from clip space, for the host's depth image
    vec4 ix_from_clip_y;
    vec4 ix_from_clip_z;
    vec4 ix_from_clip_w;
    uvec2 size_px;
    uint frame;
    float value_from_sample;  // values in the file's units from texture samples: factor
    float value_offset;       // and summand
    float exposure;           // factor on the radiance that leaves the volume
    uint beam_shift;          // a bit of a beam stands for 1 << beam_shift segments
    uint beam_words;          // words of such bits for a beam; 0: there are no beams
};

// Isosurfaces, by value ascending.
struct SurfaceParams {
    vec4 values[2];    // texture samples, four a vector
    vec4 colors[8];    // linear, not premultiplied; opacity
    uint count;
    uint bisections;   // of a segment that a surface crosses
    float pad0;
    float pad1;
};

// Tile of one dispatch of the march.
struct MarchPush {
    uvec2 tile_px;      // first pixel
    uvec2 tile_end_px;  // one past the last pixel
    uint beam_tile;     // number of the tile
    uint first_beam;    // beams of the tiles before
    uint first_listed;  // where lists of its beams begin
    uint listed_by_run; // room of each
};

// One direction of the light pass.
struct LightPush {
    vec3 direction_ix;   // index units per mm
    float offset_mm;
    float radius_mm;
    float parts;         // samples of a ray at the finest level
    float exponent_mm;   // gamma / unit distance
    float weight;
    uint ray;            // rays already in the mean
    uint first;          // first entry of the work list
    uint count;          // entries of this dispatch
    float growth;        // of the distance between samples, in parts; 0: none
};

// Part of a work list.
struct PartPush {
    uint first;
    uint count;
};

// Pages of packed corners.
struct PackPush {
    uint first;
    uint unused;
    uvec2 pages;  // in a row, in a layer of rows
};

// Where a brick lies: the reverse index, atlas to volume.
struct BrickRecord {
    uvec3 origin_at;
    uint level;
    ivec3 block_bx;
    uint pad0;
};

// The bare march of the bench.
struct BarePush {
    uvec2 tile_px;
    uvec2 tile_end_px;
    vec3 extent_texel;
    float pad0;
};

// Optical models beyond emission and absorption: what the medium is and what lights it. Radiance and its like are linear.
struct MediumParams {
    vec3 extinction;        // factors on the transfer function's, by channel
    float sample_mm;        // length of a whole sample of the transfer-function table
    vec3 albedo;            // factors on the transfer function's colour
    float unit_exponent;    // the same length in unit distances
    vec4 phase;             // parameters of the phase function (phase.glsl)
    vec4 surface;           // strength per unit of a texture sample (signed), weight of highlights, exponent, roughness
    vec4 tracking;          // largest extinction per mm, least majorant per mm, scatterings of a path at most
    vec4 environment;       // radiance, or factor on the map; w > 0: drawn behind the volume
    vec4 environment_x;     // rows: the map's axes in world space; z towards its upper edge
    vec4 environment_y;
    vec4 environment_z;
    vec4 ws_from_ix_x;      // rows of world from index
    vec4 ws_from_ix_y;
    vec4 ws_from_ix_z;
    vec4 ix_from_ws_x;      // rows of index units per mm of world directions
    vec4 ix_from_ws_y;
    vec4 ix_from_ws_z;
    ivec3 shadow_points;    // points of the swept light volume
    float unit_mm;          // unit distance of the transfer function
    ivec3 scatter_points;   // points of the volume of scattered light
    uint light_count;
    vec4 light_place[8];    // unit vector towards the light, w = 0; or its position, mm, w = 1
    vec4 light_color[8];    // irradiance, or intensity; w: cutoff angle (radians)
    vec4 light_axis[8];     // along a spot's beam; w: angle up to which it is whole (radians)
};

// Part of a sweep of flux.
struct SweepPush {
    uint light;
    uint axis;       // across the layers
    int layer;
    int previous;    // layer nearer to the light; the same: the first one
};

// Scattered light on its grid: one step of a solver.
struct ScatterPush {
    vec4 eye;            // position of the eye, mm, w = 1; or the direction towards it, w = 0
    uint step;           // iteration, or layer of a sweep
    uint bins;           // directions of the discrete ordinates
    uint columns;        // tiles of bins side by side in their images; of diffusion the colour; of a gathering the tile
    uint flags;          // what the step leaves out (scatter_grid.glsl)
    float over_relaxation;
    float mean_cosine;   // of the phase function
    float pad0;
    float pad1;
};
