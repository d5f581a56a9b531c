// The bricked volume: index (block -> place in the atlas, level) and geometry of bricks.

#include "params.glsl"
#include "loads.glsl"

layout(set = 0, binding = BINDING_INDEX) uniform usampler3D t_index;
layout(set = 0, binding = BINDING_INDEX_LOADS, rgba16ui) uniform readonly uimage3D i_index;

const int BLOCK_CELLS = 16;    // voxel cells on an axis of a block
const int SKIP_CELLS = 4;      // voxel cells on an axis of a skip cell
const int FINEST_LEVEL = 4;

// Every block is resident at the finest level, and bricks lie as their blocks do: the atlas is the volume itself.
layout(constant_id = SPEC_UNIFORM_GRID) const bool UNIFORM_GRID = false;

// A resident brick. It covers the closed block and stores `intervals + 1` samples on each axis.
struct Brick {
    bool resident;
    int level;
    vec3 base_ix;        // first voxel of the block
    vec3 cells;          // voxel cells the block covers on each axis
    vec3 scale;          // sample intervals per voxel cell
    vec3 intervals;      // sample intervals on each axis
    vec3 origin_at;      // first texel
};

ivec3 block_of(vec3 p_ix) {
    return min(ivec3(p_ix) / BLOCK_CELLS, volume.blocks - 1);
}

// Where a block's brick begins, in texels, and its level + 1; 0 for none.
uvec4 index_entry(ivec3 block_bx) {
    return LOADS ? imageLoad(i_index, block_bx) : texelFetch(t_index, block_bx, 0);
}

Brick brick_fetch(ivec3 block_bx) {
    Brick b;
    if (UNIFORM_GRID) {
        b.resident = true;
        b.level = FINEST_LEVEL;
        b.base_ix = vec3(block_bx * BLOCK_CELLS);
        b.cells = min(vec3(BLOCK_CELLS), volume.field_ix - b.base_ix);
        b.intervals = b.cells;
        b.scale = vec3(1.0);
        b.origin_at = b.base_ix;
        return b;
    }
    uvec4 entry = index_entry(block_bx);
    b.resident = entry.w != 0u;
    b.level = int(entry.w) - 1;
    b.base_ix = vec3(block_bx * BLOCK_CELLS);
    b.cells = min(vec3(BLOCK_CELLS), volume.field_ix - b.base_ix);
    bool finest = b.level == FINEST_LEVEL;
    b.intervals = finest ? b.cells : vec3(float(1 << max(b.level, 0)));
    b.scale = finest ? vec3(1.0) : b.intervals / b.cells;
    b.origin_at = vec3(entry.xyz);
    return b;
}

// The brick in which a position is reconstructed: where the atlas is the volume, the volume.
Brick brick_at(vec3 p_ix) {
    if (UNIFORM_GRID) {
        return Brick(true, FINEST_LEVEL, vec3(0.0), volume.field_ix, vec3(1.0), volume.field_ix, vec3(0.0));
    }
    return brick_fetch(block_of(p_ix));
}

// The brick at another position; `fallback` where nothing is resident.
Brick brick_near(vec3 p_ix, Brick fallback) {
    Brick b = brick_at(p_ix);
    return b.resident ? b : fallback;
}
