#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
// Sweeps flux from a light through the volume, one layer of points a dispatch (Kajiya and Von Herzen 1984; Max 1995, section VI):
// the optical depth of a point is that of the layer before, where the line to the light meets it, and what lies between.
// One invocation a point.

#include "bindings.glsl"
#include "structs.glsl"
#include "volume.glsl"
#include "reconstruct.glsl"
#include "classify.glsl"
#include "skip.glsl"
#include "labels.glsl"
#include "medium.glsl"
#include "phase.glsl"
#include "lights.glsl"
#include "shadow_ray.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

// Optical depth towards each light, one volume above the other.
layout(set = 0, binding = BINDING_SHADOW_STORE, r32f) uniform image3D i_shadow;
layout(push_constant) uniform Push { SweepPush push; };

float stored(ivec3 point) {
    return imageLoad(i_shadow, point + ivec3(0, 0, int(push.light) * medium.shadow_points.z)).r;
}

// Of the layer before, between its points.
float layer_before(vec3 at) {
    uint u = (push.axis + 1u) % 3u;
    uint v = (push.axis + 2u) % 3u;
    ivec3 p00 = ivec3(floor(at));
    p00[push.axis] = push.previous;
    p00 = clamp(p00, ivec3(0), medium.shadow_points - 1);
    ivec3 p10 = p00;
    ivec3 p01 = p00;
    p10[u] = min(p00[u] + 1, medium.shadow_points[u] - 1);
    p01[v] = min(p00[v] + 1, medium.shadow_points[v] - 1);
    ivec3 p11 = p10;
    p11[v] = p01[v];
    vec2 f = clamp(vec2(at[u] - float(p00[u]), at[v] - float(p00[v])), 0.0, 1.0);
    return mix(mix(stored(p00), stored(p10), f.x), mix(stored(p01), stored(p11), f.x), f.y);
}

void main() {
    ivec3 point;
    point[push.axis] = push.layer;
    point[(push.axis + 1u) % 3u] = int(gl_GlobalInvocationID.x);
    point[(push.axis + 2u) % 3u] = int(gl_GlobalInvocationID.y);
    if (any(greaterThanEqual(point, medium.shadow_points))) {
        return;
    }
    vec3 cells = vec3(medium.shadow_points - 1);
    vec3 p_ix = vec3(point) / cells * volume.field_ix;
    Incident incident = incident_from(push.light, ws_from_ix(p_ix));
    vec3 d_ix = ix_from_direction(incident.towards_ws);
    float reach = min(distance_to_exit(p_ix, d_ix), incident.distance_mm);
    // To the plane of the layer before, along the line; a line that leaves the field on the way, or a first layer, has nothing there.
    float across = float(push.previous - push.layer) / cells[push.axis] * volume.field_ix[push.axis] / d_ix[push.axis];
    bool meets = push.previous != push.layer && across <= reach * (1.0 + 1e-5);
    float length_mm = meets ? across : reach;
    float depth = optical_depth_along(p_ix, d_ix, length_mm);
    if (meets) {
        depth += layer_before((p_ix + d_ix * across) / volume.field_ix * cells);
    }
    imageStore(i_shadow, point + ivec3(0, 0, int(push.light) * medium.shadow_points.z), vec4(depth));
}
