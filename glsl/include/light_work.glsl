// What the light passes work on: groups of 4x4x4 samples of resident bricks, and who computes a shared sample.
// Includes volume.glsl first.

layout(set = 0, binding = BINDING_BRICKS, std430) readonly buffer BrickTable { BrickRecord bricks[]; };
// Each entry: index into the brick table; group inside the brick, 8 bits an axis; the samples that are needed, a bit each.
layout(set = 0, binding = BINDING_WORK, std430) readonly buffer WorkList { uvec4 work[]; };

const uint GROUP_SIZE = 4u;

struct LightSample {
    BrickRecord record;
    ivec3 sample_at;  // texel of the atlas
    ivec3 local;      // sample inside the brick
};

// Place of the `n`th bit that is set of 64.
uint nth_bit(uvec2 bits, uint n) {
    uint below = bitCount(bits.x);
    bool upper = n >= below;
    uint word = upper ? bits.y : bits.x;
    n -= upper ? below : 0u;
    uint place = upper ? 32u : 0u;
    [[unroll]] for (uint width = 16u; width > 0u; width >>= 1) {
        below = bitCount(word & ((1u << width) - 1u));
        upper = n >= below;
        word = upper ? word >> width : word;
        n -= upper ? below : 0u;
        place += upper ? width : 0u;
    }
    return place;
}

// True when an entry has samples for so many lanes and one more.
bool has_sample(uvec4 entry, uint lane) {
    return lane < bitCount(entry.z) + bitCount(entry.w);
}

// The sample that a lane computes; needed ones come first, so that no lane among them is idle.
uvec3 listed_sample(uvec4 entry, uint lane) {
    uint at = nth_bit(entry.zw, lane);
    return uvec3(at, at / GROUP_SIZE, at / (GROUP_SIZE * GROUP_SIZE)) % GROUP_SIZE;
}

LightSample light_sample(uvec4 entry, uvec3 lane) {
    LightSample s;
    s.record = bricks[entry.x];
    uvec3 group = uvec3(entry.y & 255u, (entry.y >> 8) & 255u, entry.y >> 16);
    s.local = ivec3(group * GROUP_SIZE + lane);
    s.sample_at = ivec3(s.record.origin_at) + s.local;
    return s;
}

Brick brick_of(BrickRecord record) {
    return brick_fetch(record.block_bx);
}

vec3 sample_position_ix(Brick b, ivec3 local) {
    return b.base_ix + vec3(local) / b.scale;
}

// Who else has this sample, of all resident blocks whose closed box contains it: the one of the same level that computes
// it (the last in x-fastest order), and the coarsest one, whose interpolation the others follow.
struct Sharing {
    ivec3 owner_bx;
    ivec3 coarsest_bx;
    int coarsest_level;
};

Sharing sharing_of(Brick b, ivec3 block_bx, ivec3 local) {
    Sharing sharing = Sharing(block_bx, block_bx, b.level);
    ivec3 last = ivec3(b.intervals);
    ivec3 low = -ivec3(equal(local, ivec3(0)));
    ivec3 high = ivec3(equal(local, last));
    for (int z = low.z; z <= high.z; ++z) {
        for (int y = low.y; y <= high.y; ++y) {
            for (int x = low.x; x <= high.x; ++x) {
                ivec3 there = block_bx + ivec3(x, y, z);
                if (any(lessThan(there, ivec3(0))) || any(greaterThanEqual(there, volume.blocks))) {
                    continue;
                }
                int level = int(index_entry(there).w) - 1;
                if (level < 0) {
                    continue;
                }
                if (level < sharing.coarsest_level) {
                    sharing.coarsest_level = level;
                    sharing.coarsest_bx = there;
                }
                if (level == b.level) {
                    // Loops run upwards, so the last one seen is the last in x-fastest order.
                    sharing.owner_bx = there;
                }
            }
        }
    }
    return sharing;
}
