#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
// The bench's limit for light: as many samples for each sample of the light volume as a ray has parts, each one texture read
// and one look-up of the transfer function.

#include "bindings.glsl"
#include "structs.glsl"
#include "deal.glsl"
#include "volume.glsl"
#include "classify.glsl"
#include "light_work.glsl"
#include "packed_cells.glsl"

layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

layout(set = 0, binding = BINDING_VOXELS) uniform sampler3D t_voxels;
layout(set = 0, binding = BINDING_LIGHT_STORE, rgba16f) uniform writeonly image3D i_light;
layout(push_constant) uniform Push { LightPush push; };

void main() {
    if (gl_WorkGroupID.x >= push.count) {
        return;
    }
    uvec4 entry = work[push.first + dealt(gl_WorkGroupID.x, push.count)];
    if (!has_sample(entry, gl_LocalInvocationIndex)) {
        return;
    }
    LightSample s = light_sample(entry, listed_sample(entry, gl_LocalInvocationIndex));
    uint parts = uint(push.parts);
    vec3 step_ix = push.direction_ix * ((push.radius_mm - push.offset_mm) / push.parts);
    // Where the first sample is and how far the next, for the read that there is.
    vec3 first_ix = vec3(s.sample_at) + push.direction_ix * push.offset_mm + 0.5 * step_ix;
    vec3 at = first_ix;
    vec3 ahead = step_ix;
    if (PACKED_CELLS == 0u) {
        at = (first_ix + 0.5) * volume.atlas_texel;
        ahead = step_ix * volume.atlas_texel;
    }
    vec3 last_at = 1.0 / volume.atlas_texel - 1.0;
    float sum = 0.0;
    if (PACKED_CELLS == 0u) {
        for (uint m = 0u; m < parts; ++m) {
            sum += classify_light(textureLod(t_voxels, at + float(m) * ahead, 0.0).r, 1.0).opacity;
        }
    } else {
        // Two by two, as rays of light whose samples are evenly apart take them.
        for (uint m = 0u; m < parts; m += 2u) {
            vec3 first_at = clamp(at + float(m) * ahead, vec3(0.0), last_at);
            vec3 second_at = clamp(at + float(m + 1u) * ahead, vec3(0.0), last_at);
            vec2 values = packed_linear_pair(first_at, second_at);
            sum += classify_light(values.x, 1.0).opacity;
            float second = classify_light(values.y, 1.0).opacity;
            sum += m + 1u < parts ? second : 0.0;
        }
    }
    // Lanes beyond the last sample of a brick work like the others, and may not write outside.
    imageStore(i_light, min(s.sample_at, imageSize(i_light) - 1), vec4(sum));
}
