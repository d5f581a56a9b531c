// Hashed random numbers: no state, the same on every device.

// One round of PCG (Jarzynski & Olano 2020, "Hash functions for GPU rendering").
uint pcg(uint v) {
    uint state = v * 747796405u + 2891336453u;
    uint word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (word >> 22u) ^ word;
}

// In [0, 1), from pixel, frame and seed.
float random_pixel(uvec2 pixel, uint frame, uint seed) {
    return float(pcg(pixel.x + pcg(pixel.y + pcg(frame + pcg(seed)))) >> 8) * (1.0 / 16777216.0);
}

// A sequence of them: PCG with a state (O'Neill 2014).
struct Random { uint state; };

Random random_sequence(uvec2 pixel, uint frame, uint seed) {
    return Random(pcg(pixel.x + pcg(pixel.y + pcg(frame + pcg(seed)))));
}

// In [0, 1).
float next_random(inout Random random) {
    random.state = random.state * 747796405u + 2891336453u;
    uint word = ((random.state >> ((random.state >> 28u) + 4u)) ^ random.state) * 277803737u;
    return float(((word >> 22u) ^ word) >> 8) * (1.0 / 16777216.0);
}
