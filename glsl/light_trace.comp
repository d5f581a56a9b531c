#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
// Local ambient occlusion, eq. 1-5 of Hernell, Ljung and Ynnerman (2007): one direction for every sample of the light
// volume that can be seen, as a running mean.

#include "bindings.glsl"
#include "structs.glsl"
#include "deal.glsl"
#include "volume.glsl"
#include "reconstruct.glsl"
#include "classify.glsl"
#include "skip.glsl"
#include "light_work.glsl"
#include "half_float.glsl"
#include "labels.glsl"

layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

layout(set = 0, binding = BINDING_LIGHT_STORE, rgba16f) uniform image3D i_light;
layout(push_constant) uniform Push { LightPush push; };

// Writes how many samples were taken instead of the light (the bench).
layout(constant_id = SPEC_COUNT) const bool COUNT = false;
// Distances between samples grow.
layout(constant_id = SPEC_GROWTH) const bool GROWTH = false;

#include "light_ray.glsl"
#include "light_growth.glsl"

// Light from one direction: rgb with emission, a without; or how many samples that took.
vec4 light_along(vec3 p_ix, int level) {
    LightRay ray = light_ray(p_ix, level);
    Gathered g = Gathered(1.0, 0.0, 0.0, vec3(0.0), 0u);
    if (GROWTH) {
        gather_growing(g, ray);
    } else {
        gather_uniform(g, ray);
    }
    if (COUNT) {
        return vec4(float(g.samples));
    }
    float light = g.light + g.transparency * (float(ray.parts) - g.since);
    return vec4(vec3(light) + g.emitted, light) / float(ray.parts);
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
    vec4 light = light_along(sample_position_ix(brick, s.local), brick.level);
    vec4 mean = push.ray == 0u ? vec4(0.0) : imageLoad(i_light, s.sample_at);
    if (COUNT) {
        imageStore(i_light, s.sample_at, mean + light);
        return;
    }
    light *= push.weight;
    imageStore(i_light, s.sample_at, round_to_half(mean + (light - mean) / float(push.ray + 1u)));
}
