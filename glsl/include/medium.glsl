// What the medium is at a point. Includes reconstruct.glsl, classify.glsl and labels.glsl first.

layout(set = 0, binding = BINDING_MEDIUM) uniform MediumBlock { MediumParams medium; };

// Some point of the transfer function adds light whatever its opacity.
layout(constant_id = SPEC_GLOWS) const bool GLOWS = false;

struct Matter {
    vec3 color;
    vec3 emission;     // radiance per optical depth
    vec3 source;       // radiance per mm
    float extinction;  // per mm, before the channels' factors
};

const int SOURCE_ROW = 5;
// More than this per sample is opaque at any length that a picture can show.
const float LARGEST_DEPTH = 1e4;

Matter matter_at(Brick b, vec3 p_ix) {
    float value = reconstruct(b, p_ix);
    Classified c = classify(value, medium.unit_exponent);
    vec3 source = vec3(0.0);
    if (GLOWS) {
        float f;
        int bin = bin_of(value, f);
        source = mix(transfer_texel(bin, SOURCE_ROW).rgb, transfer_texel(bin, SOURCE_ROW + 1).rgb, f) / medium.unit_mm;
        source = is_hidden(p_ix) ? vec3(0.0) : source;
    }
    apply_label(p_ix, c.color, c.opacity);
    return Matter(c.color, c.emission, source, min(optical_depth(c.opacity), LARGEST_DEPTH) / medium.sample_mm);
}

// Extinction at any point of the field, per mm; 0 where nothing is resident.
float extinction_at(vec3 p_ix) {
    Brick b = brick_at(p_ix);
    Classified c = classify(reconstruct(b, p_ix), medium.unit_exponent);
    apply_label(p_ix, c.color, c.opacity);
    return b.resident ? min(optical_depth(c.opacity), LARGEST_DEPTH) / medium.sample_mm : 0.0;
}

vec3 ws_from_ix(vec3 p_ix) {
    vec4 p = vec4(p_ix, 1.0);
    return vec3(dot(medium.ws_from_ix_x, p), dot(medium.ws_from_ix_y, p), dot(medium.ws_from_ix_z, p));
}

// Of a direction: index units per mm.
vec3 ix_from_direction(vec3 direction_ws) {
    return vec3(
        dot(medium.ix_from_ws_x.xyz, direction_ws),
        dot(medium.ix_from_ws_y.xyz, direction_ws),
        dot(medium.ix_from_ws_z.xyz, direction_ws));
}

// Distance (mm) along `d_ix` (index units per mm) from a point of the field to its border.
float distance_to_exit(vec3 p_ix, vec3 d_ix) {
    vec3 far = mix(vec3(0.0), volume.field_ix, greaterThan(d_ix, vec3(0.0)));
    vec3 t = mix((far - p_ix) / d_ix, vec3(3.0e38), equal(d_ix, vec3(0.0)));
    return max(min(t.x, min(t.y, t.z)), 0.0);
}
