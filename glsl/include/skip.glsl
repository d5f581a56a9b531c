// Empty-space skipping: for each skip cell and octant of directions, how many cells a ray may leap (src/volume/leaps.rs).

layout(constant_id = SPEC_SKIPPING) const bool SKIPPING = true;

#include "loads.glsl"

layout(set = 0, binding = BINDING_SKIP) uniform usampler3D t_skip;
layout(set = 0, binding = BINDING_SKIP_LOADS, r32ui) uniform readonly uimage3D i_skip;

// A sample this close to a border (in steps, or in voxels on any axis) counts as beyond it and is looked up by itself,
// so that rounding never takes a sample for one of the wrong side.
const float MARGIN_STEPS = 0.02;
const float MARGIN_IX = 1e-3;

// What a cell holds that shows something, as all of its block does; 0: not all of the block.
const uint WHOLE_BLOCK = 1u;

const float FAR_STEPS = 3.0e38;

ivec3 skip_cell_of(vec3 p_ix) {
    return min(ivec3(p_ix) / SKIP_CELLS, volume.skip_extent - 1);
}

uint skip_word(ivec3 cell) {
    return LOADS ? imageLoad(i_skip, cell).r : texelFetch(t_skip, cell, 0).r;
}

// What skipping needs to know of a ray's direction; the same all along the ray.
struct Heading {
    vec3 steps_per_ix;
    bvec3 still;       // axes along which nothing moves
    vec3 ahead;        // 1 for axes along which the ray ascends, else 0
    uint shift;        // of its octant's bits
};

// `d_ix`: index units per step. `descends`: axes along which `ahead` is down.
Heading heading_along(vec3 d_ix, bvec3 descends) {
    Heading h;
    h.steps_per_ix = 1.0 / d_ix;
    h.still = equal(d_ix, vec3(0.0));
    h.ahead = mix(vec3(1.0), vec3(0.0), descends);
    uvec3 bits = uvec3(descends);
    h.shift = 4u * (bits.x + 2u * bits.y + 4u * bits.z);
    return h;
}

Heading heading_of(vec3 d_ix) {
    return heading_along(d_ix, lessThan(d_ix, vec3(0.0)));
}

// Steps from `p_ix` to just before the planes `border_ix`, one on each axis, whichever comes first.
float steps_to_border(vec3 p_ix, Heading h, vec3 border_ix) {
    vec3 before = border_ix - MARGIN_IX * (2.0 * h.ahead - 1.0);
    vec3 steps = mix((before - p_ix) * h.steps_per_ix, vec3(FAR_STEPS), h.still);
    return min(steps.x, min(steps.y, steps.z));
}

// The planes by which a ray leaves so many cells of an edge of `size_ix`, that of `cell` included.
vec3 border_of(ivec3 cell, float count, float size_ix, Heading h) {
    return (vec3(cell) + mix(vec3(1.0 - count), vec3(count), h.ahead)) * size_ix;
}

// Samples, this one included, that surely lie before `steps` from here; at least 1.
uint samples_before(float steps) {
    return uint(clamp(ceil(steps - MARGIN_STEPS), 1.0, 1.0e9));
}

// Cells that a ray may leap, that of `p_ix` included; 0: something shows there.
uint leap_from(uint word, uint shift) {
    uint code = (word >> shift) & 15u;
    uint leap = code < 4u ? code : (4u + (code & 3u)) << (code / 4u - 1u);
    return word <= WHOLE_BLOCK ? 0u : leap;
}

uint leap_at(vec3 p_ix, uint shift) {
    uint leap = 0u;
    if (SKIPPING) {
        leap = leap_from(skip_word(skip_cell_of(p_ix)), shift);
    }
    return leap;
}

// What a ray meets at a point, and the planes up to which it goes on like that.
struct Region {
    bool empty;
    bool whole_block;  // every cell of it shows something
    vec3 border_ix;
};

// Samples of a run that starts where something shows, where the atlas is the volume and no border of a block ends it; and in a block
// of which every cell shows something. The same for all rays, so that neighbours stay in step: CPU drivers run eight rays as long as
// the longest of them. What a run samples beyond cells that show something is transparent.
const uint RUN = 8u;
const uint RUN_IN_WHOLE_BLOCK = 32u;

// Samples that a run from `p_ix` takes, or leaps over.
uint run_length(Region r, vec3 p_ix, Heading h) {
    uint inside = samples_before(steps_to_border(p_ix, h, r.border_ix));
    if (UNIFORM_GRID) {
        uint run = r.whole_block ? RUN_IN_WHOLE_BLOCK : RUN;
        inside = r.empty ? inside : run;
    }
    return inside;
}

Region region_at(vec3 p_ix, ivec3 block_bx, Heading h) {
    Region r;
    r.empty = false;
    r.whole_block = true;
    r.border_ix = border_of(block_bx, 1.0, float(BLOCK_CELLS), h);
    if (SKIPPING) {
        ivec3 cell = skip_cell_of(p_ix);
        uint word = skip_word(cell);
        if (word != WHOLE_BLOCK) {
            uint leap = leap_from(word, h.shift);
            r.empty = leap > 0u;
            r.whole_block = false;
            r.border_ix = border_of(cell, float(max(leap, 1u)), float(SKIP_CELLS), h);
        }
    }
    return r;
}
