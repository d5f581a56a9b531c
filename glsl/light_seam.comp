#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
// Light on the borders of bricks: samples that another brick computes are copied from it, and samples on the border of a
// coarser brick follow its interpolation, so that light is continuous. One dispatch a level, coarsest first.

#include "bindings.glsl"
#include "structs.glsl"
#include "deal.glsl"
#include "volume.glsl"
#include "light_work.glsl"
#include "half_float.glsl"

layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

layout(set = 0, binding = BINDING_LIGHT_STORE, rgba16f) uniform image3D i_light;
layout(push_constant) uniform Push { PartPush push; };

vec4 light_texel(vec3 origin_at, ivec3 local) {
    return imageLoad(i_light, ivec3(origin_at) + local);
}

// Closer than this to a sample is at it: samples of one brick lie at whole sixteenths between those of another.
const float ROUNDING = 1e-3;

vec4 light_between(Brick b, vec3 p_ix) {
    vec3 local = clamp((p_ix - b.base_ix) * b.scale, vec3(0.0), b.intervals);
    // Rounding must not reach for a neighbour, however small its weight: this dispatch may be writing it, or nobody ever did.
    vec3 whole = round(local);
    local = mix(local, whole, lessThan(abs(local - whole), vec3(ROUNDING)));
    ivec3 i = min(ivec3(local), ivec3(b.intervals) - 1);
    vec3 f = local - vec3(i);
    vec4 sum = vec4(0.0);
    for (int corner = 0; corner < 8; ++corner) {
        ivec3 bit = ivec3(corner & 1, (corner >> 1) & 1, corner >> 2);
        vec3 w = mix(1.0 - f, f, vec3(bit));
        float weight = w.x * w.y * w.z;
        if (weight > 0.0) {
            sum += weight * light_texel(b.origin_at, i + bit);
        }
    }
    return sum;
}

void main() {
    if (gl_WorkGroupID.x >= push.count) {
        return;
    }
    uvec4 entry = work[push.first + dealt(gl_WorkGroupID.x, push.count)];
    if (!has_sample(entry, gl_LocalInvocationIndex)) {
        return;
    }
    LightSample s = light_sample(entry, listed_sample(entry, gl_LocalInvocationIndex));
    Brick brick = brick_of(s.record);
    Sharing sharing = sharing_of(brick, s.record.block_bx, s.local);
    bool coarser = sharing.coarsest_level < brick.level;
    Brick from = brick_fetch(coarser ? sharing.coarsest_bx : sharing.owner_bx);
    imageStore(i_light, s.sample_at, round_to_half(light_between(from, sample_position_ix(brick, s.local))));
}
