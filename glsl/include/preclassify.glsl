// Classification before interpolation: voxels are classified, and their associated colours and opacities over the unit distance
// are interpolated. Includes reconstruct.glsl and classify.glsl first.

// The table holds opacities over the unit distance for this (src/atlas/transfer_table.rs).
// `exponent`: length of the segment in unit distances.
Classified classify_voxels(Brick b, vec3 p_ix, float exponent) {
    vec3 local = brick_local(b, p_ix);
    if (INTERPOLATION == 0u) {
        Classified c = classify(atlas_texel(ivec3(b.origin_at + floor(local + 0.5))), 1.0);
        c.opacity = opacity_over(c.opacity, exponent);
        return c;
    }
    ivec3 cell = ivec3(min(local, b.intervals - 1.0));
    vec3 f = local - vec3(cell);
    Classified sum = Classified(vec3(0.0), vec3(0.0), 0.0);
    for (int corner = 0; corner < 8; ++corner) {
        ivec3 bit = ivec3(corner & 1, (corner >> 1) & 1, corner >> 2);
        vec3 w = mix(1.0 - f, f, vec3(bit));
        Classified c = classify(atlas_texel(ivec3(b.origin_at) + cell + bit), 1.0);
        float weight = w.x * w.y * w.z * c.opacity;
        sum.color += weight * c.color;
        sum.emission += weight * c.emission;
        sum.opacity += weight;
    }
    float per_opacity = sum.opacity > 0.0 ? 1.0 / sum.opacity : 0.0;
    return Classified(sum.color * per_opacity, sum.emission * per_opacity, opacity_over(sum.opacity, exponent));
}
