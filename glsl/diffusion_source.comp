#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
// What the lights scatter for the first time and what is emitted, with its first moment: the source of diffusion. One invocation a
// point.

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
#include "direct.glsl"
#include "diffuse.glsl"

layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

void main() {
    ivec3 point = ivec3(gl_GlobalInvocationID);
    if (any(greaterThanEqual(point, medium.scatter_points))) {
        return;
    }
    vec3 p_ix = grid_position(point);
    vec3 power = vec3(0.0);
    vec3 moments[3] = vec3[3](vec3(0.0), vec3(0.0), vec3(0.0));
    for (uint light = 0u; light < medium.light_count; ++light) {
        Incident incident = incident_from(light, ws_from_ix(p_ix));
        vec3 arriving = incident.irradiance * swept_through(light, p_ix);
        power += arriving;
        for (int axis = 0; axis < 3; ++axis) {
            moments[axis] -= push.mean_cosine * arriving * dot(incident.towards_ws, axis_ws(axis));
        }
    }
    vec3 scattering = grid_scattering(point);
    power = scattering * power + 4.0 * PI * grid_emission(point);
    imageStore(i_source, tile_texel(POWER, point), vec4(power, 1.0));
    for (int axis = 0; axis < 3; ++axis) {
        imageStore(i_source, tile_texel(MOMENT_X + axis, point), vec4(scattering * moments[axis], 1.0));
    }
    imageStore(i_fluence, point, vec4(0.0));
}
