// Beams: the rays of 4x2 pixels, one subgroup of 8. beams.comp finds out for all of a beam's rays together where along them something
// may show, finishes the pixels of beams that show nothing, and lists the others for the march. Includes frame.glsl first.

// Cells between voxels are looked up: a bit of a beam stands for one segment, not for several.
layout(constant_id = SPEC_SHOWN_CELLS) const bool SHOWN_CELLS = false;

const uvec2 BEAM_PX = uvec2(4u, 2u);
const uint BEAM_PIXELS = BEAM_PX.x * BEAM_PX.y;

// An entry of the list: 11 bits of x and 12 of y, in beams from the tile's corner, and of the bits for single segments the first and the
// last four words that have any, 4 bits each; of other bits nobody reads those. (Tiles have up to 8192 pixels on an edge, beams up to 64
// words: src/pass/beams.rs.)
uint beam_listed(uvec2 beam, uint first_word, uint end_word) {
    return beam.x | beam.y << 11 | first_word / 4u << 23 | (end_word - 1u) / 4u << 27;
}

// The march takes lists by rows of so many workgroups of 8 beams; the rows of the largest tile are as many as a dispatch may have.
const uint BEAM_GROUPS_A_ROW = 32u;
const uint BEAMS_A_GROUP = 8u;

// Where what a tile has begins: the march's workgroups on x, y and z, and how long the list of each run of its dispatches is. Each
// stands apart, as runs add to their own at the same time (src/pass/beams.rs).
const uint BEAM_TILE_APART = 16u;

uint beam_tile_at() {
    return push.beam_tile * BEAM_TILE_APART * (1u + RUNS);
}

uint beam_list_length_at(uint run) {
    return beam_tile_at() + BEAM_TILE_APART * (1u + run);
}

// Where the list of a run begins.
uint beam_list_at(uint run) {
    return push.first_listed + run * push.listed_by_run;
}

// Place of the lowest of some bits, by the exponent: CPU drivers have no instruction that finds it for several words.
uint lowest_bit(uint bits) {
    uint lowest = bits & (~bits + 1u);
    return (floatBitsToUint(float(int(lowest))) >> 23 & 0xffu) - 127u;
}

// Where in its beam a pixel lies.
uvec2 pixel_of_beam(uint at) {
    return uvec2(at % BEAM_PX.x, at / BEAM_PX.x);
}

// Place of the beam at `beam` (in beams from the tile's corner) among all.
uint beam_at(uvec2 beam) {
    uint width = (push.tile_end_px.x - push.tile_px.x + BEAM_PX.x - 1u) / BEAM_PX.x;
    return push.first_beam + beam.y * width + beam.x;
}
