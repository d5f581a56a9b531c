// Cells of the grid of scattered light, and where the solvers of diffusion and of zones keep what they solve for. Includes
// direct.glsl first.

layout(set = 0, binding = BINDING_SOURCE_STORE, rgba32f) uniform image3D i_source;
layout(set = 0, binding = BINDING_FLUENCE_STORE, rgba32f) uniform image3D i_fluence;

// Tiles of the source: power per volume, then of diffusion its first moment along each axis, of zones the light from around.
const int POWER = 0;
const int MOMENT_X = 1;
const int AROUND = 1;

ivec3 tile_texel(int tile, ivec3 point) {
    return ivec3(tile * medium.scatter_points.x, 0, 0) + point;
}

// Unit vector along an axis of the field, world space.
vec3 axis_ws(int axis) {
    return normalize(vec3(medium.ws_from_ix_x[axis], medium.ws_from_ix_y[axis], medium.ws_from_ix_z[axis]));
}

// Distance between points on each axis, mm.
vec3 grid_spacing_mm() {
    vec3 cells = volume.field_ix / grid_cells();
    return vec3(
        cells.x * length(vec3(medium.ws_from_ix_x.x, medium.ws_from_ix_y.x, medium.ws_from_ix_z.x)),
        cells.y * length(vec3(medium.ws_from_ix_x.y, medium.ws_from_ix_y.y, medium.ws_from_ix_z.y)),
        cells.z * length(vec3(medium.ws_from_ix_x.z, medium.ws_from_ix_y.z, medium.ws_from_ix_z.z)));
}

// Widths of a point's cell, mm: half of the spacing on the border.
vec3 cell_mm(ivec3 point) {
    bvec3 border = bvec3(uvec3(equal(point, ivec3(0))) | uvec3(equal(point, medium.scatter_points - 1)));
    return grid_spacing_mm() * mix(vec3(1.0), vec3(0.5), border);
}
