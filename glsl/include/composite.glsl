// Front-to-back compositing along a ray.

struct Accumulated {
    vec3 radiance;   // premultiplied
    float opacity;
    float depth_mm;  // of the first segment at which opacity reached the threshold; infinite: none
    uint samples;
};

void composite(inout Accumulated acc, vec3 color, float alpha) {
    // `precise`: variants of this pass must not differ in the last bit.
    precise float weight = (1.0 - acc.opacity) * alpha;
    precise vec3 radiance = acc.radiance + weight * color;
    precise float opacity = acc.opacity + weight;
    acc.radiance = radiance;
    acc.opacity = opacity;
}
