// Where something may show: a bit for every cell between voxels, which tells of the next ones along all axes as well
// (src/volume/shown_cells.rs). Includes volume.glsl first.

layout(set = 0, binding = BINDING_SHOWN_CELLS, rgba32ui) uniform readonly uimageBuffer i_shown_cells;

const int SKIP_CELL_BITS = 2;

// Cells between voxels that the bits of a skip cell tell of.
const ivec3 REACH = ivec3(6, 5, 4);

// Skip cells that are looked up for a box, at most: larger ones are not worth it, and rounds of loops are counted (check_rounds, draw.rs).
const int MOST_CELLS = 16;

// The bits of cells first .. last within the reach of a skip cell.
uvec4 bits_between(ivec3 first, ivec3 last) {
    uvec3 along = (uvec3(2u) << uvec3(last)) - (uvec3(1u) << uvec3(first));
    const uint ROWS = 0x01041041u;
    uint rows = (ROWS << uint(6 * first.y)) & (ROWS >> uint(24 - 6 * last.y));
    uint slice = along.x * rows;
    uvec4 slices = uvec4(along.z, along.z >> 1, along.z >> 2, along.z >> 3) & 1u;
    return slice & (~slices + 1u);
}

// What boxes are looked up by: copies of parameters, which llvmpipe loads again wherever a block is named.
struct ShownGrid {
    vec3 field_ix;
    ivec3 last_cell;
    ivec2 strides;  // from a row of skip cells to the next, and from a layer
};

ShownGrid shown_grid() {
    ivec3 extent = volume.skip_extent;
    return ShownGrid(volume.field_ix, ivec3(volume.field_ix) - 1, ivec2(extent.x, extent.x * extent.y));
}

// Whether something may show in a box between two corners; true of large boxes.
bool may_show(ShownGrid grid, vec3 a_ix, vec3 b_ix) {
    ivec3 low = min(ivec3(clamp(min(a_ix, b_ix), vec3(0.0), grid.field_ix)), grid.last_cell);
    // Bits tell of the last cells of the box as well.
    ivec3 high = max(low, min(ivec3(clamp(max(a_ix, b_ix), vec3(0.0), grid.field_ix)), grid.last_cell) - 1);
    ivec3 first = low >> SKIP_CELL_BITS;
    // The first one that reaches the last cell.
    ivec3 last = max(first, (high - (REACH - SKIP_CELLS)) >> SKIP_CELL_BITS);
    ivec3 cell = first;
    ivec3 cells = last - first + 1;
    bool found = cells.x * cells.y * cells.z > MOST_CELLS;
    bool more;
    do {
        ivec3 origin = cell << SKIP_CELL_BITS;
        uvec4 asked = bits_between(max(low - origin, 0), min(high - origin, REACH - 1));
        uvec4 bits = imageLoad(i_shown_cells, cell.x + cell.y * grid.strides.x + cell.z * grid.strides.y) & asked;
        found = found || (bits.x | bits.y | bits.z | bits.w) != 0u;
        more = !found && cell != last;
        bool next_y = cell.x == last.x;
        bool next_z = next_y && cell.y == last.y;
        ivec3 next = ivec3(
            next_y ? first.x : cell.x + 1,
            next_z ? first.y : next_y ? cell.y + 1 : cell.y,
            next_z ? cell.z + 1 : cell.z
        );
        cell = more ? next : cell;
    } while (more);
    return found;
}
