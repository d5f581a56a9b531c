// The march over samples at the middles of segments. march.comp includes it after add_segment().

// Samples a segment at its middle. `shorter`: it may be shorter than a whole step.
Classified classify_middle(Ray ray, Brick b, Segment segment, bool shorter) {
    vec3 p_ix = ray_position(ray, segment.middle, volume.field_ix);
    if (CLASSIFICATION == PRE) {
        return classify_voxels(b, p_ix, frame.unit_exponent * (shorter ? segment.extent : 1.0));
    }
    Classified c = classify(reconstruct(b, p_ix), frame.unit_exponent);
    c.opacity = shorter ? opacity_over(c.opacity, segment.extent) : c.opacity;
    return c;
}

// The brick of a sample. Where beams lead, runs go on from block to block. `run`: that of the run.
Brick brick_of_sample(Brick run, vec3 p_ix) {
    if (BEAMS) {
        return brick_at(p_ix);
    }
    return run;
}

// Of segments listed in a word, a bit each, adds the first that shows something, of those up to it. Returns the others.
uint add_listed(inout Accumulated acc, Ray ray, Brick b, uint word, uint bits, float shift) {
    uint at;
    Segment segment;
    Classified c;
    bool more;
    do {
        at = 32u * word + lowest_bit(bits);
        segment = inner_segment(at, shift);
        c = classify_middle(ray, b, segment, JITTER);
        uint others = bits & (bits - 1u);
        more = searches_on(c.opacity != 0.0) && others != 0u;
        acc.samples += uint(more);
        bits = more ? others : bits;
    } while (more);
    ++acc.samples;
    add_segment(acc, ray, b, segment, c);
    // As `others` it would be computed in the loop: lavapipe then has it in place of what rays that found something first
    // are still computed from.
    return bits & ~(1u << (at & 31u));
}

// Of segments from `i` up to `end`, adds the first that shows something. Returns the one after it.
uint add_next(inout Accumulated acc, Ray ray, Brick b, uint i, uint end, float shift) {
    Segment segment;
    Brick there;
    Classified c;
    bool more;
    do {
        segment = inner_segment(i, shift);
        there = brick_of_sample(b, ray_position(ray, segment.middle, volume.field_ix));
        c = classify_middle(ray, there, segment, JITTER);
        c.opacity = there.resident ? c.opacity : 0.0;
        more = searches_on(c.opacity != 0.0) && i + 1u < end;
        acc.samples += uint(more);
        i += uint(more);
    } while (more);
    ++acc.samples;
    add_segment(acc, ray, there, segment, c);
    return i + 1u;
}

#ifndef VOTES
// Adds what two segments show at their middles, the second only if `both`. `b`: the brick of the run, unused where beams lead.
void add_middles(inout Accumulated acc, Ray ray, Brick b, Segment segments[2], bool both) {
    vec3 first_ix = ray_position(ray, segments[0].middle, volume.field_ix);
    vec3 second_ix = ray_position(ray, segments[1].middle, volume.field_ix);
    Brick bricks[2] = Brick[](brick_of_sample(b, first_ix), brick_of_sample(b, second_ix));
    vec2 values = reconstruct_pair(bricks[0], first_ix, bricks[1], second_ix);
    // Before anything waits for what the values are.
    float received[2] = shading_pair(first_ix, second_ix, ray.direction_ws);
    Bin bins[2] = Bin[](bin_at(values.x), bin_at(values.y));
    Classified shown[2] = Classified[](classify_in(bins[0], frame.unit_exponent), classify_in(bins[1], frame.unit_exponent));
    shown[0].opacity = bricks[0].resident ? shown[0].opacity : 0.0;
    shown[1].opacity = bricks[1].resident ? shown[1].opacity : 0.0;
    add_pair(acc, ray, bricks, segments, shown, received, both);
}

// Adds two of those that are listed, or one where there is no other.
uint add_listed_pair(inout Accumulated acc, Ray ray, Brick b, uint word, uint bits, float shift) {
    uint others = bits & (bits - 1u);
    Segment first = inner_segment(32u * word + lowest_bit(bits), shift);
    Segment second = inner_segment(32u * word + lowest_bit(others == 0u ? bits : others), shift);
    Segment segments[2] = Segment[](first, second);
    add_middles(acc, ray, b, segments, others != 0u);
    return others & (others - 1u);
}

