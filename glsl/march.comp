#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#extension GL_EXT_shader_image_load_formatted : require
#ifdef VOTES
#extension GL_KHR_shader_subgroup_vote : require
#endif
// Front-to-back march of the bricked volume into a target image. One invocation a pixel. MARCH_ENDS: pre-integrated.

#include "bindings.glsl"
#include "structs.glsl"
#include "volume.glsl"
#include "reconstruct.glsl"
#include "classify.glsl"
#ifdef MARCH_ENDS
#include "preintegrated.glsl"
#else
#include "preclassify.glsl"
#endif
#include "skip.glsl"
#include "composite.glsl"
#include "random.glsl"
#include "ray.glsl"
#include "nodes.glsl"
#include "target.glsl"
#include "frame.glsl"
#include "march_variant.glsl"
#include "beams.glsl"
#include "beam_runs.glsl"
#include "field_gradient.glsl"
#include "shade.glsl"
#include "labels.glsl"
#include "data_color.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

// Samples that show something are searched for in a loop of its own, so that only they are shaded or looked up among the labels:
// CPU drivers execute both sides of a branch. They also go on computing what a ray has found while others search, so that an
// iteration that ends the search must leave alone what it was computed from.
layout(constant_id = SPEC_SEARCHED) const bool SEARCHED = false;

// Whether a ray goes on searching. VOTES: the rays of a subgroup search together and stop where any of them finds something; alone
// they fall out of step, and all of them wait for the one that searches longest.
bool searches_on(bool found) {
    bool on = !found;
#ifdef VOTES
    on = !subgroupAny(found);
#endif
    return SEARCHED && on;
}

// The colour that data and labels give at the middle of a segment.
void color_segment(Brick b, vec3 p_ix, inout Classified c) {
    apply_data_color(b, p_ix, c.color);
    apply_label(p_ix, c.color, c.opacity);
}

// `c`: with its colour as it is lit.
void add_lit(inout Accumulated acc, Ray ray, Segment segment, Classified c) {
    if (XRAY) {
        acc.optical_depth += optical_depth(c.opacity);
        c.color = vec3(0.0);
        c.emission = vec3(0.0);
    }
    if (AUX) {
        gather_depth(acc, c.opacity, depth_mm(ray, segment.middle), frame.depth_threshold);
    }
    composite(acc, c.color + c.emission, c.opacity);
}

// Adds what a segment shows. `b`: the brick at its middle.
void add_segment(inout Accumulated acc, Ray ray, Brick b, Segment segment, Classified c) {
    vec3 p_ix = ray_position(ray, segment.middle, volume.field_ix);
    color_segment(b, p_ix, c);
    c.color *= shading(b, p_ix, ray.direction_ws, c.opacity > 0.0);
    add_lit(acc, ray, segment, c);
}

// Two segments at once, of packed corners: what a sample reads, computes and adds is a long chain of steps that wait for each other, and
// processors get no farther meanwhile than they look ahead. (Searches take one by one: a driver translates and inlines all of a module
// before it knows what a variant needs, so the modules for those are without.)
layout(constant_id = SPEC_PAIRED) const bool PAIRED = false;

#ifndef VOTES
// Adds what two segments show over whole steps, the second only if `both`. `bricks` and `received`: those at
// their middles, and what shading makes of colours there.
void add_pair(
    inout Accumulated acc, Ray ray, Brick bricks[2], Segment segments[2], Classified shown[2], float received[2], bool both
) {
    bool on = true;
    // (A loop, so that its body is inlined once.)
    [[unroll]] for (int n = 0; n < 2; ++n) {
        Classified c = shown[n];
        c.opacity = JITTER ? opacity_over(c.opacity, segments[n].extent) : c.opacity;
        // Without opacity it adds nothing. (A branch would take longer.)
        c.opacity = on ? c.opacity : 0.0;
        acc.samples += uint(on);
        color_segment(bricks[n], ray_position(ray, segments[n].middle, volume.field_ix), c);
        c.color *= received[n];
        add_lit(acc, ray, segments[n], c);
        on = both && acc.opacity < frame.early_termination;
    }
}
#endif

#ifdef MARCH_ENDS
#include "march_ends.glsl"
#else
#include "march_middles.glsl"
#endif

void main() {
    ListedBeam beam = ListedBeam(0u, 0u, ~0u);
    uvec2 px;
    if (BEAMS) {
        px = beam_pixel(beam);
    } else {
        px = frame_pixel();
    }
    if (is_outside(px)) {
        return;
    }
    Ray ray = frame_ray(px);
    float shift = frame_shift(px);
    Accumulated acc = nothing();
    // The last segment is shorter and comes by itself after the loops, so that they need no power function.
    uint count = segment_count(ray, shift);
    uint whole = count - min(count, 1u);
    march_whole(acc, ray, beam, whole, count, shift);
    if (count > 0u && acc.opacity < frame.early_termination) {
        Segment last = segment_of(whole, count, ray.extent, shift);
        Brick b;
        Classified c;
        bool sampled = classify_last(ray, count, shift, last, b, c);
        if (sampled) {
            ++acc.samples;
            add_segment(acc, ray, b, last, c);
        }
    }
    march_store(px, acc);
}
