// Opacity and optical depth.

// -ln(1 - opacity), accurate for small opacities too: in 32 bits 1 - a keeps only a few digits of an `a` of 1e-5, and a thousand
// such samples add their error up. Opaque is opaque at any length.
float optical_depth(float opacity) {
    return opacity < 0.03
        ? opacity * (1.0 + opacity * (0.5 + opacity * (0.333333333 + opacity * (0.25 + opacity * 0.2))))
        : opacity < 1.0 ? -log(1.0 - opacity) : 1e30;
}

// 1 - exp(-depth).
float opacity_of(float depth) {
    return depth < 0.03
        ? depth * (1.0 - depth * (0.5 - depth * (0.166666667 - depth * 0.041666667)))
        : 1.0 - exp(-depth);
}

// Opacity over `exponent` times the length it is given for, 1 - (1 - a)^exponent.
float opacity_over(float opacity, float exponent) {
    return opacity_of(optical_depth(opacity) * exponent);
}