// Adds two of those up to `end`, or one where there is no other.
uint add_next_pair(inout Accumulated acc, Ray ray, Brick b, uint i, uint end, float shift) {
    Segment segments[2] = Segment[](inner_segment(i, shift), inner_segment(i + 1u, shift));
    add_middles(acc, ray, b, segments, i + 1u < end);
    return min(i + 2u, end);
}
#endif

// Adds the next of those that are listed, or two.
uint add_some_listed(inout Accumulated acc, Ray ray, Brick b, uint word, uint bits, float shift) {
#ifndef VOTES
    if (PAIRED) {
        return add_listed_pair(acc, ray, b, word, bits, shift);
    }
#endif
    return add_listed(acc, ray, b, word, bits, shift);
}

// Adds the next of those up to `end`, or two.
uint add_some(inout Accumulated acc, Ray ray, Brick b, uint i, uint end, float shift) {
#ifndef VOTES
    if (PAIRED) {
        return add_next_pair(acc, ray, b, i, end, shift);
    }
#endif
    return add_next(acc, ray, b, i, end, shift);
}

// Of the first `whole` segments those that the beam lists, a bit each; its first is before `whole`.
void march_listed(inout Accumulated acc, Ray ray, ListedBeam beam, uint whole, float shift) {
    uint words = min((whole + 31u) / 32u, frame.beam_words);
    uint word = beam.first / 32u;
    do {
        uint bits = 0u;
        bool none;
        do {
            uint left = whole - 32u * word;
            uint listed = beam_runs[beam.bits_at + word] & (left < 32u ? (1u << left) - 1u : ~0u);
            none = listed == 0u && word + 1u < words;
            bits |= listed;
            word += uint(none);
        } while (none);
        if (bits != 0u) {
            Brick b = brick_at(ray_position(ray, inner_segment(32u * word + lowest_bit(bits), shift).middle, volume.field_ix));
            do {
                bits = add_some_listed(acc, ray, b, word, bits, shift);
            } while (bits != 0u && acc.opacity < frame.early_termination);
        }
        ++word;
    } while (word < words && acc.opacity < frame.early_termination);
}

// The first `whole` of `count` segments, sampled at their middles. Jittered rays have a shorter first one too and take the exact
// path throughout.
void march_whole(inout Accumulated acc, Ray ray, ListedBeam beam, uint whole, uint count, float shift) {
    if (SHOWN_CELLS) {
        whole = min(whole, beam.end);
        if (beam.first < whole) {
            march_listed(acc, ray, beam, whole, shift);
        }
        return;
    }
    Heading heading = heading_of(ray.step_ix);
    uint i = 0u;
    if (i < whole) {
        do {
            Brick b;
            uint run_end;
            if (BEAMS) {
                // Every sample finds its brick.
                BeamRun run = next_beam_run(beam.bits_at, i, whole);
                i = run.first;
                run_end = run.end;
            } else {
                // Leaps first, in a loop of their own: its body is all that empty space costs.
                vec3 p_ix;
                bool empty;
                do {
                    p_ix = ray_position(ray, inner_segment(i, shift).middle, volume.field_ix);
                    Region region = region_at(p_ix, block_of(p_ix), heading);
                    run_end = min(i + run_length(region, p_ix, heading), whole);
                    empty = region.empty;
                    i = empty ? run_end : i;
                } while (empty && i < whole);
                b = brick_at(p_ix);
                i = b.resident ? i : run_end;
            }
            if (i < run_end) {
                do {
                    i = add_some(acc, ray, b, i, run_end, shift);
                } while (i < run_end && acc.opacity < frame.early_termination);
            }
        } while (i < whole && acc.opacity < frame.early_termination);
    }
}

// What the last segment shows, which is shorter; false where nothing is there to sample. `b`: the brick there.
bool classify_last(Ray ray, uint count, float shift, Segment last, out Brick b, out Classified c) {
    b = brick_at(ray_position(ray, last.middle, volume.field_ix));
    if (b.resident) {
        c = classify_middle(ray, b, last, true);
    }
    return b.resident;
}
