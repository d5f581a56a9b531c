#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
// Gathers the light of all direction bins that every point scatters towards the eye. One invocation a point.

#include "bindings.glsl"
#include "structs.glsl"
#include "volume.glsl"
#include "reconstruct.glsl"
#include "classify.glsl"
#include "labels.glsl"
#include "medium.glsl"
#include "phase.glsl"
#include "scatter_grid.glsl"
#include "bins.glsl"

layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

layout(set = 0, binding = BINDING_INTENSITY_STORE, rgba32f) uniform readonly image3D i_intensity;
layout(set = 0, binding = BINDING_SCATTERED_STORE, rgba32f) uniform writeonly image3D i_scattered;

void main() {
    ivec3 point = ivec3(gl_GlobalInvocationID);
    if (any(greaterThanEqual(point, medium.scatter_points))) {
        return;
    }
    vec3 p_ws = ws_from_ix(grid_position(point));
    vec3 apart = push.eye.xyz - p_ws;
    vec3 to_eye = push.eye.w > 0.0 ? apart * inversesqrt(max(dot(apart, apart), 1e-30)) : push.eye.xyz;
    vec3 sum = vec3(0.0);
    float weights = 0.0;
    for (uint bin = 0u; bin < push.bins; ++bin) {
        vec4 direction = bin_direction(bin);
        float weight = phase_function(medium.phase, dot(direction.xyz, to_eye)) * direction.w;
        sum += imageLoad(i_intensity, bin_texel(bin, point)).rgb * weight;
        weights += weight;
    }
    // As much is scattered as the phase function says, whatever the bins' directions see of it.
    imageStore(i_scattered, point, vec4(sum / weights, 1.0));
}
