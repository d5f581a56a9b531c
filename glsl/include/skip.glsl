// Empty-space skipping: for each skip cell, 0 where the transfer function shows something, else the chessboard distance
// in cells to the nearest such cell.

layout(constant_id = SPEC_SKIPPING) const bool SKIPPING = true;

layout(set = 0, binding = BINDING_SKIP) uniform usampler3D t_skip;

// A sample this close to a border (in steps, or in voxels on any axis) counts as beyond it and is looked up by itself,
// so that rounding never takes a sample for one of the wrong side.
const float MARGIN_STEPS = 0.02;
const float MARGIN_IX = 1e-3;

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

// The box of cells around `cell` that hold nothing, for a cell of distance `distance` >= 1.
void empty_box(ivec3 cell, uint distance, out vec3 low_ix, out vec3 high_ix) {
    low_ix = vec3((cell - int(distance) + 1) * SKIP_CELLS);
    high_ix = vec3((cell + int(distance)) * SKIP_CELLS);
}
