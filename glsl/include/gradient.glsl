// Estimates of the field's gradient from its samples. Includes reconstruct.glsl first.
//
// All but the two cubic ones are the trilinear interpolation of the estimates at voxels, as sums of taps of the trilinear field. Taps
// beyond the volume read its border.

// 0 central differences, 1 four points an axis, 2 linear regression, 3 Sobel, 4 B-spline, 5 Catmull-Rom (src/pass/picture.rs).
layout(constant_id = SPEC_GRADIENT) const uint GRADIENT = 0;

// One-sided where the neighbour is not resident, and at voxels on the volume's border. Between those and the next ones, where the
// tap on the border stays there, the other one has a place from which the two still give the interpolation of what they give
// at voxels: with f the field along the axis and p < 1 the distance to the border, (1 - p) (f(1) - f(0)) + p (f(2) - f(0)) / 2 =
// (f(t) - f(0)) / t for t = 2 / (2 - p).
float central_difference(Brick b, vec3 p_ix, vec3 axis) {
    float from_low = dot(p_ix, axis);
    float from_high = dot(volume.field_ix - p_ix, axis);
    vec3 low = from_high < 1.0 ? p_ix + (from_high - 2.0 / (2.0 - from_high)) * axis : p_ix - axis;
    vec3 high = from_low < 1.0 ? p_ix + (2.0 / (2.0 - from_low) - from_low) * axis : p_ix + axis;
    low = clamp(low, vec3(0.0), volume.field_ix);
    high = clamp(high, vec3(0.0), volume.field_ix);
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
    float sum = 0.0;
    [[unroll]] for (int n = 1; n <= 2; ++n) {
        vec3 offset = float(n) * axis;
        sum += (n == 1 ? 8.0 : -1.0) * (field_linear(b, p_ix + offset) - field_linear(b, p_ix - offset));
    }
    return sum / 12.0;
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
//
// Each estimator is called in one place: drivers inline every call before they drop what a variant does not use.
vec3 estimated_gradient_ix(Brick b, vec3 p_ix) {
    // (Mesa takes a selection between constant vectors by specialization for one between their first components.)
    vec3 weights = SOBEL;
    if (GRADIENT == 2u) {
        weights = REGRESSION;
    }
    switch (GRADIENT) {
    case 2u:
    case 3u:
        return neighborhood_gradient_ix(b, p_ix, weights);
    case 4u:
    case 5u:
        return cubic_gradient_ix(GRADIENT == 5u, b, brick_local(b, p_ix));
    }
    vec3 gradient;
    [[unroll]] for (int a = 0; a < 3; ++a) {
        vec3 axis = vec3(equal(ivec3(a), ivec3(0, 1, 2)));
        gradient[a] = GRADIENT == 1u ? four_point_difference(b, p_ix, axis) : central_difference(b, p_ix, axis);
    }
    return gradient;
}
