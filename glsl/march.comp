#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_shader_image_load_formatted : require
// Front-to-back march of the bricked volume into a target image. One invocation a pixel.

#include "bindings.glsl"
#include "structs.glsl"
#include "volume.glsl"
#include "reconstruct.glsl"
#include "classify.glsl"
#include "skip.glsl"
#include "shade.glsl"
#include "composite.glsl"
#include "random.glsl"
#include "ray.glsl"
#include "target.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = SPEC_JITTER) const bool JITTER = false;
layout(constant_id = SPEC_AUX) const bool AUX = false;
layout(constant_id = SPEC_SCENE_DEPTH) const bool SCENE_DEPTH = false;
layout(constant_id = SPEC_ENCODE_SRGB) const bool ENCODE_SRGB = false;

layout(set = 0, binding = BINDING_FRAME) uniform FrameBlock { FrameParams frame; };
layout(set = 0, binding = BINDING_SCENE_DEPTH) uniform sampler2D t_scene_depth;
// Reading needs the format in the source (doing without is a feature that few devices have), so there is a module for each
// format that can be blended over.
#ifdef BLEND_FORMAT
layout(set = 0, binding = BINDING_TARGET, BLEND_FORMAT) uniform image2D i_target;
#else
layout(set = 0, binding = BINDING_TARGET) uniform writeonly image2D i_target;
#endif
layout(set = 0, binding = BINDING_AUX, rgba32f) uniform writeonly image2D i_aux;
layout(push_constant) uniform Push { MarchPush push; };

// Steps from the ray's origin to the host's geometry.
float steps_to_scene(ivec2 px, Ray ray) {
    float depth = texelFetch(t_scene_depth, px, 0).r;
    if (depth == frame.scene_depth_far) {
        return FAR_STEPS;
    }
    vec2 ndc = (vec2(px) + 0.5) / vec2(frame.size_px) * 2.0 - 1.0;
    vec4 clip = vec4(ndc, depth, 1.0);
    float w = dot(frame.ix_from_clip_w, clip);
    vec3 p_ix = vec3(dot(frame.ix_from_clip_x, clip), dot(frame.ix_from_clip_y, clip), dot(frame.ix_from_clip_z, clip)) / w;
    return dot(p_ix - ray.origin_ix, ray.step_ix) / dot(ray.step_ix, ray.step_ix);
}

// Takes the sample of one segment; `shorter`: it may be shorter than a whole step.
void shade_sample(inout Accumulated acc, Ray ray, Brick brick, Segment segment, bool shorter) {
    vec3 p_ix = ray_position(ray, segment.middle, volume.field_ix);
    vec3 local = brick_local(brick, p_ix);
    Classified c = classify(reconstruct_local(brick, local), frame.unit_exponent);
    float alpha = shorter ? opacity_over(c.opacity, segment.extent) : c.opacity;
    vec3 color = c.color;
    if (LIGHT) {
        color *= light_at(brick, local) + frame.light_bias;
    }
    if (DIFFUSE) {
        if (alpha > 0.0) {
            vec3 light = frame.light_direction_ws.w > 0.0 ? frame.light_direction_ws.xyz : -ray.direction_ws;
            color *= lambert(gradient_ws(brick, p_ix), light, frame.ambient, frame.diffuse);
        }
    }
    composite(acc, color + c.emission, alpha);
    acc.samples += 1u;
    if (AUX && isinf(acc.depth_mm) && acc.opacity >= frame.depth_threshold) {
        acc.depth_mm = (ray.enter + segment.middle) * frame.step_mm;
    }
}

Accumulated march(Ray ray, float shift) {
    Accumulated acc = Accumulated(vec3(0.0), 0.0, uintBitsToFloat(0x7f800000u), 0u);
    uint count = segment_count(ray, shift);
    // The last segment is shorter and comes by itself after the loop, so that the loop needs no power function. Jittered
    // rays have a shorter first one too and take the exact path throughout.
    uint whole = count - min(count, 1u);
    uint i = 0u;
    while (i < whole && acc.opacity < frame.early_termination) {
        // Leaps first, in a loop of their own: its body is all that empty space costs.
        ivec3 block_bx;
        bool empty;
        uint run_end;
        do {
            vec3 p_ix = ray_position(ray, segment_of(i, count, ray.extent, shift).middle, volume.field_ix);
            block_bx = block_of(p_ix);
            Region region = region_at(p_ix, block_bx);
            run_end = i + samples_before(steps_to_border(p_ix, ray.step_ix, region.low_ix, region.high_ix));
            run_end = min(run_end, whole);
            empty = region.empty;
            i = empty ? run_end : i;
        } while (empty && i < whole);
        Brick brick = brick_fetch(block_bx);
        i = brick.resident ? i : run_end;
        for (; i < run_end && acc.opacity < frame.early_termination; ++i) {
            shade_sample(acc, ray, brick, segment_of(i, count, ray.extent, shift), JITTER);
        }
    }
    if (count > 0u && acc.opacity < frame.early_termination) {
        Segment last = segment_of(count - 1u, count, ray.extent, shift);
        Brick brick = brick_fetch(block_of(ray_position(ray, last.middle, volume.field_ix)));
        if (brick.resident) {
            shade_sample(acc, ray, brick, last, true);
        }
    }
    return acc;
}

void main() {
    uvec2 px = push.tile_px + gl_GlobalInvocationID.xy;
    if (any(greaterThanEqual(px, push.tile_end_px))) {
        return;
    }
    Ray ray = ray_through(vec2(px) + 0.5, frame, volume.field_ix);
    if (SCENE_DEPTH) {
        ray.extent = min(ray.extent, steps_to_scene(ivec2(px), ray));
    }
    float shift = JITTER ? random_pixel(px, frame.frame, frame.jitter_seed) : 0.0;
    Accumulated acc = march(ray, shift);

    vec4 behind = frame.background;
#ifdef BLEND_FORMAT
    behind = imageLoad(i_target, ivec2(px));
    if (ENCODE_SRGB) {
        behind.rgb = decode_srgb(behind.rgb);
    }
#endif
    vec4 color = vec4(acc.radiance, acc.opacity) + (1.0 - acc.opacity) * behind;
    if (ENCODE_SRGB) {
        color.rgb = encode_srgb(color.rgb);
    }
    imageStore(i_target, ivec2(px), color);
    if (AUX) {
        imageStore(i_aux, ivec2(px), vec4(acc.depth_mm, float(acc.samples), 0.0, 0.0));
    }
}
