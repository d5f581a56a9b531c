// Estimates of the field's gradient. Includes reconstruct.glsl first.
//
// All but the two cubic ones are sums of taps of the trilinear field whole voxels away, which is the trilinear interpolation of
// the estimates at voxels. Taps beyond the volume read its border.

// 0 central differences, 1 four points an axis, 2 linear regression, 3 Sobel, 4 B-spline, 5 Catmull-Rom (src/pass/picture.rs).
layout(constant_id = SPEC_GRADIENT) const uint GRADIENT = 0;

// One-sided at the volume's border and where the neighbour is not resident.
float central_difference(Brick b, vec3 p_ix, vec3 axis) {
    vec3 low = clamp(p_ix - axis, vec3(0.0), volume.field_ix);
    vec3 high = clamp(p_ix + axis, vec3(0.0), volume.field_ix);
    Brick b_low = brick_at(low);
    Brick b_high = brick_at(high);
    if (!b_low.resident) {
        low = clamp(low, b.base_ix, b.base_ix + b.cells);
        b_low = b;
    }
    if (!b_high.resident) {
        high = clamp(high, b.base_ix, b.base_ix + b.cells);
        b_high = b;
    }
    float difference = reconstruct_linear(b_high, brick_local(b_high, high)) - reconstruct_linear(b_low, brick_local(b_low, low));
    return difference / max(dot(high - low, axis), 1e-6);
}

float four_point_difference(Brick b, vec3 p_ix, vec3 axis) {
    float near = field_linear(b, p_ix + axis) - field_linear(b, p_ix - axis);
    float far = field_linear(b, p_ix + 2.0 * axis) - field_linear(b, p_ix - 2.0 * axis);
    return (8.0 * near - far) / 12.0;
}

// Differences over the 26 neighbours; `weights` of those that differ on one, two and three axes.
vec3 neighborhood_gradient_ix(Brick b, vec3 p_ix, vec3 weights) {
    vec3 gradient = vec3(0.0);
    for (int n = 0; n < 27; ++n) {
        ivec3 offset = ivec3(n % 3, n / 3 % 3, n / 9) - 1;
        int axes = abs(offset.x) + abs(offset.y) + abs(offset.z);
        float weight = axes == 0 ? 0.0 : weights[max(axes, 1) - 1];
        gradient += weight * field_linear(b, p_ix + vec3(offset)) * vec3(offset);
    }
    return gradient;
}

// Weighted by 1/distance, (1, 1/sqrt 2, 1/sqrt 3), over their sum on an axis, 2 (1 + 4/sqrt 2 + 4/sqrt 3).
const vec3 REGRESSION = vec3(1.0, 0.707106781, 0.577350269) / 12.275656;
// (1, 2, 1)/4 on two axes, half a difference over two voxels on the third.
const vec3 SOBEL = vec3(0.125, 0.0625, 0.03125);

// In units of texture samples per index unit.
vec3 gradient_ix(Brick b, vec3 p_ix) {
    switch (GRADIENT) {
    case 1u:
        return vec3(
            four_point_difference(b, p_ix, vec3(1.0, 0.0, 0.0)),
            four_point_difference(b, p_ix, vec3(0.0, 1.0, 0.0)),
            four_point_difference(b, p_ix, vec3(0.0, 0.0, 1.0)));
    case 2u: return neighborhood_gradient_ix(b, p_ix, REGRESSION);
    case 3u: return neighborhood_gradient_ix(b, p_ix, SOBEL);
    case 4u: return bspline_gradient_ix(b, brick_local(b, p_ix));
    case 5u: return catmull_rom_gradient_ix(b, brick_local(b, p_ix));
    default:
        return vec3(
            central_difference(b, p_ix, vec3(1.0, 0.0, 0.0)),
            central_difference(b, p_ix, vec3(0.0, 1.0, 0.0)),
            central_difference(b, p_ix, vec3(0.0, 0.0, 1.0)));
    }
}

// In units of texture samples per mm.
vec3 gradient_ws(Brick b, vec3 p_ix) {
    vec3 g = gradient_ix(b, p_ix);
    return g.x * volume.gradient_x_ws + g.y * volume.gradient_y_ws + g.z * volume.gradient_z_ws;
}
