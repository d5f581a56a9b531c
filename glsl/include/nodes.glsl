// Segments by their ends: node i is the start of segment i, and the last node is the end of the ray. Includes ray.glsl and
// skip.glsl first.

vec3 node_position(Ray ray, uint i, uint count, float shift) {
    float steps = i == count ? ray.extent : max(float(i) - shift, 0.0);
    return ray_position(ray, steps, volume.field_ix);
}

// Segments [first, end) that may show something, after leaping over those that do not.
struct EndsRun {
    uint first;
    uint end;
};

// A segment is leapt over when both its ends lie in one empty box: the field is continuous, so whatever lies between the values
// at its ends is found inside the box, and none of it shows. So it is when they lie in two empty boxes that share voxels, as boxes do
// between which a step of less than a cell leads.
EndsRun next_run(Ray ray, uint i, uint count, float shift) {
    vec3 reach = abs(ray.step_ix);
    bool sharing = UNIFORM_GRID && max(reach.x, max(reach.y, reach.z)) < float(SKIP_CELLS);
    Heading heading = heading_of(ray.step_ix);
    bool ahead = false;  // node i comes after an empty box and is not known to lie in one
    uint inside;
    uint leap;
    do {
        vec3 p_ix = node_position(ray, i, count, shift);
        Region region = region_at(p_ix, block_of(p_ix), heading);
        inside = run_length(region, p_ix, heading);
        leap = region.empty ? min(sharing ? inside : inside - 1u, count - i) : 0u;
        ahead = leap > 0u ? sharing && leap == inside : ahead;
        i += leap;
        inside = region.empty ? 1u : inside;
    } while (leap > 0u && i < count);
    return EndsRun(ahead ? i - 1u : i, min(i + inside, count));
}
