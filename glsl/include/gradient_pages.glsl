// Where texels of gradients lie that the shader interpolates: in pages of 8 x 8 x 16 words of ten bits a component, of 8 x 8 x 4 fours
// of those, or of 8 x 8 x 8 of halves, z fastest, then x (src/atlas/pages.rs). STORED_GRADIENTS is declared, and params.glsl included,
// first.
//
// Fours lie along z and share their ends: texel z holds the gradients of voxels 3z .. 3z + 3.
const int FOURS_APART = 3;

// The part of the place of texel (x, y, z) that comes from each; their sum is its place.
ivec3 gradient_place(ivec3 at) {
    int z_bits = 4;
    if (STORED_GRADIENTS == 3u) {
        z_bits = 3;
    }
    if (STORED_GRADIENTS == 4u) {
        z_bits = 2;
    }
    ivec2 strides = ivec2(volume.pages.zw) << (z_bits + 6);
    return ivec3(
        (at.x & 7) << z_bits | (at.x >> 3) << (z_bits + 6),
        ((at.y & 7) << (z_bits + 3)) + (at.y >> 3) * strides.x,
        (at.z & ((1 << z_bits) - 1)) + (at.z >> z_bits) * strides.y);
}
