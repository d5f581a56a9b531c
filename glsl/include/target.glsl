// What leaves the march: composited over the target, and encoded for it.

float encode_srgb_channel(float linear) {
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * pow(linear, 1.0 / 2.4) - 0.055;
}

float decode_srgb_channel(float display) {
    return display <= 0.04045 ? display / 12.92 : pow((display + 0.055) / 1.055, 2.4);
}

vec3 encode_srgb(vec3 c) {
    c = clamp(c, vec3(0.0), vec3(1.0));
    return vec3(encode_srgb_channel(c.r), encode_srgb_channel(c.g), encode_srgb_channel(c.b));
}

vec3 decode_srgb(vec3 c) {
    return vec3(decode_srgb_channel(c.r), decode_srgb_channel(c.g), decode_srgb_channel(c.b));
}
