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

float reflected(vec3 gradient, vec3 direction_ws) {
    vec3 light = frame.light_direction_ws.w > 0.0 ? frame.light_direction_ws.xyz : -direction_ws;
    return lambert(gradient, light, frame.ambient, frame.diffuse);
}

// What light and surface make of a colour; 1 without either. `shown`: false where nothing depends on the answer.
vec3 shading(Brick b, vec3 p_ix, vec3 direction_ws, bool shown) {
    vec3 received = vec3(1.0);
    if (LIGHT) {
        received = light_at(b, brick_local(b, p_ix)) + frame.light_bias;
    }
    if (DIFFUSE) {
        if (shown) {
            received *= reflected(gradient_ws(b, p_ix), direction_ws);
        }
    }
    return received;
}

// Of two places at once, without a light volume; gradients are loaded.
float[2] shading_pair(vec3 first_ix, vec3 second_ix, vec3 direction_ws) {
    if (DIFFUSE) {
        vec3 gradients[2] = gradient_pair_ws(first_ix, second_ix);
        return float[](reflected(gradients[0], direction_ws), reflected(gradients[1], direction_ws));
    }
    return float[](1.0, 1.0);
}
