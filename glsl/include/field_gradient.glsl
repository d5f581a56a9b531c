// The field's gradient: read from a volume of gradients where there is one, else estimated. Includes reconstruct.glsl first.

#include "gradient.glsl"
#include "ten_bits.glsl"

// Is a volume of gradients there, the estimates at voxels (gradients.comp), and how is it read? 0 no, 1 filtered by the texture unit,
// 2 texels of ten bits, 3 halves, filtered here (GradientTexels in src/atlas/gradients.rs).
layout(constant_id = SPEC_STORED_GRADIENTS) const uint STORED_GRADIENTS = 0;

layout(set = 0, binding = BINDING_GRADIENTS) uniform sampler3D t_gradients;
layout(set = 0, binding = BINDING_GRADIENTS_TEN_BITS, r32ui) uniform readonly uimageBuffer i_gradients_ten_bits;
layout(set = 0, binding = BINDING_GRADIENTS_HALVES, rgba16f) uniform readonly imageBuffer i_gradients_halves;

#include "gradient_pages.glsl"

// What a texel counts, in units of `volume.gradient_unit`.
vec3 gradient_texel(int at) {
    if (STORED_GRADIENTS == 3u) {
        return imageLoad(i_gradients_halves, at).rgb;
    }
    uint texel = imageLoad(i_gradients_ten_bits, at).r;
    return vec3(ivec3(texel & 1023u, texel >> 10 & 1023u, texel >> 20 & 1023u) - TEN_BITS_ZERO);
}

vec3 gradient_between(vec3 p_ix) {
    ivec3 i = ivec3(p_ix);
    precise vec3 f = p_ix - vec3(i);
    ivec3 j = gradient_place(min(i + 1, ivec3(volume.field_ix)));
    i = gradient_place(i);
    precise vec3 rows[4];
    [[unroll]] for (int n = 0; n < 4; ++n) {
        int yz = ((n & 1) == 0 ? i.y : j.y) + (n < 2 ? i.z : j.z);
        vec3 low = gradient_texel(i.x + yz);
        // Not mix(), which may miss the value that both ends have: flat places would have gradients.
        rows[n] = low + (gradient_texel(j.x + yz) - low) * f.x;
    }
    precise vec3 low = rows[0] + (rows[1] - rows[0]) * f.y;
    precise vec3 high = rows[2] + (rows[3] - rows[2]) * f.y;
    precise vec3 between = low + (high - low) * f.z;
    return between;
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
        g = gradient_between(p_ix) * volume.gradient_unit;
        break;
    }
    return g.x * volume.gradient_x_ws + g.y * volume.gradient_y_ws + g.z * volume.gradient_z_ws;
}
