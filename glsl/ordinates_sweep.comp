#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
// Propagates the light of every direction bin by one layer of points: from where its direction comes from in the layer before,
// attenuated and added to on the way (short characteristics). Invocations: a point of a layer and a bin.

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

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = BINDING_INTENSITY_STORE, rgba32f) uniform image3D i_intensity;
layout(set = 0, binding = BINDING_SOURCE_STORE, rgba32f) uniform readonly image3D i_source;

uint source_bin(uint bin) {
    return PHASE == 0u ? 0u : bin;
}

void main() {
    uint bin = gl_WorkGroupID.z;
    vec3 d_ws = bin_direction(bin).xyz;
    // In cells of the grid per mm.
    vec3 d = ix_from_direction(d_ws) / volume.field_ix * grid_cells();
    vec3 along = abs(d);
    int axis = along.x >= along.y && along.x >= along.z ? 0 : along.y >= along.z ? 1 : 2;
    int u = (axis + 1) % 3;
    int v = (axis + 2) % 3;
    ivec3 point;
    int last = medium.scatter_points[axis] - 1;
    point[axis] = d[axis] > 0.0 ? int(push.step) : last - int(push.step);
    point[u] = int(gl_GlobalInvocationID.x);
    point[v] = int(gl_GlobalInvocationID.y);
    if (int(push.step) > last || any(greaterThanEqual(point, medium.scatter_points))) {
        return;
    }
    vec3 here = vec3(point);
    // Back to the layer before, or to where the ray enters the field.
    vec3 back_mm = mix(here, grid_cells() - here, lessThan(d, vec3(0.0))) / max(along, vec3(1e-30));
    float to_layer = 1.0 / along[axis];
    float enters = min(back_mm.x, min(back_mm.y, back_mm.z));
    bool outside = push.step == 0u || enters < to_layer * (1.0 - 1e-5);
    float length_mm = outside ? enters : to_layer;
    vec3 from = clamp(here - d * length_mm, vec3(0.0), grid_cells());
    // Between the four points around; of a border those on it.
    ivec3 p00 = min(ivec3(from), medium.scatter_points - 1);
    // Across the layers the nearer one, in either direction.
    p00[axis] = outside ? int(floor(from[axis] + 0.5)) : point[axis] + (d[axis] > 0.0 ? -1 : 1);
    ivec3 p10 = p00;
    ivec3 p01 = p00;
    p10[u] = min(p00[u] + 1, medium.scatter_points[u] - 1);
    p01[v] = min(p00[v] + 1, medium.scatter_points[v] - 1);
    ivec3 p11 = p10;
    p11[v] = p01[v];
    vec2 f = clamp(vec2(from[u] - float(p00[u]), from[v] - float(p00[v])), 0.0, 1.0);
    vec4 weights = vec4((1.0 - f.x) * (1.0 - f.y), f.x * (1.0 - f.y), (1.0 - f.x) * f.y, f.x * f.y);
    uint from_bin = source_bin(bin);
    vec3 behind = vec3(0.0);
    vec3 source = vec3(0.0);
    vec3 extinction = vec3(0.0);
    ivec3 corners[4] = ivec3[4](p00, p10, p01, p11);
    for (int i = 0; i < 4; ++i) {
        behind += weights[i] * imageLoad(i_intensity, bin_texel(bin, corners[i])).rgb;
        source += weights[i] * imageLoad(i_source, bin_texel(from_bin, corners[i])).rgb;
        extinction += weights[i] * grid_extinction(corners[i]);
    }
    behind = outside ? environment_radiance(-d_ws) : behind;
    vec3 depths = 0.5 * (extinction + grid_extinction(point)) * length_mm;
    source = 0.5 * (source + imageLoad(i_source, bin_texel(from_bin, point)).rgb) * length_mm;
    vec3 lost = vec3(opacity_of(depths.r), opacity_of(depths.g), opacity_of(depths.b));
    vec3 leaving = mix(lost / depths, vec3(1.0), lessThan(depths, vec3(1e-6)));
    imageStore(i_intensity, bin_texel(bin, point), vec4(behind * (1.0 - lost) + source * leaving, 1.0));
}
