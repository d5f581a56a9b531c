// Colours that the data itself has, in place of the transfer function's. Includes reconstruct.glsl first.

layout(constant_id = SPEC_DATA_COLOR) const bool DATA_COLOR = false;

// Bricks lie as in the atlas. The texture unit decodes display colours before it filters them.
layout(set = 0, binding = BINDING_COLOR) uniform sampler3D t_color;

// The data's colour at a position inside a brick; trilinear but for nearest reconstruction, as the light is.
void apply_data_color(Brick b, vec3 p_ix, inout vec3 color) {
    if (DATA_COLOR) {
        vec3 local = brick_local(b, p_ix);
        local = INTERPOLATION == 0u ? floor(local + 0.5) : local;
        precise vec3 uvw = (b.origin_at + local + 0.5) * volume.atlas_texel;
        color = textureLod(t_color, uvw, 0.0).rgb;
    }
}
