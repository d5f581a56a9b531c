// Rounding to what an f16 image holds.

// To the nearest 11-bit significand, ties to even. Image stores may truncate instead, and a running mean would sink.
// Below 2^-14 the image's own rounding remains: an error of at most 2^-24.
vec4 round_to_half(vec4 v) {
    uvec4 bits = floatBitsToUint(v);
    bits += 0xfffu + ((bits >> 13) & 1u);
    return uintBitsToFloat(bits & ~0x1fffu);
}
