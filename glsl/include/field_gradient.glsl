// The field's gradient: read from a volume of gradients where there is one, else estimated. Includes reconstruct.glsl first.

#include "gradient.glsl"

// A volume of gradients is there: the estimates at voxels (gradients.comp).
layout(constant_id = SPEC_STORED_GRADIENTS) const bool STORED_GRADIENTS = false;

layout(set = 0, binding = BINDING_GRADIENTS) uniform sampler3D t_gradients;

// In units of texture samples per mm.
vec3 gradient_ws(Brick b, vec3 p_ix) {
    vec3 g;
    if (STORED_GRADIENTS) {
        // The atlas is the volume: a voxel's texel is its index.
        precise vec3 uvw = (p_ix + 0.5) * volume.atlas_texel;
        g = (textureLod(t_gradients, uvw, 0.0).rgb - volume.gradient_zero) * volume.gradient_unit;
    } else {
        g = estimated_gradient_ix(b, p_ix);
    }
    return g.x * volume.gradient_x_ws + g.y * volume.gradient_y_ws + g.z * volume.gradient_z_ws;
}
