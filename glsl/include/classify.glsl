// The transfer function as a table of bins. Row 0 holds each bin's start (colour, opacity), row 1 its end, so that
// jumps at control points stay jumps; rows 2 and 3 hold emission and the light pass's opacity in the same way.
// Single texels, not filtered: a filter unit has 8 bits between entries.

#include "optical_depth.glsl"
#include "loads.glsl"

layout(constant_id = SPEC_EMISSION) const bool EMISSION = false;

layout(set = 0, binding = BINDING_TRANSFER) uniform sampler2D t_transfer;
layout(set = 0, binding = BINDING_TRANSFER_LOADS, rgba32f) uniform readonly image2D i_transfer;

struct Classified {
    vec3 color;     // linear, not premultiplied
    vec3 emission;
    float opacity;  // over a whole sample
};

// Some bins are not linear in the opacity over a whole sample. (Bins with a branch of their own are no cure: CPU drivers
// execute both sides.)
layout(constant_id = SPEC_EXACT_BINS) const bool EXACT_BINS = false;

// Opacity of a whole sample between the two ends of a bin. The table holds opacities over a whole sample's length where they
// are linear in the bin; other bins hold the function's own and mark their end as -1 - opacity.
// `unit_exponent`: length of a whole sample in unit distances.
float bin_opacity(float start, float end, float f, float unit_exponent) {
    if (EXACT_BINS) {
        if (end < -0.5) {
            return opacity_over(mix(start, -1.0 - end, f), unit_exponent);
        }
    }
    return mix(start, end, f);
}

// Bin of a texture sample, and where in it.
int bin_of(float value, out float f) {
    float x = clamp((value - volume.first_sample) * volume.bin_from_sample + 1.0, 0.0, volume.bins);
    float bin = min(floor(x), volume.last_bin);
    f = x - bin;
    return int(bin);
}

vec4 transfer_texel(int bin, int row) {
    return LOADS ? imageLoad(i_transfer, ivec2(bin, row)) : texelFetch(t_transfer, ivec2(bin, row), 0);
}

// A bin as the table has it, and where in it a value lies.
struct Bin {
    vec4 start;
    vec4 end;
    float f;
    int number;
};

Bin bin_at(float value) {
    Bin b;
    b.number = bin_of(value, b.f);
    b.start = transfer_texel(b.number, 0);
    b.end = transfer_texel(b.number, 1);
    return b;
}

Classified classify_in(Bin b, float unit_exponent) {
    Classified c;
    c.color = mix(b.start.rgb, b.end.rgb, b.f);
    c.opacity = bin_opacity(b.start.a, b.end.a, b.f, unit_exponent);
    c.emission = vec3(0.0);
    if (EMISSION) {
        c.emission = mix(transfer_texel(b.number, 2).rgb, transfer_texel(b.number, 3).rgb, b.f);
    }
    return c;
}

// For the march.
Classified classify(float value, float unit_exponent) {
    return classify_in(bin_at(value), unit_exponent);
}

// For the light pass, which needs no colour.
Classified classify_light(float value, float unit_exponent) {
    float f;
    int bin = bin_of(value, f);
    vec4 start = transfer_texel(bin, 2);
    vec4 end = transfer_texel(bin, 3);
    return Classified(vec3(0.0), mix(start.rgb, end.rgb, f), bin_opacity(start.a, end.a, f, unit_exponent));
}
