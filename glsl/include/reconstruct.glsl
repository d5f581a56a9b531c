// The field between samples. Includes volume.glsl first.

#include "packed_cells.glsl"

// 0 nearest, 1 trilinear, 2 tri-cubic B-spline, 3 tri-cubic Catmull-Rom (src/pass/mod.rs).
layout(constant_id = SPEC_INTERPOLATION) const uint INTERPOLATION = 1;
layout(constant_id = SPEC_BLOCKS_APART) const bool BLOCKS_APART = false;
// Formats that the texture unit cannot filter are filtered here.
layout(constant_id = SPEC_MANUAL_FILTER) const bool MANUAL_FILTER = false;

layout(set = 0, binding = BINDING_ATLAS) uniform sampler3D t_atlas;

// Position in samples inside a brick, [0, intervals].
// `precise` throughout: variants of a pass (skipping on or off, say) must compute the same bits.
vec3 brick_local(Brick b, vec3 p_ix) {
    precise vec3 local = p_ix - b.base_ix;
    local = UNIFORM_GRID ? local : clamp(local * b.scale, vec3(0.0), b.intervals);
    if (BLOCKS_APART) {
        // No interpolation between blocks: the apron, which belongs to the next block, is not used. The last block of an axis has
        // no next one and keeps its last sample.
        vec3 block_ix = vec3(block_of(p_ix) * BLOCK_CELLS);
        bvec3 last = lessThanEqual(volume.field_ix, block_ix + float(BLOCK_CELLS));
        vec3 end = UNIFORM_GRID ? block_ix + float(BLOCK_CELLS) : b.intervals;
        local = min(local, mix(end - 1.0, end, vec3(last)));
    }
    return local;
}

float atlas_texel(ivec3 at) {
    return texelFetch(t_atlas, at, 0).r;
}

float atlas_linear_manual(vec3 at) {
    ivec3 i = ivec3(at);
    vec3 f = at - vec3(i);
    // A fraction of 0 must not read the next texel: it may be another brick's.
    ivec3 j = i + ivec3(notEqual(f, vec3(0.0)));
    float v00 = mix(atlas_texel(i), atlas_texel(ivec3(j.x, i.y, i.z)), f.x);
    float v10 = mix(atlas_texel(ivec3(i.x, j.y, i.z)), atlas_texel(ivec3(j.x, j.y, i.z)), f.x);
    float v01 = mix(atlas_texel(ivec3(i.x, i.y, j.z)), atlas_texel(ivec3(j.x, i.y, j.z)), f.x);
    float v11 = mix(atlas_texel(ivec3(i.x, j.y, j.z)), atlas_texel(j), f.x);
    return mix(mix(v00, v10, f.y), mix(v01, v11, f.y), f.z);
}

// Trilinear, whatever the march does: gradients and light follow the continuous field.
float reconstruct_linear(Brick b, vec3 local) {
    if (PACKED_CELLS == 0u) {
        if (MANUAL_FILTER) {
            return atlas_linear_manual(b.origin_at + local);
        }
        precise vec3 uvw = (b.origin_at + local + 0.5) * volume.atlas_texel;
        return textureLod(t_atlas, uvw, 0.0).r;
    }
    return packed_linear(b.origin_at + local);
}

// At two positions at once, of packed corners.
vec2 reconstruct_pair(Brick first, vec3 first_ix, Brick second, vec3 second_ix) {
    return packed_linear_pair(
        first.origin_at + brick_local(first, first_ix), second.origin_at + brick_local(second, second_ix)
    );
}

// The trilinear field at any position, beyond the volume that of its border. `near` stands in where nothing is resident.
float field_linear(Brick near, vec3 p_ix) {
    p_ix = clamp(p_ix, vec3(0.0), volume.field_ix);
    Brick there = brick_near(p_ix, near);
    return reconstruct_linear(there, brick_local(there, p_ix));
}

#include "cubic.glsl"

// Texture sample at a position inside a brick.
float reconstruct(Brick b, vec3 p_ix) {
    vec3 local = brick_local(b, p_ix);
    switch (INTERPOLATION) {
    case 0u: return atlas_texel(ivec3(b.origin_at + floor(local + 0.5)));
    case 2u:
    case 3u: return cubic_value(INTERPOLATION == 3u, b, local);
    default: return reconstruct_linear(b, local);
    }
}
