#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
// The zonal method (Hottel and Sarofim 1967; Max 1995, section VII A): the fluence of every zone from what all others scatter, isotropically,
// attenuated on the way. One invocation a zone.

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
#include "diffuse.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

// By iteration: largest change of the fluence, largest fluence (bits of floats that are not negative).
layout(set = 0, binding = BINDING_RESIDUAL) buffer Residual { uvec2 residual[]; };

// Samples between two zones. (Few and fixed: CPU drivers bound the rounds of all loops of an invocation.)
const int BETWEEN = 8;

// Mean extinction between two places of the grid.
vec3 mean_extinction(vec3 from, vec3 to) {
    vec3 sum = vec3(0.0);
    [[unroll]] for (int i = 0; i < BETWEEN; ++i) {
        vec3 at = mix(from, to, (float(i) + 0.5) / float(BETWEEN));
        sum += grid_extinction(ivec3(clamp(floor(at + 0.5), vec3(0.0), grid_cells())));
    }
    return sum / float(BETWEEN);
}

// From around the volume, nothing scattered on the way.
vec3 fluence_around(ivec3 point) {
    vec3 p_ix = grid_position(point);
    vec3 sum = vec3(0.0);
    for (uint bin = 0u; bin < push.bins; ++bin) {
        vec4 direction = bin_direction(bin);
        vec3 d_ix = ix_from_direction(-direction.xyz);
        float length_mm = distance_to_exit(p_ix, d_ix);
        vec3 border = (p_ix + d_ix * length_mm) / volume.field_ix * grid_cells();
        sum += environment_radiance(-direction.xyz) * exp(-mean_extinction(vec3(point), border) * length_mm) * direction.w;
    }
    return sum;
}

void main() {
    ivec3 points = medium.scatter_points;
    int zone = int((gl_WorkGroupID.x * 8u + gl_LocalInvocationID.y) * 8u + gl_LocalInvocationID.x);
    int zones = points.x * points.y * points.z;
    if (zone >= zones) {
        return;
    }
    ivec3 point = ivec3(zone % points.x, zone / points.x % points.y, zone / (points.x * points.y));
    if (has(FIRST)) {
        vec3 around = ENVIRONMENT == 0u ? vec3(0.0) : fluence_around(point);
        imageStore(i_source, tile_texel(AROUND, point), vec4(around, 1.0));
        imageStore(i_fluence, tile_texel(0, point), vec4(around, 1.0));
        return;
    }
    int old = int(push.step & 1u);
    vec3 spacing = grid_spacing_mm();
    vec3 sum = imageLoad(i_source, tile_texel(AROUND, point)).rgb;
    for (int other = 0; other < zones; ++other) {
        ivec3 there = ivec3(other % points.x, other / points.x % points.y, other / (points.x * points.y));
        vec3 width = cell_mm(there);
        float volume_mm3 = width.x * width.y * width.z;
        vec3 power = imageLoad(i_source, tile_texel(POWER, there)).rgb
            + grid_scattering(there) * imageLoad(i_fluence, tile_texel(old, there)).rgb;
        vec3 apart_mm = vec3(there - point) * spacing;
        float square = dot(apart_mm, apart_mm);
        if (other == zone) {
            // From within a sphere of the same volume.
            float radius = pow(3.0 * volume_mm3 / (4.0 * PI), 1.0 / 3.0);
            vec3 depths = grid_extinction(there) * radius;
            vec3 lost = vec3(opacity_of(depths.r), opacity_of(depths.g), opacity_of(depths.b));
            sum += power * radius * mix(lost / depths, vec3(1.0), lessThan(depths, vec3(1e-6)));
        } else {
            vec3 depths = mean_extinction(vec3(point), vec3(there)) * sqrt(square);
            sum += power * exp(-depths) * (volume_mm3 * PER_SPHERE / square);
        }
    }
    vec3 change = abs(sum - imageLoad(i_fluence, tile_texel(old, point)).rgb);
    imageStore(i_fluence, tile_texel(1 - old, point), vec4(sum, 1.0));
    atomicMax(residual[push.step].x, floatBitsToUint(max(change.r, max(change.g, change.b))));
    atomicMax(residual[push.step].y, floatBitsToUint(max(sum.r, max(sum.g, sum.b))));
}
