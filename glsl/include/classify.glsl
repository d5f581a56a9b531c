// The transfer function as a table of bins. Row 0 holds each bin's start (colour, opacity), row 1 its end, so that
// jumps at control points stay jumps; rows 2 and 3 hold emission in the same way.
// Fetched, not filtered: a filter unit has 8 bits between entries.

layout(constant_id = SPEC_EMISSION) const bool EMISSION = false;

layout(set = 0, binding = BINDING_TRANSFER) uniform sampler2D t_transfer;

struct Classified {
    vec4 color_opacity;  // linear colour, not premultiplied; opacity over the unit distance
    vec3 emission;
};

Classified classify(float value) {
    float x = clamp((value - volume.first_sample) * volume.bin_from_sample + 1.0, 0.0, volume.bins);
    float bin = min(floor(x), volume.last_bin);
    float f = x - bin;
    int column = int(bin);
    Classified c;
    c.color_opacity = mix(texelFetch(t_transfer, ivec2(column, 0), 0), texelFetch(t_transfer, ivec2(column, 1), 0), f);
    c.emission = vec3(0.0);
    if (EMISSION) {
        c.emission = mix(texelFetch(t_transfer, ivec2(column, 2), 0), texelFetch(t_transfer, ivec2(column, 3), 0), f).rgb;
    }
    return c;
}

// Opacity over `exponent` unit distances, 1 - (1 - a)^exponent, accurate for small opacities too: in 32 bits 1 - a keeps
// only a few digits of an `a` of 1e-5, and a thousand such samples add their error up.
float opacity_over(float opacity, float exponent) {
    float extinction = opacity < 0.03
        ? opacity * (1.0 + opacity * (0.5 + opacity * (0.333333333 + opacity * (0.25 + opacity * 0.2))))
        : -log(max(1.0 - opacity, 1e-37));
    float depth = extinction * exponent;
    return depth < 0.03
        ? depth * (1.0 - depth * (0.5 - depth * (0.166666667 - depth * 0.041666667)))
        : 1.0 - exp(-depth);
}
