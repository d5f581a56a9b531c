// Tri-cubic reconstruction: separable kernels of four samples an axis, on the samples of a position's own brick.
//
// Samples whose weights share a sign are read in pairs, as one trilinear tap between them (Sigg and Hadwiger 2005): two taps an
// axis instead of four for the B-spline and its derivative, three for Catmull-Rom. Taps beyond the volume read its border.

// Taps of one axis: where, in samples from the cell's first, and how much.
struct Taps {
    vec4 at;
    vec4 weight;
    int count;
};

// Two taps from four weights, of which the first two share a sign, and the last two.
Taps taps_paired(vec4 w) {
    vec2 sum = vec2(w.x + w.y, w.z + w.w);
    vec2 share = vec2(sum.x == 0.0 ? 0.0 : w.y / sum.x, sum.y == 0.0 ? 0.0 : w.w / sum.y);
    return Taps(vec4(share.x - 1.0, share.y + 1.0, 0.0, 0.0), vec4(sum, 0.0, 0.0), 2);
}

// Three taps from four weights, of which the middle two share a sign.
Taps taps_around(vec4 w) {
    float sum = w.y + w.z;
    return Taps(vec4(-1.0, w.z / sum, 2.0, 0.0), vec4(w.x, sum, w.w, 0.0), 3);
}

Taps taps_single(vec4 w) {
    return Taps(vec4(-1.0, 0.0, 1.0, 2.0), w, 4);
}

// Weights of the four samples; `f`: position in the cell, [0, 1].
vec4 bspline_weights(float f) {
    float g = 1.0 - f;
    return vec4(g * g * g, 4.0 + f * f * (3.0 * f - 6.0), 4.0 + g * g * (3.0 * g - 6.0), f * f * f) / 6.0;
}

vec4 bspline_derivative_weights(float f) {
    float g = 1.0 - f;
    return vec4(-0.5 * g * g, f * (1.5 * f - 2.0), g * (2.0 - 1.5 * g), 0.5 * f * f);
}

vec4 catmull_rom_weights(float f) {
    float g = 1.0 - f;
    return vec4(-0.5 * f * g * g, 1.0 + f * f * (1.5 * f - 2.5), 1.0 + g * g * (1.5 * g - 2.5), -0.5 * g * f * f);
}

vec4 catmull_rom_derivative_weights(float f) {
    float g = 1.0 - f;
    return vec4(-0.5 * g * (1.0 - 3.0 * f), f * (4.5 * f - 5.0), g * (5.0 - 4.5 * g), 0.5 * f * (1.0 - 3.0 * g));
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
    float sum = 0.0;
    for (int k = 0; k < z.count; ++k) {
        for (int j = 0; j < y.count; ++j) {
            float weight = y.weight[j] * z.weight[k];
            for (int i = 0; i < x.count; ++i) {
                vec3 local = cell + vec3(x.at[i], y.at[j], z.at[k]);
                sum += x.weight[i] * weight * field_linear(b, b.base_ix + local / b.scale);
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
    vec3 gradient;
    [[unroll]] for (int axis = 0; axis < 3; ++axis) {
        Taps x = cubic_taps(catmull_rom, f.x, axis == 0);
        Taps y = cubic_taps(catmull_rom, f.y, axis == 1);
        Taps z = cubic_taps(catmull_rom, f.z, axis == 2);
        gradient[axis] = separable(b, cell, x, y, z);
    }
    return b.scale * gradient;
}
