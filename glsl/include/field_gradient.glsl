// The field's gradient: read from a volume of gradients where there is one, else estimated. Includes reconstruct.glsl first.

#include "gradient.glsl"
#include "ten_bits.glsl"

// Is a volume of gradients there, the estimates at voxels (gradients.comp), and how is it read? 0 no, 1 filtered by the texture unit,
// 2 words of ten bits a component, 3 halves, 4 such words in fours, filtered here (GradientTexels in src/atlas/gradients.rs).
layout(constant_id = SPEC_STORED_GRADIENTS) const uint STORED_GRADIENTS = 0;

layout(set = 0, binding = BINDING_GRADIENTS) uniform sampler3D t_gradients;
layout(set = 0, binding = BINDING_GRADIENTS_TEN_BITS, r32ui) uniform readonly uimageBuffer i_gradients_ten_bits;
layout(set = 0, binding = BINDING_GRADIENTS_IN_FOURS, rgba32ui) uniform readonly uimageBuffer i_gradients_in_fours;
layout(set = 0, binding = BINDING_GRADIENTS_HALVES, rgba16f) uniform readonly imageBuffer i_gradients_halves;

#include "gradient_pages.glsl"

// The gradients of a voxel and of the next one along z. `xy`: what x and y add to the places of their texels. `z`: what their z does.
// `within`: the number of the first among the four of its texel.
vec3[2] gradients_of_column(int xy, ivec2 z, int within) {
    if (STORED_GRADIENTS == 4u) {
        uvec4 texel = imageLoad(i_gradients_in_fours, xy + z.x);
        uvec2 pair = within == 0 ? texel.xy : within == 1 ? texel.yz : texel.zw;
        return vec3[](ten_bits_in(pair.x), ten_bits_in(pair.y));
    }
    if (STORED_GRADIENTS == 3u) {
        return vec3[](imageLoad(i_gradients_halves, xy + z.x).rgb, imageLoad(i_gradients_halves, xy + z.y).rgb);
    }
    uvec2 words = uvec2(imageLoad(i_gradients_ten_bits, xy + z.x).r, imageLoad(i_gradients_ten_bits, xy + z.y).r);
    return vec3[](ten_bits_in(words.x), ten_bits_in(words.y));
}

// The gradients of the voxels around a place, and where between them it is.
struct GradientCell {
    vec3 columns[4][2];
    vec3 f;
};

GradientCell load_gradients(vec3 p_ix) {
    ivec3 i = ivec3(p_ix);
    GradientCell c;
    c.f = p_ix - vec3(i);
    int within = 0;
    ivec3 j = min(i + 1, ivec3(volume.field_ix));
    if (STORED_GRADIENTS == 4u) {
        int texel = third_of(i.z);
        within = i.z - FOURS_APART * texel;
        i.z = texel;
    }
    j = gradient_place(j);
    i = gradient_place(i);
    ivec2 z = ivec2(i.z, j.z);
    [[unroll]] for (int n = 0; n < 4; ++n) {
        c.columns[n] = gradients_of_column(((n & 1) == 0 ? i.x : j.x) + (n < 2 ? i.y : j.y), z, within);
    }
    return c;
}

// In units of `volume.gradient_unit`.
vec3 gradient_between(GradientCell c) {
    precise vec3 slices[2];
    [[unroll]] for (int n = 0; n < 2; ++n) {
        // Not mix(), which may miss the value that both ends have: flat places would have gradients.
        precise vec3 low = c.columns[0][n] + (c.columns[1][n] - c.columns[0][n]) * c.f.x;
        precise vec3 high = c.columns[2][n] + (c.columns[3][n] - c.columns[2][n]) * c.f.x;
        slices[n] = low + (high - low) * c.f.y;
    }
    precise vec3 between = slices[0] + (slices[1] - slices[0]) * c.f.z;
    if (STORED_GRADIENTS != 3u) {
        between *= 1.0 / TEN_BITS_SCALE;
    }
    return between;
}

// Of a gradient per index unit.
vec3 gradient_per_mm(vec3 g) {
    return g.x * volume.gradient_x_ws + g.y * volume.gradient_y_ws + g.z * volume.gradient_z_ws;
}

// In units of texture samples per mm.
vec3 gradient_ws(Brick b, vec3 p_ix) {
    vec3 g;
    switch (STORED_GRADIENTS) {
    case 0u:
        g = estimated_gradient_ix(b, p_ix);
        break;
    case 1u: {
        // The atlas is the volume: a voxel's texel is its index.
        precise vec3 uvw = (p_ix + 0.5) * volume.atlas_texel;
        g = textureLod(t_gradients, uvw, 0.0).rgb * volume.gradient_unit;
        break;
    }
    default:
        g = gradient_between(load_gradients(p_ix)) * volume.gradient_unit;
        break;
    }
    return gradient_per_mm(g);
}

// At two places, by turns, as packed_linear_pair() has it; of gradients that are loaded.
vec3[2] gradient_pair_ws(vec3 first_ix, vec3 second_ix) {
    GradientCell first = load_gradients(first_ix);
    GradientCell second = load_gradients(second_ix);
    return vec3[](
        gradient_per_mm(gradient_between(first) * volume.gradient_unit),
        gradient_per_mm(gradient_between(second) * volume.gradient_unit));
}
