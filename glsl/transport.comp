#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#extension GL_EXT_shader_image_load_formatted : require
// Max's optical models along the rays of a picture: absorption, emission, both with light of their own, and light that is
// scattered towards the eye. One invocation a pixel.

#include "bindings.glsl"
#include "structs.glsl"
#include "volume.glsl"
#include "reconstruct.glsl"
#include "classify.glsl"
#include "skip.glsl"
#include "composite.glsl"
#include "random.glsl"
#include "ray.glsl"
#include "target.glsl"
#include "frame.glsl"
#include "field_gradient.glsl"
#include "labels.glsl"
#include "medium.glsl"
#include "phase.glsl"
#include "lights.glsl"
#include "reflect.glsl"
#include "shadow_ray.glsl"
#include "scattered_source.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

const uint ABSORPTION = 0u;
const uint EMISSION_ALONE = 1u;
const uint EMISSION_ABSORPTION = 2u;
const uint SCATTERING = 3u;
layout(constant_id = SPEC_MODEL) const uint MODEL = 2;

// Red, green and blue see different extinctions: the share that comes through each is kept too.
layout(constant_id = SPEC_CHROMATIC) const bool CHROMATIC = false;

layout(set = 0, binding = BINDING_THROUGH, rgba32f) uniform writeonly image2D i_through;

struct Seen {
    vec3 radiance;
    vec3 through;
};

void add_segment(inout Accumulated acc, inout Seen seen, Ray ray, Brick b, Segment segment) {
    acc.samples += 1u;
    vec3 p_ix = ray_position(ray, segment.middle, volume.field_ix);
    Matter matter = matter_at(b, p_ix);
    float length_mm = segment.extent * frame.step_mm;
    float depth = matter.extinction * length_mm;
    acc.optical_depth += depth;
    vec3 depths = MODEL == EMISSION_ALONE ? vec3(0.0) : medium.extinction * depth;
    vec3 opacities = vec3(opacity_of(depths.r), opacity_of(depths.g), opacity_of(depths.b));
    // Light of the segment that leaves it, per unit of what it sends out: (1 - exp(-d)) / d.
    vec3 leaving = mix(opacities / depths, vec3(1.0), lessThan(depths, vec3(1e-6)));
    // Radiance per optical depth, then per mm.
    vec3 emitted = matter.emission;
    vec3 source = matter.source;
    if (MODEL == SCATTERING) {
        source += scattered_source(b, p_ix, ray.direction_ws, matter);
    } else {
        emitted += matter.color;
    }
    source += emitted * medium.extinction * matter.extinction;
    if (MODEL != ABSORPTION) {
        seen.radiance += seen.through * leaving * source * length_mm;
    }
    vec3 through = seen.through * (1.0 - opacities);
    if (AUX) {
        float left = 1.0 - acc.opacity;
        float alpha = left > 0.0 ? 1.0 - dot(through, vec3(1.0 / 3.0)) / left : 0.0;
        gather_depth(acc, alpha, depth_mm(ray, segment.middle), frame.depth_threshold);
    }
    seen.through = through;
    acc.opacity = 1.0 - dot(through, vec3(1.0 / 3.0));
}

bool goes_on(Seen seen) {
    return 1.0 - max(seen.through.r, max(seen.through.g, seen.through.b)) < frame.early_termination;
}

void march(inout Accumulated acc, inout Seen seen, Ray ray, float shift) {
    uint count = segment_count(ray, shift);
    Heading heading = heading_of(ray.step_ix);
    uint i = 0u;
    if (i < count) {
        do {
            vec3 p_ix;
            bool empty;
            uint run_end;
            do {
                p_ix = ray_position(ray, segment_of(i, count, ray.extent, shift).middle, volume.field_ix);
                Region region = region_at(p_ix, block_of(p_ix), heading);
                run_end = i + samples_before(steps_to_border(p_ix, heading, region.border_ix));
                run_end = min(run_end, count);
                empty = region.empty;
                i = empty ? run_end : i;
            } while (empty && i < count);
            Brick b = brick_at(p_ix);
            i = b.resident ? i : run_end;
            if (i < run_end) {
                do {
                    add_segment(acc, seen, ray, b, segment_of(i, count, ray.extent, shift));
                    ++i;
                } while (i < run_end && goes_on(seen));
            }
        } while (i < count && goes_on(seen));
    }
}

void main() {
    uvec2 px = frame_pixel();
    if (is_outside(px)) {
        return;
    }
    Ray ray = frame_ray(px);
    Accumulated acc = nothing();
    Seen seen = Seen(vec3(0.0), vec3(1.0));
    march(acc, seen, ray, frame_shift(px));
    float last = MODEL == ABSORPTION ? acc.optical_depth : expected_depth(acc);
    vec4 layers = vec4(acc.depth_mm, float(acc.samples), acc.median_mm, last);
    bool surrounded = ENVIRONMENT != 0u && medium.environment.w > 0.0;
    if (SCENE_DEPTH) {
        surrounded = surrounded && steps_to_scene(ivec2(px), ray) == FAR_STEPS;
    }
    if (surrounded) {
        seen.radiance += seen.through * environment_radiance(ray.direction_ws);
        seen.through = vec3(0.0);
        acc.opacity = 1.0;
    }
    if (CHROMATIC) {
        imageStore(i_through, ivec2(px), vec4(seen.through, 1.0));
    }
    frame_store_through(px, vec4(seen.radiance, acc.opacity), seen.through, layers);
}
