#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_shader_image_load_formatted : require
// Front-to-back march of the bricked volume into a target image. One invocation a pixel.

#include "bindings.glsl"
#include "structs.glsl"
#include "volume.glsl"
#include "reconstruct.glsl"
#include "classify.glsl"
#include "preclassify.glsl"
#include "preintegrated.glsl"
#include "skip.glsl"
#include "composite.glsl"
#include "random.glsl"
#include "ray.glsl"
#include "nodes.glsl"
#include "target.glsl"
#include "frame.glsl"
#include "gradient.glsl"
#include "shade.glsl"
#include "labels.glsl"
#include "data_color.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

// When it is applied: after interpolation, before it, or along each segment (src/pass/picture.rs).
const uint POST = 0u;
const uint PRE = 1u;
const uint PREINTEGRATED = 2u;
layout(constant_id = SPEC_CLASSIFICATION) const uint CLASSIFICATION = 0;

// Opacity alone, of which the optical depth is kept (Max's absorption-only model).
layout(constant_id = SPEC_XRAY) const bool XRAY = false;

// Adds what a segment shows. `b`: the brick at its middle.
void add_segment(inout Accumulated acc, Ray ray, Brick b, Segment segment, Classified c) {
    acc.samples += 1u;
    vec3 p_ix = ray_position(ray, segment.middle, volume.field_ix);
    apply_data_color(b, p_ix, c.color);
    apply_label(p_ix, c.color, c.opacity);
    if (XRAY) {
        acc.optical_depth += optical_depth(c.opacity);
        c.color = vec3(0.0);
        c.emission = vec3(0.0);
    } else {
        c.color *= shading(b, p_ix, ray.direction_ws, c.opacity > 0.0);
    }
    if (AUX) {
        gather_depth(acc, c.opacity, depth_mm(ray, segment.middle), frame.depth_threshold);
    }
    composite(acc, c.color + c.emission, c.opacity);
}

// Samples a segment at its middle. `shorter`: it may be shorter than a whole step.
void add_middle(inout Accumulated acc, Ray ray, Brick b, Segment segment, bool shorter) {
    vec3 p_ix = ray_position(ray, segment.middle, volume.field_ix);
    Classified c;
    if (CLASSIFICATION == PRE) {
        c = classify_voxels(b, p_ix, frame.unit_exponent * (shorter ? segment.extent : 1.0));
    } else {
        c = classify(reconstruct(b, p_ix), frame.unit_exponent);
        c.opacity = shorter ? opacity_over(c.opacity, segment.extent) : c.opacity;
    }
    add_segment(acc, ray, b, segment, c);
}

// Segments sampled at their middles.
void march_middles(inout Accumulated acc, Ray ray, float shift) {
    uint count = segment_count(ray, shift);
    // The last segment is shorter and comes by itself after the loop, so that the loop needs no power function. Jittered
    // rays have a shorter first one too and take the exact path throughout.
    uint whole = count - min(count, 1u);
    uint i = 0u;
    while (i < whole && acc.opacity < frame.early_termination) {
        // Leaps first, in a loop of their own: its body is all that empty space costs.
        vec3 p_ix;
        bool empty;
        uint run_end;
        do {
            p_ix = ray_position(ray, segment_of(i, count, ray.extent, shift).middle, volume.field_ix);
            Region region = region_at(p_ix, block_of(p_ix));
            run_end = i + samples_before(steps_to_border(p_ix, ray.step_ix, region.low_ix, region.high_ix));
            run_end = min(run_end, whole);
            empty = region.empty;
            i = empty ? run_end : i;
        } while (empty && i < whole);
        Brick b = brick_at(p_ix);
        i = b.resident ? i : run_end;
        for (; i < run_end && acc.opacity < frame.early_termination; ++i) {
            add_middle(acc, ray, b, segment_of(i, count, ray.extent, shift), JITTER);
        }
    }
    if (count > 0u && acc.opacity < frame.early_termination) {
        Segment last = segment_of(count - 1u, count, ray.extent, shift);
        Brick b = brick_at(ray_position(ray, last.middle, volume.field_ix));
        if (b.resident) {
            add_middle(acc, ray, b, last, true);
        }
    }
}

// Segments sampled at their ends, and integrated between.
void march_ends(inout Accumulated acc, Ray ray, float shift) {
    uint count = segment_count(ray, shift);
    uint i = 0u;
    while (i < count && acc.opacity < frame.early_termination) {
        EndsRun run = next_run(ray, i, count, shift);
        i = run.first;
        vec3 front_ix = node_position(ray, i, count, shift);
        Brick front_brick = brick_at(front_ix);
        float front = table_place(reconstruct(front_brick, front_ix));
        for (; i < run.end && acc.opacity < frame.early_termination; ++i) {
            vec3 back_ix = node_position(ray, i + 1u, count, shift);
            Brick back_brick = brick_near(back_ix, front_brick);
            float back = table_place(reconstruct(back_brick, back_ix));
            Segment segment = segment_of(i, count, ray.extent, shift);
            if (!front_brick.resident) {
                // Nothing was there to sample: the brick behind goes up to their common face.
                front = table_place(reconstruct(back_brick, front_ix));
            }
            if (back_brick.resident) {
                Classified c = classify_step(front, back);
                c.opacity = JITTER || i + 1u == count ? opacity_over(c.opacity, segment.extent) : c.opacity;
                Brick b = brick_near(ray_position(ray, segment.middle, volume.field_ix), back_brick);
                add_segment(acc, ray, b, segment, c);
            }
            front = back;
            front_brick = back_brick;
        }
    }
}

void main() {
    uvec2 px = frame_pixel();
    if (is_outside(px)) {
        return;
    }
    Ray ray = frame_ray(px);
    float shift = frame_shift(px);
    Accumulated acc = nothing();
    if (CLASSIFICATION == PREINTEGRATED) {
        march_ends(acc, ray, shift);
    } else {
        march_middles(acc, ray, shift);
    }
    float last = XRAY ? acc.optical_depth : expected_depth(acc);
    frame_store(px, vec4(acc.radiance, acc.opacity), vec4(acc.depth_mm, float(acc.samples), acc.median_mm, last));
}
