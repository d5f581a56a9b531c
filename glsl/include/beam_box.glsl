// A box around the rays of a beam that moves along with them, and whether cells that it meets show anything. Includes frame.glsl,
// skip.glsl and beams.glsl first.

// Boxes around a beam's rays are larger by this, in voxels, so that no ray that rounds otherwise leaves them.
const float MARGIN_BEAM_IX = 0.01;

// A box around all rays of a beam that moves along with them: between its hindmost and its foremost corner, seen along the beam.
// Every ray is straight, so bounds between two places are bounds of what lies between.
struct Beam {
    vec3 rear_ix;         // hindmost corner at step 0
    vec3 rear_step_ix;    // its way in a step
    vec3 front_ix;
    vec3 front_step_ix;
    Heading heading;      // of the foremost corner
    uvec3 octants;        // nibbles of a word of leaps of the octants that go ahead along each axis
    uint segments;        // of the longest ray
    uint shortest;        // segments of the shortest that hits the field
};

Beam beam_through(uvec2 first_px) {
    // Rays are looked at where they enter the field, and this many steps on.
    uint most = (32u * frame.beam_words) << frame.beam_shift;
    float steps = float(most);
    vec3 low = vec3(FAR_STEPS);
    vec3 high = vec3(-FAR_STEPS);
    vec3 low_on = low;
    vec3 high_on = high;
    float shift = 0.0;
    if (JITTER) {
        shift = 1.0;
    }
    uint segments = 0u;
    uint shortest = ~0u;
    for (uint k = 0u; k < BEAM_PIXELS; ++k) {
        uvec2 px = first_px + pixel_of_beam(k);
        Ray ray = ray_through(vec2(px) + 0.5, frame, volume.field_ix);
        uint count = segment_count(ray, shift);
        vec3 on = ray.origin_ix + steps * ray.step_ix;
        bool hits = count > 0u;
        low = hits ? min(low, ray.origin_ix) : low;
        high = hits ? max(high, ray.origin_ix) : high;
        low_on = hits ? min(low_on, on) : low_on;
        high_on = hits ? max(high_on, on) : high_on;
        segments = max(segments, count);
        shortest = hits ? min(shortest, count) : shortest;
    }
    vec3 low_step = (low_on - low) / steps;
    vec3 high_step = (high_on - high) / steps;
    Beam beam;
    bvec3 descends = lessThan(low_step + high_step, vec3(0.0));
    vec3 ahead = mix(vec3(1.0), vec3(-1.0), descends);
    beam.rear_ix = mix(low, high, descends) - MARGIN_BEAM_IX * ahead;
    beam.rear_step_ix = mix(low_step, high_step, descends);
    beam.front_ix = mix(high, low, descends) + MARGIN_BEAM_IX * ahead;
    beam.front_step_ix = mix(high_step, low_step, descends);
    // Rays may part so far that the hindmost corner goes backwards on an axis: it is where it ends then, all the time.
    bvec3 backwards = lessThan(beam.rear_step_ix * ahead, vec3(0.0));
    beam.rear_ix = mix(beam.rear_ix, beam.rear_ix + steps * beam.rear_step_ix, backwards);
    beam.rear_step_ix = mix(beam.rear_step_ix, vec3(0.0), backwards);
    beam.heading = heading_along(beam.front_step_ix, descends);
    beam.octants = mix(
        uvec3(0x0f0f0f0fu, 0x00ff00ffu, 0x0000ffffu), uvec3(0xf0f0f0f0u, 0xff00ff00u, 0xffff0000u), descends
    );
    beam.segments = min(segments, most);
    beam.shortest = shortest;
    return beam;
}

// Whether nothing shows in a box of cells, by the leaps of the cell at one of its corners: a leap of as many cells as the box has
// along its longest edge, in an octant that goes its way. Along an axis on which it is one cell thick both ways serve.
bool is_empty_box(uint word, uvec3 octants, uvec3 span) {
    uint cells = 1u + max(span.x, max(span.y, span.z));
    uint far_enough = ((word & 0x77777777u) + (8u - min(cells, 8u)) * 0x11111111u | word) & 0x88888888u;
    far_enough &= span.x > 0u ? octants.x : ~0u;
    far_enough &= span.y > 0u ? octants.y : ~0u;
    far_enough &= span.z > 0u ? octants.z : ~0u;
    return cells <= 8u && word > WHOLE_BLOCK && far_enough != 0u;
}
