#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#extension GL_EXT_shader_image_load_formatted : require
// Surfaces of equal value, opaque or not, front to back. A surface is met where the field changes sides of its value between the
// ends of a segment; where exactly is found by bisection.

#include "bindings.glsl"
#include "structs.glsl"
#include "volume.glsl"
#include "reconstruct.glsl"
#include "skip.glsl"
#include "composite.glsl"
#include "random.glsl"
#include "ray.glsl"
#include "nodes.glsl"
#include "target.glsl"
#include "frame.glsl"
#include "field_gradient.glsl"
#include "shade.glsl"
#include "labels.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = BINDING_SURFACES) uniform SurfaceBlock { SurfaceParams surfaces; };

// Steps from the ray's origin to where the field is `value`, between `low` and `high` with the field `at_low` and `at_high`.
float refine(Ray ray, Brick b, float value, float low, float high, float at_low, float at_high) {
    for (uint n = 0u; n < surfaces.bisections; ++n) {
        float middle = 0.5 * (low + high);
        vec3 p_ix = ray_position(ray, middle, volume.field_ix);
        Brick there = brick_near(p_ix, b);
        float found = reconstruct(there, p_ix);
        bool before = (found < value) == (at_low < value);
        low = before ? middle : low;
        at_low = before ? found : at_low;
        high = before ? high : middle;
        at_high = before ? at_high : found;
    }
    float rise = at_high - at_low;
    return rise == 0.0 ? low : mix(low, high, clamp((value - at_low) / rise, 0.0, 1.0));
}

void add_surface(inout Accumulated acc, Ray ray, Brick b, float steps, vec4 surface) {
    vec3 p_ix = ray_position(ray, steps, volume.field_ix);
    Brick there = brick_near(p_ix, b);
    apply_label(p_ix, surface.rgb, surface.a);
    vec3 color = surface.rgb * shading(there, p_ix, ray.direction_ws, true);
    if (AUX) {
        gather_depth(acc, surface.a, depth_mm(ray, steps), frame.depth_threshold);
    }
    composite(acc, color, surface.a);
}

// Every surface between the ends of a segment, in the order of the ray. Values ascend.
void add_segment(inout Accumulated acc, Ray ray, Brick b, vec2 ends, float front, float back) {
    bool rising = front < back;
    for (int n = 0; n < int(surfaces.count); ++n) {
        int s = rising ? n : int(surfaces.count) - 1 - n;
        float value = surfaces.values[s / 4][s % 4];
        bool crossed = (front < value) != (back < value);
        if (crossed && acc.opacity < frame.early_termination) {
            add_surface(acc, ray, b, refine(ray, b, value, ends.x, ends.y, front, back), surfaces.colors[s]);
        }
    }
}

// True when a surface lies between two values.
bool is_crossed(float front, float back) {
    bool crossed = false;
    for (uint s = 0u; s < surfaces.count; ++s) {
        float value = surfaces.values[s / 4u][s % 4u];
        crossed = crossed || (front < value) != (back < value);
    }
    return crossed;
}

// The two ends of a segment.
struct Ends {
    float front;
    float back;
    Brick brick;  // at the back, or at the front where nothing is resident there
};

Ends ends_at(vec3 front_ix, vec3 back_ix) {
    Brick at_front = brick_at(front_ix);
    Brick at_back = brick_near(back_ix, at_front);
    if (!at_front.resident) {
        at_front = at_back;
    }
    return Ends(reconstruct(at_front, front_ix), reconstruct(at_back, back_ix), at_back);
}

void march(inout Accumulated acc, Ray ray, float shift) {
    uint count = segment_count(ray, shift);
    uint i = 0u;
    while (i < count && acc.opacity < frame.early_termination) {
        EndsRun run = next_run(ray, i, count, shift);
        i = run.first;
        vec3 front_ix = node_position(ray, i, count, shift);
        Ends ends = ends_at(front_ix, front_ix);
        // The search has a loop of its own: CPU drivers execute both sides of a branch, and refinement is dear.
        bool crossed = false;
        while (i < run.end && !crossed) {
            vec3 back_ix = node_position(ray, i + 1u, count, shift);
            Ends next = UNIFORM_GRID
                ? Ends(ends.back, reconstruct(ends.brick, back_ix), ends.brick)
                : ends_at(front_ix, back_ix);
            front_ix = back_ix;
            ends = next;
            crossed = ends.brick.resident && is_crossed(ends.front, ends.back);
            acc.samples += ends.brick.resident ? 1u : 0u;
            ++i;
        }
        if (crossed) {
            Segment segment = segment_of(i - 1u, count, ray.extent, shift);
            vec2 at = segment.middle + vec2(-0.5, 0.5) * segment.extent;
            add_segment(acc, ray, ends.brick, at, ends.front, ends.back);
        }
    }
}

void main() {
    uvec2 px = frame_pixel();
    if (is_outside(px)) {
        return;
    }
    Ray ray = frame_ray(px);
    Accumulated acc = nothing();
    march(acc, ray, frame_shift(px));
    vec4 layers = vec4(acc.depth_mm, float(acc.samples), acc.median_mm, expected_depth(acc));
    frame_store(px, vec4(acc.radiance, acc.opacity), layers);
}
