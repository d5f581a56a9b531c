#version 460
#extension GL_GOOGLE_include_directive : require
// The table of preintegrated.glsl: what a whole step shows along which the value runs linearly from one entry's to another's.
//
// The parts of an entry are exact integrals (differences of antiderivatives, kept in pairs of floats), so its opacity is exact;
// its colour neglects only what the front of a part absorbs of the back of the same part.

#include "bindings.glsl"
#include "structs.glsl"
#include "optical_depth.glsl"
#include "loads.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = SPEC_EMISSION) const bool EMISSION = false;

// Rows: antiderivatives of extinction times colour (rgb) and of extinction (a), high and low parts; of extinction times emission
// (rgb), and the value (a), high and low; colour and extinction; emission. All over a whole step (src/atlas/preintegration.rs).
layout(set = 0, binding = BINDING_INTEGRALS) uniform sampler2D t_integrals;
layout(set = 0, binding = BINDING_INTEGRALS_LOADS, rgba32f) uniform readonly image2D i_integrals;
layout(set = 0, binding = BINDING_PREINTEGRATED_STORE, rgba32f) uniform writeonly image2D i_table;
layout(set = 0, binding = BINDING_PREINTEGRATED_EMISSION_STORE, rgba32f) uniform writeonly image2D i_emission;

// Parts of an entry.
const int PARTS = 16;

// An antiderivative, as two numbers that keep more digits.
struct Integral {
    vec4 high;
    vec4 low;
};

vec4 integral_texel(int entry, int row) {
    return LOADS ? imageLoad(i_integrals, ivec2(entry, row)) : texelFetch(t_integrals, ivec2(entry, row), 0);
}

Integral integral_at(int entry, int row) {
    return Integral(integral_texel(entry, row), integral_texel(entry, row + 1));
}

vec4 difference(Integral from, Integral to) {
    precise vec4 high = to.high - from.high;
    precise vec4 low = to.low - from.low;
    return high + low;
}

void main() {
    ivec2 entry = ivec2(gl_GlobalInvocationID.xy);
    int count = textureSize(t_integrals, 0).x;
    if (any(greaterThanEqual(entry, ivec2(count)))) {
        return;
    }
    int front = entry.x;
    int back = entry.y;
    vec3 radiance = vec3(0.0);
    vec3 emitted = vec3(0.0);
    float opacity;
    Integral emission_front = integral_at(front, 2);
    float length = front == back ? 0.0 : difference(emission_front, integral_at(back, 2)).a;
    // Where the function jumps, two entries have the same value.
    if (length == 0.0) {
        vec4 here = integral_texel(front, 4);
        opacity = opacity_of(here.a);
        radiance = here.rgb * opacity;
        if (EMISSION) {
            emitted = integral_texel(front, 5).rgb * opacity;
        }
    } else {
        float per_length = 1.0 / length;
        int between = abs(back - front);
        int parts = min(between, PARTS);
        int way = back < front ? -1 : 1;
        float transparency = 1.0;
        Integral color_front = integral_at(front, 0);
        Integral from = color_front;
        Integral emission_from = emission_front;
        for (int part = 1; part <= parts; ++part) {
            // No division but by a constant: CPU drivers divide integers one by one.
            int at = front + way * (between < PARTS ? part : between * part / PARTS);
            Integral to = integral_at(at, 0);
            vec4 integral = difference(from, to) * per_length;
            float alpha = transparency * opacity_of(max(integral.a, 0.0));
            float per_extinction = integral.a > 0.0 ? alpha / integral.a : 0.0;
            radiance += per_extinction * integral.rgb;
            if (EMISSION) {
                Integral emission_to = integral_at(at, 2);
                emitted += per_extinction * (difference(emission_from, emission_to).rgb * per_length);
                emission_from = emission_to;
            }
            transparency *= exp(-max(integral.a, 0.0));
            from = to;
        }
        opacity = opacity_of(max(difference(color_front, from).a * per_length, 0.0));
    }
    imageStore(i_table, entry, vec4(radiance, opacity));
    if (EMISSION) {
        imageStore(i_emission, entry, vec4(emitted, 0.0));
    }
}
