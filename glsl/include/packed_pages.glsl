// The corners of voxel cells side by side in one texel, and where those texels lie.

// 0: there are none. Else the bytes of a sample (src/atlas/packed_cells.rs).
layout(constant_id = SPEC_PACKED_CELLS) const uint PACKED_CELLS = 0;

// A texel holds samples of one slice: 3x .. 3x + 3 of some rows, a row in as many words as a sample has bytes. Of bytes these are rows
// 3y .. 3y + 3, of two bytes rows y and y + 1. Neighbouring texels share samples, so that the corners of every cell in the slice lie
// in one.
const int CELLS_A_ROW = 3;

// Texels of a page, and bits of their number on each axis: z fastest, then x (src/atlas/pages.rs).
const int PACKED_PAGE_TEXELS = 256;
const ivec3 PACKED_PAGE_BITS = ivec3(2, 2, 4);
const ivec3 PACKED_PAGE_BITS_OF_TWO = ivec3(2, 3, 3);  // where samples have two bytes

ivec3 packed_page_bits() {
    if (PACKED_CELLS == 2u) {
        return PACKED_PAGE_BITS_OF_TWO;
    }
    return PACKED_PAGE_BITS;
}

// `strides`: from a row of pages to the next, and from a layer of rows.
int packed_place(ivec3 texel, ivec2 strides) {
    ivec3 bits = packed_page_bits();
    ivec3 page = texel >> bits;
    ivec3 within = texel - (page << bits);
    int number = page.x + page.y * strides.x + page.z * strides.y;
    return number * PACKED_PAGE_TEXELS + (within.z | within.x << bits.z | within.y << (bits.z + bits.x));
}
