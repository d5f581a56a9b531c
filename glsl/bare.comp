#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_shader_image_load_formatted : require
// The bench's limit: a march that only samples one texture and classifies, as many samples as the real march takes.

#include "bindings.glsl"
#include "structs.glsl"
#include "params.glsl"
#include "classify.glsl"
#include "ray.glsl"
#include "deal.glsl"
#include "lanes.glsl"
#include "packed_cells.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = BINDING_FRAME) uniform FrameBlock { FrameParams frame; };
layout(set = 0, binding = BINDING_VOXELS) uniform sampler3D t_voxels;
layout(set = 0, binding = BINDING_TARGET) uniform writeonly image2D i_target;
layout(push_constant) uniform Push { BarePush push; };

vec4 shown_of(Bin b) {
    Classified c = classify_in(b, 1.0);
    return vec4(c.color, c.opacity);
}

void main() {
    uvec2 px = push.tile_px + lane_pixel();
    if (any(greaterThanEqual(px, push.tile_end_px))) {
        return;
    }
    Ray ray = ray_through(vec2(px) + 0.5, frame, volume.field_ix);
    uint count = segment_count(ray, 0.0);
    // Where the first sample is and how far the next, for the read that there is.
    vec3 first_ix = ray.origin_ix + 0.5 * ray.step_ix;
    vec3 at = first_ix;
    vec3 ahead = ray.step_ix;
    if (PACKED_CELLS == 0u) {
        at = (first_ix + 0.5) * push.extent_texel;
        ahead = ray.step_ix * push.extent_texel;
    }
    vec4 sum = vec4(0.0);
    if (PACKED_CELLS == 0u) {
        for (uint i = 0u; i < count; ++i) {
            sum += shown_of(bin_at(textureLod(t_voxels, at + float(i) * ahead, 0.0).r));
        }
    } else {
        // Two by two, as the march takes them.
        for (uint i = 0u; i < count; i += 2u) {
            vec3 low_ix = clamp(at + float(i) * ahead, vec3(0.0), volume.field_ix);
            vec3 high_ix = clamp(at + float(i + 1u) * ahead, vec3(0.0), volume.field_ix);
            vec2 values = packed_linear_pair(low_ix, high_ix);
            Bin first = bin_at(values.x);
            Bin second = bin_at(values.y);
            sum += shown_of(first);
            sum += i + 1u < count ? shown_of(second) : vec4(0.0);
        }
    }
    imageStore(i_target, ivec2(px), sum);
}
