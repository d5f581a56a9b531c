// Which pixel an invocation draws. Includes deal.glsl first.

// Subgroups of 8 draw 4x2 pixels and those of 32 draw 8x4, instead of rows: the nearer the rays of a subgroup, the more often they
// do the same.
uvec2 lane_pixel_in(uvec2 group) {
    uint at = gl_LocalInvocationIndex;
    return 8u * group + uvec2((at & 3u) | (at >> 1 & 4u), (at >> 2 & 1u) | (at >> 3 & 6u));
}

uvec2 lane_pixel() {
    return lane_pixel_in(uvec2(gl_WorkGroupID.x, dealt(gl_WorkGroupID.y, gl_NumWorkGroups.y)));
}
