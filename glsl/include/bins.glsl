// Direction bins of the discrete ordinates (Max 1995, section VII D). Includes scatter_grid.glsl first.

// Row 0: the direction in which a bin's light travels, world space, and its solid angle.
layout(set = 0, binding = BINDING_BINS) uniform sampler2D t_bins;

vec4 bin_direction(uint bin) {
    return texelFetch(t_bins, ivec2(int(bin), 0), 0);
}

// Where a bin's value at a point lies: bins are tiles of the same image.
ivec3 bin_texel(uint bin, ivec3 point) {
    ivec2 tile = ivec2(int(bin % push.columns), int(bin / push.columns));
    return ivec3(tile * medium.scatter_points.xy, 0) + point;
}
