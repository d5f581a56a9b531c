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
#include "labels.glsl"

layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

layout(set = 0, binding = BINDING_LIGHT_STORE, rgba16f) uniform image3D i_light;
layout(push_constant) uniform Push { LightPush push; };

// Opacity below which the rest of a ray cannot matter: it adds less than this to the light.
const float DARK = 1e-5;

// Writes how many samples were taken instead of the light (the bench).
layout(constant_id = SPEC_COUNT) const bool COUNT = false;

// Growth of the step for coarse bricks: 1 at the finest level, 8.5 at level 0.
float step_growth(int level) {
    float resolution = float(1 << level);
    return (16.0 + resolution) / (2.0 * resolution);
}

// What a ray has gathered.
struct Gathered {
    float transparency;
    // Samples that found nothing are counted and added up when the transparency changes, so that leaping over them and
    // visiting them give the same bits.
    float pending;
    float light;
    vec3 emitted;
    uint samples;
};

void gather(inout Gathered g, float opacity, vec3 emission) {
    g.pending += 1.0;
    if (EMISSION) {
        precise vec3 emitted = g.emitted + g.transparency * emission;
        g.emitted = emitted;
    }
    if (opacity > 0.0) {
        precise float light = g.light + g.transparency * g.pending;
        precise float transparency = g.transparency * (1.0 - opacity);
        g.light = light;
        g.transparency = transparency;
        g.pending = 0.0;
    }
}

// Light from one direction: rgb with emission, a without; or how many samples that took. Outside the field nothing absorbs
// or emits.
vec4 light_along(vec3 p_ix, int level) {
    float extent_mm = push.radius_mm - push.offset_mm;
    uint parts = uint(max(ceil(push.parts / step_growth(level) - 1e-4), 1.0));
    vec3 step_ix = push.direction_ix * (extent_mm / float(parts));
    vec3 start_ix = p_ix + push.direction_ix * push.offset_mm;
    float unit_exponent = push.exponent_mm * (extent_mm / push.parts);
    float share = push.parts / float(parts);

    float longest_step = max(abs(step_ix.x), max(abs(step_ix.y), abs(step_ix.z)));
    Gathered g = Gathered(1.0, 0.0, 0.0, vec3(0.0), 0u);
    uint m = 0u;
    while (m < parts && g.transparency >= DARK) {
        precise vec3 sample_ix = start_ix + (float(m) + 0.5) * step_ix;
        if (any(lessThan(sample_ix, vec3(0.0))) || any(greaterThan(sample_ix, volume.field_ix))) {
            g.pending += 1.0;
            ++m;
            continue;
        }
        uint distance = skip_distance(sample_ix);
        Brick brick = brick_at(sample_ix);
        if (distance > 0u || !brick.resident) {
            // All within distance - 1 cells is empty too. (Where exactly the ray leaves that box is not worth finding out:
            // rays are short.)
            float reach = float(max(int(distance) - 1, 0) * SKIP_CELLS);
            uint run = min(uint(max(reach / longest_step, 1.0)), parts - m);
            g.pending += float(run);
            m += run;
            continue;
        }
        g.samples += 1u;
        Classified c = classify_light(reconstruct_linear(brick, brick_local(brick, sample_ix)), unit_exponent);
        // Coarse bricks take longer samples than the table is made for.
        float opacity = UNIFORM_GRID ? c.opacity : opacity_over(c.opacity, share);
        bool hidden = is_hidden(sample_ix);
        gather(g, hidden ? 0.0 : opacity, hidden ? vec3(0.0) : c.emission);
        ++m;
    }
    if (COUNT) {
        return vec4(float(g.samples));
    }
    float light = g.light + g.transparency * g.pending;
    return vec4(vec3(light) + g.emitted, light) / float(parts);
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
    vec4 light = light_along(sample_position_ix(brick, s.local), brick.level);
    vec4 mean = push.ray == 0u ? vec4(0.0) : imageLoad(i_light, s.sample_at);
    if (COUNT) {
        imageStore(i_light, s.sample_at, mean + light);
        return;
    }
    light *= push.weight;
    imageStore(i_light, s.sample_at, round_to_half(mean + (light - mean) / float(push.ray + 1u)));
}
