// Light that a sample receives: the light volume and Lambert's law. Includes field_gradient.glsl first.

layout(constant_id = SPEC_LIGHT) const bool LIGHT = false;
layout(constant_id = SPEC_DIFFUSE) const bool DIFFUSE = false;

layout(set = 0, binding = BINDING_LIGHT) uniform sampler3D t_light;

// Local ambient occlusion, packed like the atlas.
vec3 light_at(Brick b, vec3 local) {
    vec3 uvw = (b.origin_at + local + 0.5) * volume.atlas_texel;
    return textureLod(t_light, uvw, 0.0).rgb;
}

// ambient + diffuse |n . l|; 1 where there is no gradient and hence no surface.
float lambert(vec3 gradient, vec3 light, float ambient, float diffuse) {
    // Scaled by the largest component first: the square of a gradient in a volume of 1e6 mm spacing underflows.
    float largest = max(abs(gradient.x), max(abs(gradient.y), abs(gradient.z)));
    if (!(largest > 0.0)) {
        return 1.0;
    }
    return ambient + diffuse * abs(dot(normalize(gradient / largest), light));
}

// What light and surface make of a colour; 1 without either. `shown`: false where nothing depends on the answer.
vec3 shading(Brick b, vec3 p_ix, vec3 direction_ws, bool shown) {
    vec3 received = vec3(1.0);
    if (LIGHT) {
        received = light_at(b, brick_local(b, p_ix)) + frame.light_bias;
    }
    if (DIFFUSE) {
        if (shown) {
            vec3 light = frame.light_direction_ws.w > 0.0 ? frame.light_direction_ws.xyz : -direction_ws;
            received *= lambert(gradient_ws(b, p_ix), light, frame.ambient, frame.diffuse);
        }
    }
    return received;
}
