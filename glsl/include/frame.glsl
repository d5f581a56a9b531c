// What every pass that draws a picture binds, where its rays end, and how it leaves its result. Includes target.glsl and
// ray.glsl first.

#include "deal.glsl"
#include "lanes.glsl"

layout(constant_id = SPEC_JITTER) const bool JITTER = false;
layout(constant_id = SPEC_AUX) const bool AUX = false;
layout(constant_id = SPEC_SCENE_DEPTH) const bool SCENE_DEPTH = false;
layout(constant_id = SPEC_ENCODE_SRGB) const bool ENCODE_SRGB = false;

layout(set = 0, binding = BINDING_FRAME) uniform FrameBlock { FrameParams frame_block; };
FrameParams frame = frame_block; // as in params.glsl
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

uvec2 frame_pixel() {
    return push.tile_px + lane_pixel();
}

bool is_outside(uvec2 px) {
    return any(greaterThanEqual(px, push.tile_end_px));
}

// The ray through a place within a pixel, up to the host's geometry.
Ray frame_ray_through(uvec2 px, vec2 within) {
    Ray ray = ray_through(vec2(px) + within, frame, volume.field_ix);
    if (SCENE_DEPTH) {
        ray.extent = min(ray.extent, steps_to_scene(ivec2(px), ray));
    }
    return ray;
}

// The ray through the middle of a pixel.
Ray frame_ray(uvec2 px) {
    return frame_ray_through(px, vec2(0.5));
}

// Share of a step that the first segment is shortened by.
float frame_shift(uvec2 px) {
    return JITTER ? random_pixel(px, frame.frame, frame.jitter_seed) : 0.0;
}

// Segment `i`, which is not the last of its ray. Most rays have whole segments but for that one: loops over those stay short, of which
// llvmpipe makes much (the march of fog: 0.86 of the time with segment_of()).
Segment inner_segment(uint i, float shift) {
    if (JITTER) {
        float start = max(float(i) - shift, 0.0);
        float end = float(i + 1u) - shift;
        return Segment(0.5 * (start + end), end - start);
    }
    return Segment(float(i) + 0.5, 1.0);
}

float depth_mm(Ray ray, float steps) {
    return (ray.enter + steps) * frame.step_mm;
}

// Composites radiance over what is behind, of which the share `through` comes through. `color`: premultiplied. `layers`: depth,
// samples, and two that the pass chooses.
void frame_store_through(uvec2 px, vec4 color, vec3 through, vec4 layers) {
    vec4 behind = frame.background;
#ifdef BLEND_FORMAT
    behind = imageLoad(i_target, ivec2(px));
    if (ENCODE_SRGB) {
        behind.rgb = decode_srgb(behind.rgb);
    }
#endif
    color.rgb *= frame.exposure;
    color += vec4(through, 1.0 - color.a) * behind;
    if (ENCODE_SRGB) {
        color.rgb = encode_srgb(color.rgb);
    }
    imageStore(i_target, ivec2(px), color);
    if (AUX) {
        imageStore(i_aux, ivec2(px), layers);
    }
}

void frame_store(uvec2 px, vec4 color, vec4 layers) {
    frame_store_through(px, color, vec3(1.0 - color.a), layers);
}
