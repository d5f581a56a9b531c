// Front-to-back compositing along a ray.

// What a ray has gathered. Depths are distances from the ray's origin, infinite where there is none.
struct Accumulated {
    vec3 radiance;        // premultiplied
    float opacity;
    float depth_mm;       // where opacity reached the threshold
    float median_mm;      // where opacity reached 0.5
    float depth_sum;      // depths (mm), weighted by what each sample adds to the opacity
    float optical_depth;
    uint samples;
};

const float MEDIAN_OPACITY = 0.5;

float infinite() {
    return uintBitsToFloat(0x7f800000u);
}

Accumulated nothing() {
    return Accumulated(vec3(0.0), 0.0, infinite(), infinite(), 0.0, 0.0, 0u);
}

void composite(inout Accumulated acc, vec3 color, float alpha) {
    // `precise`: variants of this pass must not differ in the last bit.
    precise float weight = (1.0 - acc.opacity) * alpha;
    precise vec3 radiance = acc.radiance + weight * color;
    precise float opacity = acc.opacity + weight;
    acc.radiance = radiance;
    acc.opacity = opacity;
}

// Adds what a sample of opacity `alpha` at a depth says of depths; called before composite().
void gather_depth(inout Accumulated acc, float alpha, float depth_mm, float threshold) {
    // As composite() has it: a sample without opacity reaches no threshold that the last one did not.
    precise float weight = (1.0 - acc.opacity) * alpha;
    precise float after = acc.opacity + weight;
    acc.depth_sum += weight * depth_mm;
    acc.depth_mm = isinf(acc.depth_mm) && after >= threshold ? depth_mm : acc.depth_mm;
    acc.median_mm = isinf(acc.median_mm) && after >= MEDIAN_OPACITY ? depth_mm : acc.median_mm;
}

float expected_depth(Accumulated acc) {
    return acc.opacity > 0.0 ? acc.depth_sum / acc.opacity : infinite();
}
