// Bits of a beam: which of its segments may show something. Includes beam_box.glsl and shown_cells.glsl first.

// Where along a segment samples may lie: at its middle, or from its start, or that of the one before where rays start anywhere in
// a step, to its end. The middle of a ray's last one, which is shorter, is nearer to its start.
vec2 samples_between() {
    vec2 between = vec2(0.5);
    if (CLASSIFICATION == PREINTEGRATED) {
        between = vec2(0.0, 1.0);
    }
    // The host's geometry may make any segment a ray's last.
    if (SCENE_DEPTH) {
        between.x = 0.0;
    }
    if (JITTER) {
        between = vec2(-1.0, 1.0);
    }
    return between;
}

// Segments that are looked at together, as a power of two: those of a bit, or of four where cells between voxels are looked up as well.
uint together_shift() {
    uint shift = frame.beam_shift;
    if (SHOWN_CELLS) {
        shift += 2u;
    }
    return shift;
}

// Bits of the segments from `i` up to `end`, one for those that are looked at together; `i` goes on to where they are known. `mixed`:
// some lie in blocks of which not every skip cell shows something.
uint bits_of(Beam beam, inout uint i, uint end, inout bool mixed) {
    vec2 between = samples_between();
    float from = between.x;
    float to = between.y;
    uint shift = together_shift();
    uint bits = 0u;
    if (i < end) {
        do {
            uint bit = i >> shift;
            uint next = (bit + 1u) << shift;
            float first = float(i) + (next < beam.shortest ? from : min(from, 0.0));
            vec3 rear_ix = clamp(beam.rear_ix + first * beam.rear_step_ix, vec3(0.0), volume.field_ix);
            ivec3 cell = skip_cell_of(rear_ix);
            uint word = skip_word(cell);
            // The rest of these segments,
            float last = float(next) - 1.0 + to;
            vec3 far_ix = clamp(beam.front_ix + last * beam.front_step_ix, vec3(0.0), volume.field_ix);
            ivec3 far_cell = skip_cell_of(far_ix);
            uvec3 span = uvec3(abs(far_cell - cell));
            bool empty = is_empty_box(word, beam.octants, span) || is_empty_box(skip_word(far_cell), ~beam.octants, span);
            // and how many there are before the beam's front leaves the cube that the leap spans.
            uint leap = leap_from(word, beam.heading.shift);
            vec3 border_ix = border_of(cell, float(leap), float(SKIP_CELLS), beam.heading);
            vec3 front_ix = beam.front_ix + float(i) * beam.front_step_ix;
            float steps = steps_to_border(front_ix, beam.heading, border_ix);
            // On an axis along which it does not move it may be outside all the time.
            vec3 left_ix = (border_ix - front_ix) * (2.0 * beam.heading.ahead - 1.0);
            steps = any(lessThan(left_ix, vec3(MARGIN_IX))) ? 0.0 : steps;
            float inside = floor(clamp(steps + 1.0 - to - MARGIN_STEPS, 0.0, 1.0e9));
            uint leapt = i + (leap > 0u && steps > 0.0 ? uint(inside) : 0u);
            bool shown = !empty && leapt < next;
            // Within a block of which every cell shows something the bits up to its border are known as well.
            vec3 block_border_ix = border_of(block_of(rear_ix), 1.0, float(BLOCK_CELLS), beam.heading);
            uint steps_inside = uint(clamp(steps_to_border(rear_ix, beam.heading, block_border_ix), 0.0, 1.0e9));
            uint more = min(steps_inside >> shift, 31u - (bit & 31u));
            more = word == WHOLE_BLOCK ? more : 0u;
            mixed = mixed || shown && word != WHOLE_BLOCK;
            bits |= shown ? ((2u << more) - 1u) << (bit & 31u) : 0u;
            i = shown ? next + (more << shift) : max(leapt, next);
        } while (i < end);
    }
    return bits;
}

// Each of 32 bits four times.
uvec4 fourfold(uint bits) {
    uvec4 four = uvec4(bits, bits >> 8, bits >> 16, bits >> 24) & 0xffu;
    four = (four | four << 12) & 0x000f000fu;
    four = (four | four << 6) & 0x03030303u;
    four = (four | four << 3) & 0x11111111u;
    return four * 15u;
}

// Of segments that 32 bits stand for, four each, a bit each for those that may show something. `from_segment`: the first of them.
//
// All 128 in one loop: beams that run together wait for the one with the most of them, and of 32 one may have all, another none.
uvec4 refine(Beam beam, ShownGrid grid, uint from_segment, uint bits) {
    vec2 between = samples_between();
    float from = between.x;
    float to = between.y;
    uvec4 kept = uvec4(0u);
    uint rest = bits;
    uint within = 0u;
    if (rest != 0u) {
        do {
            uint place = 4u * lowest_bit(rest) + within;
            uint segment = from_segment + place;
            float first = float(segment) + (segment + 1u < beam.shortest ? from : min(from, 0.0));
            float last = float(segment) + to;
            bool found = may_show(grid, beam.rear_ix + first * beam.rear_step_ix, beam.front_ix + last * beam.front_step_ix);
            uint kept_bit = found ? 1u << (place & 31u) : 0u;
            kept |= mix(uvec4(0u), uvec4(kept_bit), equal(uvec4(place >> 5), uvec4(0u, 1u, 2u, 3u)));
            rest = within == 3u ? rest & (rest - 1u) : rest;
            within = (within + 1u) & 3u;
        } while (rest != 0u);
    }
    return kept;
}
