// Light that a sample receives: the light volume and Lambert's law.

layout(constant_id = SPEC_LIGHT) const bool LIGHT = false;
layout(constant_id = SPEC_DIFFUSE) const bool DIFFUSE = false;

layout(set = 0, binding = BINDING_LIGHT) uniform sampler3D t_light;

// Local ambient occlusion, packed like the atlas.
vec3 light_at(Brick b, vec3 local) {
    vec3 uvw = (b.origin_at + local + 0.5) * volume.atlas_texel;
    return textureLod(t_light, uvw, 0.0).rgb;
}

// One tap of a gradient: clamped to the field, and to this brick where the neighbour is not resident.
float gradient_tap(Brick b, inout vec3 p_ix) {
    p_ix = clamp(p_ix, vec3(0.0), volume.field_ix);
    ivec3 block_bx = block_of(p_ix);
    Brick there = brick_fetch(block_bx);
    if (!there.resident) {
        p_ix = clamp(p_ix, b.base_ix, b.base_ix + b.cells);
        there = b;
    }
    return reconstruct_linear(there, brick_local(there, p_ix));
}

float gradient_axis(Brick b, vec3 p_ix, vec3 axis) {
    vec3 low = p_ix - axis;
    vec3 high = p_ix + axis;
    float difference = -gradient_tap(b, low);
    difference += gradient_tap(b, high);
    return difference / max(dot(high - low, axis), 1e-6);
}

// Central differences one voxel away, in world space; in units of texture samples per mm.
vec3 gradient_ws(Brick b, vec3 p_ix) {
    return gradient_axis(b, p_ix, vec3(1.0, 0.0, 0.0)) * volume.gradient_x_ws
        + gradient_axis(b, p_ix, vec3(0.0, 1.0, 0.0)) * volume.gradient_y_ws
        + gradient_axis(b, p_ix, vec3(0.0, 0.0, 1.0)) * volume.gradient_z_ws;
}

// ambient + diffuse |n . l|; 1 where there is no gradient and hence no surface.
float lambert(vec3 gradient, vec3 light, float ambient, float diffuse) {
    // Scaled by the largest component first: the square of a gradient in a volume of 1e6 mm spacing underflows.
    float largest = max(abs(gradient.x), max(abs(gradient.y), abs(gradient.z)));
    if (!(largest > 0.0)) {
        return 1.0;
    }
    return ambient + diffuse * abs(dot(normalize(gradient / largest), light));
}
