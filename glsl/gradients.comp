#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
// Estimates of the gradient at voxels, for the chunks of 16^3 voxels of a list: one workgroup for 4^3 voxels, 64 for a chunk.

#include "bindings.glsl"
#include "structs.glsl"
#include "volume.glsl"
#include "reconstruct.glsl"
#include "gradient.glsl"
#include "ten_bits.glsl"

layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

layout(set = 0, binding = BINDING_CHUNKS, std430) readonly buffer ChunkList { ivec4 chunks[]; };
layout(set = 0, binding = BINDING_GRADIENTS_STORE, rgba16f) uniform writeonly image3D i_filtered;
layout(set = 0, binding = BINDING_GRADIENTS_HALVES, rgba16f) uniform writeonly imageBuffer i_halves;
layout(set = 0, binding = BINDING_GRADIENTS_TEN_BITS, r32ui) uniform writeonly uimageBuffer i_ten_bits;
layout(push_constant) uniform Push { PartPush push; };

// Which of them: as for STORED_GRADIENTS.
layout(constant_id = SPEC_STORED_GRADIENTS) const uint STORED_GRADIENTS = 0;

#include "gradient_pages.glsl"

const int CHUNK = 16;

// Without filters, which read eight voxels where one is needed.
vec3 central_differences_at(ivec3 voxel) {
    ivec3 low = max(voxel - 1, ivec3(0));
    ivec3 high = min(voxel + 1, ivec3(volume.field_ix));
    vec3 difference = vec3(
        atlas_texel(ivec3(high.x, voxel.yz)) - atlas_texel(ivec3(low.x, voxel.yz)),
        atlas_texel(ivec3(voxel.x, high.y, voxel.z)) - atlas_texel(ivec3(voxel.x, low.y, voxel.z)),
        atlas_texel(ivec3(voxel.xy, high.z)) - atlas_texel(ivec3(voxel.xy, low.z)));
    return difference / vec3(max(high - low, ivec3(1)));
}

void main() {
    if (gl_WorkGroupID.x >= push.count) {
        return;
    }
    int group = int(gl_WorkGroupID.y);
    ivec3 within = 4 * ivec3(group % 4, group / 4 % 4, group / 16) + ivec3(gl_LocalInvocationID);
    ivec3 voxel = CHUNK * chunks[push.first + gl_WorkGroupID.x].xyz + within;
    if (any(greaterThan(voxel, ivec3(volume.field_ix)))) {
        return;
    }
    vec3 p_ix = vec3(voxel);
    vec3 g = GRADIENT == 0u ? central_differences_at(voxel) : estimated_gradient_ix(brick_at(p_ix), p_ix);
    g /= volume.gradient_unit;
    if (STORED_GRADIENTS == 1u) {
        imageStore(i_filtered, voxel, vec4(g, 0.0));
        return;
    }
    ivec3 parts = gradient_place(voxel);
    int place = parts.x + parts.y + parts.z;
    if (STORED_GRADIENTS == 2u) {
        uvec3 bits = uvec3(ivec3(round(g)) + TEN_BITS_ZERO);
        imageStore(i_ten_bits, place, uvec4(bits.x | bits.y << 10 | bits.z << 20));
    } else {
        imageStore(i_halves, place, vec4(g, 0.0));
    }
}
