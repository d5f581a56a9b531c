// The field from packed corners of voxel cells: drivers that filter on the processor load them faster than they filter. Includes
// params.glsl first.

#include "packed_pages.glsl"

layout(set = 0, binding = BINDING_PACKED_CELLS, rgba32ui) uniform readonly uimageBuffer i_packed_cells;

// Index / 3, of indices below 32768. (Division of integers is slow.)
int third_of(int index) {
    return (index * 21846) >> 16;
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

// What packed whole numbers count.
float packed_unit() {
    float largest = 255.0;
    if (PACKED_CELLS == 2u) {
        largest = 65535.0;
    }
    return 1.0 / largest;
}

// The cell around a place: where its two texels lie, which four corners of each it has, and where between them the place is.
struct PackedCell {
    int near;
    int far;
    ivec2 cell;
    vec3 f;
};

struct CellTexels {
    uvec4 near;
    uvec4 far;
};

// `at`: in texels of the atlas from the middle of its first.
PackedCell packed_cell(vec3 at) {
    ivec3 i = ivec3(at);
    ivec3 texel = ivec3(third_of(i.x), i.yz);
    PackedCell c;
    c.f = at - vec3(i);
    c.cell = ivec2(i.x - CELLS_A_ROW * texel.x, 0);
    if (PACKED_CELLS == 1u) {
        texel.y = third_of(i.y);
        c.cell.y = i.y - CELLS_A_ROW * texel.y;
    }
    c.near = packed_place(texel, ivec2(volume.pages.xy));
    // The next slice is the next texel, or in the next page.
    int last_z = (1 << packed_page_bits().z) - 1;
    int layer = int(volume.pages.y) * PACKED_PAGE_TEXELS;
    c.far = c.near + ((texel.z & last_z) == last_z ? layer - last_z : 1);
    return c;
}

CellTexels load_cell(PackedCell c) {
    return CellTexels(imageLoad(i_packed_cells, c.near), imageLoad(i_packed_cells, c.far));
}

float packed_between(PackedCell c, CellTexels texels) {
    vec4 near = corners_in(texels.near, c.cell);
    vec4 far = corners_in(texels.far, c.cell);
    // Not mix(), which may miss the value that both ends have: flat places would have gradients.
    vec4 low = vec4(near.xy, far.xy);
    vec4 high = vec4(near.zw, far.zw);
    precise vec4 rows = low + (high - low) * c.f.x;
    precise vec2 slices = rows.xz + (rows.yw - rows.xz) * c.f.y;
    precise float value = slices.x + (slices.y - slices.x) * c.f.z;
    return value * packed_unit();
}

// The sample of a texel of the atlas.
float packed_texel(ivec3 at) {
    PackedCell c = packed_cell(vec3(at));
    return corners_in(imageLoad(i_packed_cells, c.near), c.cell).x * packed_unit();
}

// The trilinear field at a place of the atlas.
float packed_linear(vec3 at) {
    PackedCell c = packed_cell(at);
    return packed_between(c, load_cell(c));
}

// At two places, by turns: a sample is a long chain of steps that wait for each other, and processors look no farther ahead than
// about half of one.
vec2 packed_linear_pair(vec3 first_at, vec3 second_at) {
    PackedCell first = packed_cell(first_at);
    PackedCell second = packed_cell(second_at);
    CellTexels first_texels = load_cell(first);
    CellTexels second_texels = load_cell(second);
    return vec2(packed_between(first, first_texels), packed_between(second, second_texels));
}
