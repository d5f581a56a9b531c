// The march over samples at the ends of segments, integrated between. march.comp includes it after add_segment().

// The end of a segment.
struct Node {
    Brick brick;
    bool resident;  // whether there is a brick at it, not only one before it
    float place;    // of its value on an axis of the table
};

Node node_at(vec3 p_ix, Brick fallback) {
    Brick there = brick_at(p_ix);
    Brick b = there.resident ? there : fallback;
    return Node(b, there.resident, table_place(reconstruct(b, p_ix)));
}

// What segment `i` shows between its ends; opacity over a whole step.
Classified classify_between(Ray ray, Node front, Node back, uint i, uint count, float shift) {
    if (!front.resident) {
        // Nothing was there to sample: the brick behind goes up to their common face.
        front.place = table_place(reconstruct(back.brick, node_position(ray, i, count, shift)));
    }
    Classified c = classify_step(front.place, back.place);
    // A ray that leaves the last brick of some sees it up to the end of one segment.
    c.opacity = front.resident || back.resident ? c.opacity : 0.0;
    return c;
}

// Of segments from `i` up to `end`, adds the first that shows something. `front`: the start of segment `i`, that of the next one
// afterwards. Returns the next one.
uint add_next(inout Accumulated acc, Ray ray, inout Node front, uint i, uint end, uint count, float shift) {
    Node back;
    Classified c;
    bool more;
    do {
        back = node_at(node_position(ray, i + 1u, count, shift), front.brick);
        c = classify_between(ray, front, back, i, count, shift);
        more = searches_on(c.opacity != 0.0) && i + 1u < end;
        acc.samples += uint(more);
        i += uint(more);
        if (more) {
            front = back;
        }
    } while (more);
    Segment segment = inner_segment(i, shift);
    c.opacity = JITTER ? opacity_over(c.opacity, segment.extent) : c.opacity;
    Brick b = brick_near(ray_position(ray, segment.middle, volume.field_ix), back.brick);
    ++acc.samples;
    add_segment(acc, ray, b, segment, c);
    front = back;
    return i + 1u;
}

#ifndef VOTES
// Adds two of them, or one where there is no other, where the atlas is the volume.
uint add_next_pair(inout Accumulated acc, Ray ray, inout Node front, uint i, uint end, uint count, float shift) {
    vec3 middle_ix = node_position(ray, i + 1u, count, shift);
    vec3 back_ix = node_position(ray, i + 2u, count, shift);
    vec2 values = reconstruct_pair(front.brick, middle_ix, front.brick, back_ix);
    Segment segments[2] = Segment[](inner_segment(i, shift), inner_segment(i + 1u, shift));
    float received[2] = shading_pair(
        ray_position(ray, segments[0].middle, volume.field_ix),
        ray_position(ray, segments[1].middle, volume.field_ix),
        ray.direction_ws);
    float middle = table_place(values.x);
    float back = table_place(values.y);
    Classified shown[2] = Classified[](classify_step(front.place, middle), classify_step(middle, back));
    Brick bricks[2] = Brick[](front.brick, front.brick);
    add_pair(acc, ray, bricks, segments, shown, received, i + 1u < end);
    front.place = back;
    return min(i + 2u, end);
}
#endif

// Adds the next one, or two.
uint add_some(inout Accumulated acc, Ray ray, inout Node front, uint i, uint end, uint count, float shift) {
#ifndef VOTES
    if (PAIRED) {
        return add_next_pair(acc, ray, front, i, end, count, shift);
    }
#endif
    return add_next(acc, ray, front, i, end, count, shift);
}

// The first `whole` of `count` segments, sampled at their ends and integrated between.
void march_whole(inout Accumulated acc, Ray ray, ListedBeam beam, uint whole, uint count, float shift) {
    uint i = beam.first;
    whole = min(whole, beam.end);
    if (i < whole) {
        do {
            EndsRun run;
            if (BEAMS) {
                BeamRun shown = next_beam_run(beam.bits_at, i, whole);
                run = EndsRun(shown.first, shown.end);
            } else {
                run = next_run(ray, i, count, shift);
                run.end = min(run.end, whole);
            }
            i = run.first;
            if (i < run.end) {
                vec3 front_ix = node_position(ray, i, count, shift);
                Node front = node_at(front_ix, brick_at(front_ix));
                do {
                    i = add_some(acc, ray, front, i, run.end, count, shift);
                } while (i < run.end && acc.opacity < frame.early_termination);
            }
        } while (i < whole && acc.opacity < frame.early_termination);
    }
}

// What the last segment shows, which is shorter. `middle`: the brick there.
bool classify_last(Ray ray, uint count, float shift, Segment last, out Brick middle, out Classified c) {
    uint i = count - 1u;
    vec3 front_ix = node_position(ray, i, count, shift);
    Node front = node_at(front_ix, brick_at(front_ix));
    Node back = node_at(node_position(ray, count, count, shift), front.brick);
    middle = brick_near(ray_position(ray, last.middle, volume.field_ix), back.brick);
    c = classify_between(ray, front, back, i, count, shift);
    c.opacity = opacity_over(c.opacity, last.extent);
    return true;
}
