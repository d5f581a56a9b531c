#version 460
#extension GL_GOOGLE_include_directive : require
// Packs the corners of voxel cells into texels (packed_pages.glsl): one invocation for a texel, two workgroups for a page.

#include "bindings.glsl"
#include "structs.glsl"
#include "packed_pages.glsl"

layout(local_size_x = 128) in;

layout(set = 0, binding = BINDING_ATLAS) uniform sampler3D t_atlas;
layout(set = 0, binding = BINDING_PACKED_CELLS_STORE, rgba32ui) uniform writeonly uimageBuffer i_store;
layout(push_constant) uniform Push { PackPush push; };

// Samples 3x .. 3x + 3 of a row; beyond the last of the atlas that one again, which has weight 0.
uvec4 row_at(int x, int y, int z, ivec3 last) {
    vec4 row;
    for (int i = 0; i <= CELLS_A_ROW; ++i) {
        row[i] = texelFetch(t_atlas, min(ivec3(CELLS_A_ROW * x + i, y, z), last), 0).r;
    }
    float largest = 255.0;
    if (PACKED_CELLS == 2u) {
        largest = 65535.0;
    }
    return uvec4(row * largest + 0.5);
}

uint bytes_of(uvec4 row) {
    return row.x | (row.y << 8) | (row.z << 16) | (row.w << 24);
}

uvec2 words_of(uvec4 row) {
    return row.xz | (row.yw << 16);
}

void main() {
    ivec3 last = textureSize(t_atlas, 0) - 1;
    uint number = push.first + gl_WorkGroupID.x;
    ivec3 page = ivec3(number % push.pages.x, number % push.pages.y / push.pages.x, number / push.pages.y);
    int within = int(128u * gl_WorkGroupID.y + gl_LocalInvocationID.x);
    ivec3 bits = packed_page_bits();
    ivec3 in_page = ivec3(within >> bits.z, within >> (bits.z + bits.x), within) & ((ivec3(1) << bits) - 1);
    ivec3 at = (page << bits) + in_page;
    uvec4 texel;
    if (PACKED_CELLS == 2u) {
        for (int j = 0; j < 2; ++j) {
            uvec2 words = words_of(row_at(at.x, at.y + j, at.z, last));
            texel[2 * j] = words.x;
            texel[2 * j + 1] = words.y;
        }
    } else {
        for (int j = 0; j <= CELLS_A_ROW; ++j) {
            texel[j] = bytes_of(row_at(at.x, CELLS_A_ROW * at.y + j, at.z, last));
        }
    }
    imageStore(i_store, int(number) * PACKED_PAGE_TEXELS + within, texel);
}
