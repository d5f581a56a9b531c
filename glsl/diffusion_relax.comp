#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
// Half a step of successive over-relaxation, for points of one colour of a chessboard: the fluence at which as much light flows into
// each cell as is lost there. Marshak's condition on the border. One invocation a point.

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

// By iteration: largest change of the fluence, largest fluence (bits of floats that are not negative).
layout(set = 0, binding = BINDING_RESIDUAL) buffer Residual { uvec2 residual[]; };

void main() {
    ivec3 point = ivec3(gl_GlobalInvocationID);
    bool inside = all(lessThan(point, medium.scatter_points));
    if (!inside || ((point.x + point.y + point.z) & 1) != int(push.columns)) {
        return;
    }
    vec3 spacing = grid_spacing_mm();
    vec3 width = cell_mm(point);
    float volume_mm3 = width.x * width.y * width.z;
    vec3 before = imageLoad(i_fluence, point).rgb;
    vec3 absorption = max(grid_extinction(point) - grid_scattering(point), vec3(0.0));
    vec3 gain = imageLoad(i_source, tile_texel(POWER, point)).rgb * volume_mm3;
    vec3 loss = absorption * volume_mm3;
    for (int face = 0; face < 6; ++face) {
        int axis = face / 2;
        int side = (face & 1) * 2 - 1;
        float area = volume_mm3 / width[axis];
        ivec3 next = point;
        next[axis] += side;
        if (next[axis] < 0 || next[axis] >= medium.scatter_points[axis]) {
            loss += 0.5 * area;
            gain += 2.0 * PI * area * environment_radiance(float(side) * axis_ws(axis));
        } else {
            vec3 exchange = diffusion_between(point, next) * (area / spacing[axis]);
            loss += exchange;
            // What flows out besides what this point's own fluence drives.
            gain += exchange * before - flux_between(point, next, axis, spacing[axis]) * area;
        }
    }
    vec3 after = max(before + push.over_relaxation * (gain / loss - before), vec3(0.0));
    imageStore(i_fluence, point, vec4(after, 1.0));
    vec3 change = abs(after - before);
    atomicMax(residual[push.step].x, floatBitsToUint(max(change.r, max(change.g, change.b))));
    atomicMax(residual[push.step].y, floatBitsToUint(max(after.r, max(after.g, after.b))));
}
