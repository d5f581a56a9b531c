// Diffusion of light: spherical harmonics of order one (Max 1995, section VII C). Includes diffuse.glsl first.

// Between two points: 1 / (3 (extinction - mean cosine * scattering)), bounded where next to nothing is.
vec3 diffusion_between(ivec3 a, ivec3 b) {
    vec3 transport_a = grid_extinction(a) - push.mean_cosine * grid_scattering(a);
    vec3 transport_b = grid_extinction(b) - push.mean_cosine * grid_scattering(b);
    vec3 size = grid_spacing_mm() * grid_cells();
    // Light crosses a void in a straight line, which diffusion does not know: it takes the volume for one free path long.
    float least = 1.0 / max(size.x, max(size.y, size.z));
    return 1.0 / (3.0 * max(0.5 * (transport_a + transport_b), vec3(least)));
}

// Flux from `a` to `b`, its neighbour along `axis`.
vec3 flux_between(ivec3 a, ivec3 b, int axis, float spacing_mm) {
    vec3 d = diffusion_between(a, b);
    float towards = float(b[axis] - a[axis]);
    vec3 moment = 0.5 * (imageLoad(i_source, tile_texel(MOMENT_X + axis, a)).rgb + imageLoad(i_source, tile_texel(MOMENT_X + axis, b)).rgb);
    return d * ((imageLoad(i_fluence, a).rgb - imageLoad(i_fluence, b).rgb) / spacing_mm + 3.0 * towards * moment);
}
