// Surfaces whose strength is the gradient's, lit by one light (Max 1995, eq. 11 and after). Includes field_gradient.glsl and
// phase.glsl first.

// 0 particles, 1 Lambert, 2 Phong, 3 Blinn-Phong, 4 Cook-Torrance.
layout(constant_id = SPEC_REFLECTANCE) const uint REFLECTANCE = 0;

const float FRESNEL_NORMAL = 0.04;

// Weight of a highlight against Lambert's cosine. All unit vectors; `normal` faces the light.
float highlight(vec3 normal, vec3 light, vec3 eye) {
    float n_l = dot(normal, light);
    float n_v = max(dot(normal, eye), 1e-4);
    vec3 middle = normalize(light + eye + vec3(1e-12));
    float n_h = max(dot(normal, middle), 0.0);
    float v_h = max(dot(eye, middle), 1e-4);
    switch (REFLECTANCE) {
    case 2u: return pow(max(dot(reflect(-light, normal), eye), 0.0), medium.surface.z);
    case 3u: return pow(n_h, medium.surface.z);
    case 4u: {
        float square = max(n_h * n_h, 1e-6);
        float slope = medium.surface.w * medium.surface.w;
        float facets = exp((square - 1.0) / (square * slope)) / (PI * slope * square * square);
        float masking = min(1.0, 2.0 * n_h * min(n_v, max(n_l, 0.0)) / v_h);
        float fresnel = FRESNEL_NORMAL + (1.0 - FRESNEL_NORMAL) * pow(1.0 - v_h, 5.0);
        return facets * masking * fresnel / (4.0 * n_v);
    }
    default: return 0.0;
    }
}

// Reflected share per mm of light from a direction. `opacity`: over the unit distance.
vec3 surface_reflectance(vec3 gradient, vec3 color, float opacity, vec3 light, vec3 eye) {
    float magnitude = length(gradient);
    if (!(magnitude > 0.0)) {
        return vec3(0.0);
    }
    // Out of what is denser; a rescale that falls turns the texture samples around.
    vec3 normal = gradient * (-sign(medium.surface.x) / magnitude);
    float n_l = dot(normal, light);
    vec3 reflected = color * n_l + medium.surface.y * highlight(normal, light, eye);
    return n_l > 0.0 ? abs(medium.surface.x) * magnitude * opacity * reflected : vec3(0.0);
}
