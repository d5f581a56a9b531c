#version 460
#extension GL_GOOGLE_include_directive : require
// Local ambient occlusion, eq. 1-5 of Hernell, Ljung and Ynnerman (2007): one direction for every sample of the light
// volume that can be seen, as a running mean.

#include "bindings.glsl"
#include "structs.glsl"
#include "volume.glsl"
#include "reconstruct.glsl"
#include "classify.glsl"
#include "skip.glsl"
#include "light_work.glsl"
#include "half_float.glsl"

layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

layout(set = 0, binding = BINDING_LIGHT_STORE, rgba16f) uniform image3D i_light;
layout(push_constant) uniform Push { LightPush push; };

// Opacity below which the rest of a ray cannot matter: it adds less than this to the light.
const float DARK = 1e-5;

// Growth of the step for coarse bricks: 1 at the finest level, 8.5 at level 0.
float step_growth(int level) {
    float resolution = float(1 << level);
    return (16.0 + resolution) / (2.0 * resolution);
}

struct Sample {
    float alpha;
    vec3 emission;
};

// A sample of the surroundings; outside the field nothing absorbs or emits. `run` tells how many samples from this one
// on, this one included, surely find nothing.
Sample sample_at(vec3 p_ix, vec3 step_ix, float exponent, out uint run) {
    Sample s = Sample(0.0, vec3(0.0));
    run = 1u;
    if (any(lessThan(p_ix, vec3(0.0))) || any(greaterThan(p_ix, volume.field_ix))) {
        return s;
    }
    if (SKIPPING) {
        ivec3 cell = skip_cell_of(p_ix);
        uint distance = texelFetch(t_skip, cell, 0).r;
        if (distance > 0u) {
            vec3 low_ix;
            vec3 high_ix;
            empty_box(cell, distance, low_ix, high_ix);
            run = samples_before(steps_to_border(p_ix, step_ix, low_ix, high_ix));
            return s;
        }
    }
    Brick brick = brick_fetch(block_of(p_ix));
    if (brick.resident) {
        Classified c = classify(reconstruct_linear(brick, brick_local(brick, p_ix)));
        s.alpha = opacity_over(c.color_opacity.a, exponent);
        s.emission = c.emission;
    }
    return s;
}

// Light from one direction: rgb with emission, a without.
vec4 light_along(vec3 p_ix, int level) {
    float extent_mm = push.radius_mm - push.offset_mm;
    uint parts = uint(max(ceil(extent_mm / (push.step_mm * step_growth(level)) - 1e-4), 1.0));
    float part_mm = extent_mm / float(parts);
    vec3 step_ix = push.direction_ix * part_mm;
    vec3 start_ix = p_ix + push.direction_ix * push.offset_mm;
    float exponent = push.exponent_mm * part_mm;

    // Samples that find nothing are counted and added up when the transparency changes, so that leaping over them and
    // visiting them give the same bits.
    float transparency = 1.0;
    float pending = 0.0;
    float occluded = 0.0;
    vec3 emitted = vec3(0.0);
    uint m = 0u;
    while (m < parts) {
        precise vec3 sample_ix = start_ix + (float(m) + 0.5) * step_ix;
        uint run;
        Sample s = sample_at(sample_ix, step_ix, exponent, run);
        run = min(run, parts - m);
        m += run;
        pending += float(run);
        if (EMISSION) {
            precise vec3 more = emitted + transparency * s.emission;
            emitted = more;
        }
        if (s.alpha > 0.0) {
            precise float more = occluded + transparency * pending;
            precise float rest = transparency * (1.0 - s.alpha);
            occluded = more;
            transparency = rest;
            pending = 0.0;
            if (transparency < DARK) {
                break;
            }
        }
    }
    occluded += transparency * pending;
    return vec4(vec3(occluded) + emitted, occluded) / float(parts);
}

void main() {
    if (gl_WorkGroupID.x >= push.count) {
        return;
    }
    LightSample s = light_sample(work[push.first + gl_WorkGroupID.x], gl_LocalInvocationID);
    Brick brick = brick_of(s.record);
    ivec3 last = ivec3(brick.intervals);
    if (any(greaterThan(s.local, last))) {
        return;
    }
    if (any(equal(s.local, ivec3(0))) || any(equal(s.local, last))) {
        Sharing sharing = sharing_of(brick, s.record.block_bx, s.local);
        if (sharing.owner_bx != s.record.block_bx || sharing.coarsest_level < brick.level) {
            return;
        }
    }
    vec4 light = push.weight * light_along(sample_position_ix(brick, s.local), brick.level);
    vec4 mean = push.ray == 0u ? vec4(0.0) : imageLoad(i_light, s.sample_at);
    imageStore(i_light, s.sample_at, round_to_half(mean + (light - mean) / float(push.ray + 1u)));
}
