#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
// Averages the medium over the cells of the grid of scattered light. One invocation a point.

#include "bindings.glsl"
#include "structs.glsl"
#include "volume.glsl"
#include "reconstruct.glsl"
#include "classify.glsl"
#include "labels.glsl"
#include "medium.glsl"

layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

layout(set = 0, binding = BINDING_GRID_MEDIUM_STORE, rgba32f) uniform writeonly image3D i_grid_medium;
layout(set = 0, binding = BINDING_GRID_EMISSION_STORE, rgba32f) uniform writeonly image3D i_grid_emission;

// Samples on an axis of a cell at most.
const int MOST_PARTS = 4;

void main() {
    ivec3 point = ivec3(gl_GlobalInvocationID);
    if (any(greaterThanEqual(point, medium.scatter_points))) {
        return;
    }
    vec3 spacing = volume.field_ix / vec3(medium.scatter_points - 1);
    // Cells on the border are half as wide.
    vec3 low = max((vec3(point) - 0.5) * spacing, vec3(0.0));
    vec3 high = min((vec3(point) + 0.5) * spacing, volume.field_ix);
    ivec3 parts = clamp(ivec3(ceil(high - low)), ivec3(1), ivec3(MOST_PARTS));
    vec4 sum = vec4(0.0);
    vec3 emission = vec3(0.0);
    for (int i = 0; i < parts.x * parts.y * parts.z; ++i) {
        ivec3 part = ivec3(i % parts.x, i / parts.x % parts.y, i / (parts.x * parts.y));
        vec3 p_ix = mix(low, high, (vec3(part) + 0.5) / vec3(parts));
        Brick b = brick_at(p_ix);
        Matter matter = matter_at(b, p_ix);
        float there = b.resident ? 1.0 : 0.0;
        sum += there * matter.extinction * vec4(matter.color * medium.albedo, 1.0);
        emission += there * (matter.extinction * medium.extinction * matter.emission + matter.source);
    }
    float share = 1.0 / float(parts.x * parts.y * parts.z);
    imageStore(i_grid_medium, point, sum * share);
    imageStore(i_grid_emission, point, vec4(emission * share, 1.0));
}
