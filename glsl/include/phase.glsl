// Phase functions, 1/sr (src/scene/phase.rs). `cosine`: between the directions in which light travels before and after.

// 0 isotropic, 1 Henyey-Greenstein, 2 two of its lobes, 3 Rayleigh, 4 Schlick, 5 Lambert's spheres, 6 a table over the cosine.
layout(constant_id = SPEC_PHASE) const uint PHASE = 0;

// Equal-probability cosines in row 0, values at equal steps of the cosine in row 1.
layout(set = 0, binding = BINDING_PHASE) uniform sampler2D t_phase;

const float PI = 3.14159265359;
const float PER_SPHERE = 0.0795774715459;

float henyey_greenstein(float g, float cosine) {
    float d = 1.0 + g * g - 2.0 * g * cosine;
    return PER_SPHERE * (1.0 - g * g) / (d * sqrt(d));
}

float tabulated_phase(float cosine) {
    float last = float(textureSize(t_phase, 0).x - 1);
    float x = clamp(0.5 * (cosine + 1.0), 0.0, 1.0) * last;
    float below = min(floor(x), last - 1.0);
    float a = texelFetch(t_phase, ivec2(int(below), 1), 0).r;
    float b = texelFetch(t_phase, ivec2(int(below) + 1, 1), 0).r;
    return mix(a, b, x - below);
}

float phase_function(vec4 parameters, float cosine) {
    switch (PHASE) {
    case 1u: return henyey_greenstein(parameters.x, cosine);
    case 2u: return mix(henyey_greenstein(parameters.y, cosine), henyey_greenstein(parameters.x, cosine), parameters.z);
    case 3u: return PER_SPHERE * 0.75 * (1.0 + cosine * cosine);
    case 4u: {
        float d = 1.0 - parameters.x * cosine;
        return PER_SPHERE * (1.0 - parameters.x * parameters.x) / (d * d);
    }
    case 5u: {
        float c = clamp(-cosine, -1.0, 1.0);
        return PER_SPHERE * (8.0 / (3.0 * PI)) * (sqrt(1.0 - c * c) + (PI - acos(c)) * c);
    }
    case 6u: return tabulated_phase(cosine);
    default: return PER_SPHERE;
    }
}
