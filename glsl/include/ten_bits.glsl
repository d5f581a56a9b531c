// Gradients of ten bits a component in a word, each in two's complement.

uint ten_bits_of(ivec3 g) {
    return (uint(g.x) & 1023u) | (uint(g.y) & 1023u) << 10 | uint(g.z) << 22;
}

// What a word counts, times TEN_BITS_SCALE: components stay at the top of their words, where the sign is.
const float TEN_BITS_SCALE = 4194304.0;

vec3 ten_bits_in(uint word) {
    return vec3(ivec3(word << 22, word << 12 & 0xffc00000u, word & 0xffc00000u));
}
