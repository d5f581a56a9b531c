// Optical depth along a straight line through the field, by samples a march's step apart. Includes medium.glsl and skip.glsl first.

// Samples of one round of the loop: CPU drivers bound the rounds of all loops of an invocation.
const uint SHADOW_ROUND = 16u;

// From a point of the field along `d_ix` (index units per mm), over `length_mm` at most; before the channels' factors.
float optical_depth_along(vec3 p_ix, vec3 d_ix, float length_mm) {
    float reach = min(distance_to_exit(p_ix, d_ix), length_mm);
    uint count = uint(ceil(reach / medium.sample_mm - 1e-4));
    float part_mm = reach / float(max(count, 1u));
    vec3 step_ix = d_ix * part_mm;
    Heading heading = heading_of(step_ix);
    float sum = 0.0;
    uint i = 0u;
    while (i < count) {
        vec3 at = clamp(p_ix + (float(i) + 0.5) * step_ix, vec3(0.0), volume.field_ix);
        Region region = region_at(at, block_of(at), heading);
        uint ahead = max(samples_before(steps_to_border(at, heading, region.border_ix)), 1u);
        if (region.empty) {
            i += ahead;
        } else {
            // Samples beyond the region, or in an empty one, are right too: skipping only saves looking at them.
            [[unroll]] for (uint k = 0u; k < SHADOW_ROUND; ++k) {
                vec3 next = clamp(p_ix + (float(i + k) + 0.5) * step_ix, vec3(0.0), volume.field_ix);
                sum += i + k < count ? extinction_at(next) : 0.0;
            }
            i += SHADOW_ROUND;
        }
    }
    return sum * part_mm;
}
