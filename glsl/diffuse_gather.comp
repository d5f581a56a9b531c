#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
// What every point scatters towards the eye of a fluence that is known with its flux (diffusion) or alone (zones). One invocation a
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
#include "diffusion.glsl"

layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

layout(set = 0, binding = BINDING_SCATTERED_STORE, rgba32f) uniform writeonly image3D i_scattered;

void main() {
    ivec3 point = ivec3(gl_GlobalInvocationID);
    if (any(greaterThanEqual(point, medium.scatter_points))) {
        return;
    }
    vec3 p_ws = ws_from_ix(grid_position(point));
    vec3 apart = push.eye.xyz - p_ws;
    vec3 to_eye = push.eye.w > 0.0 ? apart * inversesqrt(max(dot(apart, apart), 1e-30)) : push.eye.xyz;
    vec3 fluence = imageLoad(i_fluence, tile_texel(int(push.columns), point)).rgb;
    vec3 towards = vec3(0.0);
    if (push.mean_cosine != 0.0) {
        vec3 spacing = grid_spacing_mm();
        for (int axis = 0; axis < 3; ++axis) {
            ivec3 low = point;
            ivec3 high = point;
            low[axis] = max(point[axis] - 1, 0);
            high[axis] = min(point[axis] + 1, medium.scatter_points[axis] - 1);
            vec3 flux = vec3(0.0);
            float sides = 0.0;
            if (low[axis] < point[axis]) {
                flux += flux_between(low, point, axis, spacing[axis]);
                sides += 1.0;
            }
            if (high[axis] > point[axis]) {
                flux += flux_between(point, high, axis, spacing[axis]);
                sides += 1.0;
            }
            towards += flux / sides * dot(axis_ws(axis), to_eye);
        }
    }
    vec3 scattered = (fluence + 3.0 * push.mean_cosine * towards) * PER_SPHERE;
    imageStore(i_scattered, point, vec4(max(scattered, vec3(0.0)), 1.0));
}
