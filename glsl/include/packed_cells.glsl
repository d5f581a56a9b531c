// The corners of voxel cells side by side in one texel: drivers that filter on the processor load them faster than they filter.

// 0: there are none. Else the bytes of a sample (src/atlas/packed_cells.rs).
layout(constant_id = SPEC_PACKED_CELLS) const uint PACKED_CELLS = 0;

layout(set = 0, binding = BINDING_PACKED_CELLS, rgba32ui) uniform readonly uimage3D i_packed_cells;

// A texel holds samples of one slice: 3x .. 3x + 3 of some rows, a row in as many words as a sample has bytes. Of bytes these are rows
// 3y .. 3y + 3, of two bytes rows y and y + 1. Neighbouring texels share samples, so that the corners of every cell in the slice lie
// in one.
const int CELLS_A_ROW = 3;

// Index / 3, of indices below 49152. (Division of integers is slow.)
int third_of(int index) {
    return (index * 43691) >> 17;
}

// The four corners of a cell in one slice, as pairs along x: low ends of rows y and y + 1, then high ends. As whole numbers: scaled
// once they are interpolated, a sample of llvmpipe's takes 0.92 of the time (of 512 x 512 x 512 voxels 0.82).
vec4 corners_in(uvec4 texel, ivec2 cell) {
    if (PACKED_CELLS == 2u) {
        uvec2 first = texel.xz;
        uvec2 last = texel.yw;
        uvec2 pair = cell.x == 0 ? first : cell.x == 1 ? (first >> 16) | (last << 16) : last;
        return vec4(pair & 0xffffu, pair >> 16);
    }
    uvec2 rows = cell.y == 0 ? texel.xy : cell.y == 1 ? texel.yz : texel.zw;
    uvec2 pair = rows >> uint(8 * cell.x);
    return vec4(pair & 0xffu, (pair >> 8) & 0xffu);
}

// The trilinear field at a place of the atlas, in texels of it from the middle of its first.
float packed_linear(vec3 at) {
    ivec3 i = ivec3(at);
    vec3 f = at - vec3(i);
    ivec2 texel = ivec2(third_of(i.x), i.y);
    ivec2 cell = ivec2(i.x - CELLS_A_ROW * texel.x, 0);
    if (PACKED_CELLS == 1u) {
        texel.y = third_of(i.y);
        cell.y = i.y - CELLS_A_ROW * texel.y;
    }
    vec4 near = corners_in(imageLoad(i_packed_cells, ivec3(texel, i.z)), cell);
    vec4 far = corners_in(imageLoad(i_packed_cells, ivec3(texel, i.z + 1)), cell);
    // Not mix(), which may miss the value that both ends have: flat places would have gradients.
    vec4 low = vec4(near.xy, far.xy);
    vec4 high = vec4(near.zw, far.zw);
    precise vec4 rows = low + (high - low) * f.x;
    precise vec2 slices = rows.xz + (rows.yw - rows.xz) * f.y;
    precise float value = slices.x + (slices.y - slices.x) * f.z;
    float largest = 255.0;
    if (PACKED_CELLS == 2u) {
        largest = 65535.0;
    }
    return value * (1.0 / largest);
}
