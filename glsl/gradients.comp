#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
// Estimates of the gradient at voxels, for the chunks of 16^3 voxels of a list: one workgroup for 4^3 voxels, or 4^3 fours, of which half have
// nothing to do; 64 for a chunk.

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
layout(set = 0, binding = BINDING_GRADIENTS_IN_FOURS, rgba32ui) uniform writeonly uimageBuffer i_in_fours;
layout(push_constant) uniform Push { PartPush push; };

// Which of them: as for STORED_GRADIENTS.
layout(constant_id = SPEC_STORED_GRADIENTS) const uint STORED_GRADIENTS = 0;

#include "gradient_pages.glsl"

const int CHUNK = 16;

float voxel_at(ivec3 voxel) {
    return PACKED_CELLS == 0u ? atlas_texel(voxel) : packed_texel(voxel);
}

// Without filters, which read eight voxels where one is needed.
vec3 central_differences_at(ivec3 voxel) {
    ivec3 low = max(voxel - 1, ivec3(0));
    ivec3 high = min(voxel + 1, ivec3(volume.field_ix));
    vec3 difference = vec3(
        voxel_at(ivec3(high.x, voxel.yz)) - voxel_at(ivec3(low.x, voxel.yz)),
        voxel_at(ivec3(voxel.x, high.y, voxel.z)) - voxel_at(ivec3(voxel.x, low.y, voxel.z)),
        voxel_at(ivec3(voxel.xy, high.z)) - voxel_at(ivec3(voxel.xy, low.z)));
    return difference / vec3(max(high - low, ivec3(1)));
}

// In units of `volume.gradient_unit`.
vec3 gradient_at(ivec3 voxel) {
    vec3 p_ix = vec3(voxel);
    vec3 g = GRADIENT == 0u ? central_differences_at(voxel) : estimated_gradient_ix(brick_at(p_ix), p_ix);
    return g / volume.gradient_unit;
}

int place_of(ivec3 texel) {
    ivec3 parts = gradient_place(texel);
    return parts.x + parts.y + parts.z;
}

// The fours of a chunk begin in it, so that each belongs to one.
void store_four(ivec3 chunk, ivec3 within) {
    int first = (CHUNK * chunk.z + FOURS_APART - 1) / FOURS_APART + within.z;
    ivec3 voxel = ivec3(CHUNK * chunk.xy + within.xy, FOURS_APART * first);
    if (voxel.z >= CHUNK * (chunk.z + 1) || any(greaterThan(voxel, ivec3(volume.field_ix)))) {
        return;
    }
    uvec4 words;
    for (int n = 0; n < 4; ++n) {
        ivec3 at = min(voxel + ivec3(0, 0, n), ivec3(volume.field_ix));
        words[n] = ten_bits_of(ivec3(round(gradient_at(at))));
    }
    imageStore(i_in_fours, place_of(ivec3(voxel.xy, first)), words);
}

void main() {
    if (gl_WorkGroupID.x >= push.count) {
        return;
    }
    int group = int(gl_WorkGroupID.y);
    ivec3 chunk = chunks[push.first + gl_WorkGroupID.x].xyz;
    ivec3 within = 4 * ivec3(group % 4, group / 4 % 4, group / 16) + ivec3(gl_LocalInvocationID);
    if (STORED_GRADIENTS == 4u) {
        store_four(chunk, within);
        return;
    }
    ivec3 voxel = CHUNK * chunk + within;
    if (any(greaterThan(voxel, ivec3(volume.field_ix)))) {
        return;
    }
    vec3 g = gradient_at(voxel);
    if (STORED_GRADIENTS == 1u) {
        imageStore(i_filtered, voxel, vec4(g, 0.0));
    } else if (STORED_GRADIENTS == 2u) {
        imageStore(i_ten_bits, place_of(voxel), uvec4(ten_bits_of(ivec3(round(g)))));
    } else {
        imageStore(i_halves, place_of(voxel), vec4(g, 0.0));
    }
}
