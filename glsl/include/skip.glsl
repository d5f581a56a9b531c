// Empty-space skipping: for each skip cell, 0 where the transfer function shows something, else the chessboard distance
// in cells to the nearest such cell. WHOLE_BLOCK is a 0 whose whole block is 0.

layout(constant_id = SPEC_SKIPPING) const bool SKIPPING = true;

layout(set = 0, binding = BINDING_SKIP) uniform usampler3D t_skip;

// A sample this close to a border (in steps, or in voxels on any axis) counts as beyond it and is looked up by itself,
// so that rounding never takes a sample for one of the wrong side.
const float MARGIN_STEPS = 0.02;
const float MARGIN_IX = 1e-3;

const uint WHOLE_BLOCK = 255u;

const float FAR_STEPS = 3.0e38;

ivec3 skip_cell_of(vec3 p_ix) {
    return min(ivec3(p_ix) / SKIP_CELLS, volume.skip_extent - 1);
}

// Steps from `p_ix` along `d_ix` (index units per step) to the border of the box [low_ix, high_ix] that contains it, or
// to just before it.
float steps_to_border(vec3 p_ix, vec3 d_ix, vec3 low_ix, vec3 high_ix) {
    vec3 border = mix(low_ix + MARGIN_IX, high_ix - MARGIN_IX, greaterThan(d_ix, vec3(0.0)));
    vec3 steps = mix((border - p_ix) / d_ix, vec3(FAR_STEPS), equal(d_ix, vec3(0.0)));
    return min(steps.x, min(steps.y, steps.z));
}

// Samples, this one included, that surely lie before `steps` from here; at least 1.
uint samples_before(float steps) {
    return uint(clamp(ceil(steps - MARGIN_STEPS), 1.0, 1.0e9));
}

// Chessboard distance to the nearest cell that shows something, in cells; 0: this one does.
uint skip_distance(vec3 p_ix) {
    uint distance = 0u;
    if (SKIPPING) {
        distance = texelFetch(t_skip, skip_cell_of(p_ix), 0).r;
        distance = distance == WHOLE_BLOCK ? 0u : distance;
    }
    return distance;
}

// What a ray meets at a point, and the box in which it goes on like that.
struct Region {
    bool empty;
    vec3 low_ix;
    vec3 high_ix;
};

// Samples of a run that starts where something shows, where the atlas is the volume and no border of a block ends it; and in a block
// of which every cell shows something. The same for all rays, so that neighbours stay in step: CPU drivers run eight rays as long as
// the longest of them. What a run samples beyond cells that show something is transparent.
const uint RUN = 8u;
const uint RUN_IN_WHOLE_BLOCK = 32u;

// Samples that a run from `p_ix` takes, or leaps over; `d_ix`: index units per step.
uint run_length(Region r, vec3 p_ix, vec3 d_ix) {
    uint inside = samples_before(steps_to_border(p_ix, d_ix, r.low_ix, r.high_ix));
    if (UNIFORM_GRID) {
        uint run = r.high_ix.x - r.low_ix.x < float(BLOCK_CELLS) ? RUN : RUN_IN_WHOLE_BLOCK;
        inside = r.empty ? inside : run;
    }
    return inside;
}

Region region_at(vec3 p_ix, ivec3 block_bx) {
    Region r;
    r.empty = false;
    r.low_ix = vec3(block_bx * BLOCK_CELLS);
    r.high_ix = r.low_ix + float(BLOCK_CELLS);
    if (SKIPPING) {
        ivec3 cell = skip_cell_of(p_ix);
        uint distance = texelFetch(t_skip, cell, 0).r;
        if (distance != WHOLE_BLOCK) {
            r.empty = distance > 0u;
            int reach = max(int(distance), 1);
            r.low_ix = vec3((cell - reach + 1) * SKIP_CELLS);
            r.high_ix = vec3((cell + reach) * SKIP_CELLS);
        }
    }
    return r;
}
