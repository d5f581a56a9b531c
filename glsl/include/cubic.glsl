// Tri-cubic reconstruction: separable kernels of four samples an axis, on the samples of a position's own brick.
//
// Samples whose weights share a sign are read in pairs, as one trilinear tap between them (Sigg and Hadwiger 2005): two taps an
// axis instead of four for the B-spline and its derivative, three for Catmull-Rom. Taps beyond the volume read its border.
// `precise` throughout: see brick_local().

// Taps of one axis: where, in samples from the cell's first, and how much.
struct Taps {
    vec4 at;
    vec4 weight;
    int count;
};

// Two taps from four weights, of which the first two share a sign, and the last two.
Taps taps_paired(vec4 w) {
    precise vec2 sum = vec2(w.x + w.y, w.z + w.w);
    precise vec2 share = vec2(sum.x == 0.0 ? 0.0 : w.y / sum.x, sum.y == 0.0 ? 0.0 : w.w / sum.y);
    return Taps(vec4(share.x - 1.0, share.y + 1.0, 0.0, 0.0), vec4(sum, 0.0, 0.0), 2);
}

// Three taps from four weights, of which the middle two share a sign.
Taps taps_around(vec4 w) {
    precise float sum = w.y + w.z;
    precise float share = w.z / sum;
    return Taps(vec4(-1.0, share, 2.0, 0.0), vec4(w.x, sum, w.w, 0.0), 3);
}

Taps taps_single(vec4 w) {
    return Taps(vec4(-1.0, 0.0, 1.0, 2.0), w, 4);
}

// Weights of the four samples; `f`: position in the cell, [0, 1].
vec4 bspline_weights(float f) {
    precise float g = 1.0 - f;
    precise vec4 weights = vec4(g * g * g, 4.0 + f * f * (3.0 * f - 6.0), 4.0 + g * g * (3.0 * g - 6.0), f * f * f) / 6.0;
    return weights;
}

vec4 bspline_derivative_weights(float f) {
    precise float g = 1.0 - f;
    precise vec4 weights = vec4(-0.5 * g * g, f * (1.5 * f - 2.0), g * (2.0 - 1.5 * g), 0.5 * f * f);
    return weights;
}

vec4 catmull_rom_weights(float f) {
    precise float g = 1.0 - f;
    precise vec4 weights = vec4(-0.5 * f * g * g, 1.0 + f * f * (1.5 * f - 2.5), 1.0 + g * g * (1.5 * g - 2.5), -0.5 * g * f * f);
    return weights;
}

vec4 catmull_rom_derivative_weights(float f) {
    precise float g = 1.0 - f;
    precise vec4 weights = vec4(-0.5 * g * (1.0 - 3.0 * f), f * (4.5 * f - 5.0), g * (5.0 - 4.5 * g), 0.5 * f * (1.0 - 3.0 * g));
    return weights;
}

// Of the kernel or of its derivative.
Taps cubic_taps(bool catmull_rom, float f, bool derivative) {
    if (catmull_rom) {
        return derivative ? taps_single(catmull_rom_derivative_weights(f)) : taps_around(catmull_rom_weights(f));
    }
    return taps_paired(derivative ? bspline_derivative_weights(f) : bspline_weights(f));
}

// Sum of a separable kernel over the taps of the three axes. `cell`: first sample of the cell.
float separable(Brick b, vec3 cell, Taps x, Taps y, Taps z) {
    precise float sum = 0.0;
    for (int k = 0; k < z.count; ++k) {
        for (int j = 0; j < y.count; ++j) {
            precise float weight = y.weight[j] * z.weight[k];
            for (int i = 0; i < x.count; ++i) {
                precise vec3 at_ix = b.base_ix + (cell + vec3(x.at[i], y.at[j], z.at[k])) / b.scale;
                sum += x.weight[i] * weight * field_linear(b, at_ix);
            }
        }
    }
    return sum;
}

float cubic_value(bool catmull_rom, Brick b, vec3 local) {
    vec3 cell = floor(local);
    vec3 f = local - cell;
    Taps x = cubic_taps(catmull_rom, f.x, false);
    Taps y = cubic_taps(catmull_rom, f.y, false);
    Taps z = cubic_taps(catmull_rom, f.z, false);
    return separable(b, cell, x, y, z);
}

// Derivatives, per index unit.
vec3 cubic_gradient_ix(bool catmull_rom, Brick b, vec3 local) {
    vec3 cell = floor(local);
    vec3 f = local - cell;
    Taps x = cubic_taps(catmull_rom, f.x, false);
    Taps y = cubic_taps(catmull_rom, f.y, false);
    Taps z = cubic_taps(catmull_rom, f.z, false);
    // (Not in a loop over axes: numbers of taps that are no constants keep llvmpipe from unrolling, and it has few rounds of loops.)
    return b.scale * vec3(
        separable(b, cell, cubic_taps(catmull_rom, f.x, true), y, z),
        separable(b, cell, x, cubic_taps(catmull_rom, f.y, true), z),
        separable(b, cell, x, y, cubic_taps(catmull_rom, f.z, true)));
}
