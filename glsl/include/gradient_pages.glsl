// Where texels of gradients lie that the shader interpolates: in pages of 8 x 8 x 16 of ten bits a component, or 8 x 8 x 8 of halves, z
// fastest, then x (src/atlas/pages.rs). STORED_GRADIENTS is
// declared, and params.glsl included, first.

// The part of the place of texel (x, y, z) that comes from each; their sum is its place.
ivec3 gradient_place(ivec3 at) {
    ivec2 strides = ivec2(volume.pages.zw);
    if (STORED_GRADIENTS == 3u) {
        strides *= 512;
        return ivec3(
            (at.x & 7) << 3 | (at.x >> 3) << 9, ((at.y & 7) << 6) + (at.y >> 3) * strides.x, (at.z & 7) + (at.z >> 3) * strides.y);
    }
    strides *= 1024;
    return ivec3(
        (at.x & 7) << 4 | (at.x >> 3) << 10, ((at.y & 7) << 7) + (at.y >> 3) * strides.x, (at.z & 15) + (at.z >> 4) * strides.y);
}
