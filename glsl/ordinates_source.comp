#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
// Redistributes the light of all direction bins by the phase function, adds what comes straight from the lights and what is
// emitted, and finds how much changed. One invocation a point.

#include "bindings.glsl"
#include "structs.glsl"
#include "volume.glsl"
#include "reconstruct.glsl"
#include "classify.glsl"
#include "labels.glsl"
#include "medium.glsl"
#include "phase.glsl"
#include "lights.glsl"
#include "scatter_grid.glsl"
#include "bins.glsl"
#include "direct.glsl"

layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

// By incoming (x) and outgoing bin (y): mean phase function, its sum over outgoing solid angles 1.
layout(set = 0, binding = BINDING_PHASE_MATRIX) uniform sampler2D t_phase_matrix;
layout(set = 0, binding = BINDING_INTENSITY_STORE, rgba32f) uniform readonly image3D i_intensity;
layout(set = 0, binding = BINDING_SOURCE_STORE, rgba32f) uniform writeonly image3D i_source;
layout(set = 0, binding = BINDING_FLUENCE_STORE, rgba32f) uniform image3D i_fluence;
// By iteration: largest change of the fluence, largest fluence (bits of floats that are not negative).
layout(set = 0, binding = BINDING_RESIDUAL) buffer Residual { uvec2 residual[]; };

void main() {
    ivec3 point = ivec3(gl_GlobalInvocationID);
    if (any(greaterThanEqual(point, medium.scatter_points))) {
        return;
    }
    vec3 scattering = grid_scattering(point);
    vec3 emission = has(SURROUNDINGS) ? vec3(0.0) : grid_emission(point);
    vec3 fluence = vec3(0.0);
    if (!has(FIRST)) {
        for (uint bin = 0u; bin < push.bins; ++bin) {
            fluence += imageLoad(i_intensity, bin_texel(bin, point)).rgb * bin_direction(bin).w;
        }
        vec3 change = abs(fluence - imageLoad(i_fluence, point).rgb);
        float most = max(change.r, max(change.g, change.b));
        float largest = max(fluence.r, max(fluence.g, fluence.b));
        atomicMax(residual[push.step].x, floatBitsToUint(most));
        atomicMax(residual[push.step].y, floatBitsToUint(largest));
    }
    imageStore(i_fluence, point, vec4(fluence, 1.0));
    if (PHASE == 0u) {
        // One source for all directions.
        vec3 received = has(SURROUNDINGS) ? vec3(0.0) : fluence + direct_fluence(point);
        imageStore(i_source, point, vec4(scattering * received * PER_SPHERE + emission, 1.0));
        return;
    }
    for (uint bin = 0u; bin < push.bins; ++bin) {
        vec3 received = vec3(0.0);
        if (!has(FIRST) && !has(SURROUNDINGS)) {
            for (uint from = 0u; from < push.bins; ++from) {
                float share = texelFetch(t_phase_matrix, ivec2(int(from), int(bin)), 0).r * bin_direction(from).w;
                received += imageLoad(i_intensity, bin_texel(from, point)).rgb * share;
            }
        }
        if (!has(SURROUNDINGS)) {
            received += direct_scattered(point, bin_direction(bin).xyz);
        }
        imageStore(i_source, bin_texel(bin, point), vec4(scattering * received + emission, 1.0));
    }
}
