#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
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

// Samples of a run that starts where something shows; the same for all rays, so that neighbours stay in step.
const uint LIGHT_RUN = 4u;

// What a ray has gathered. Samples that found nothing are added up when the transparency changes, so that leaping over them and
// visiting them give the same bits.
struct Gathered {
    float transparency;
    float light;  // of the samples before `since`
    float since;
    vec3 emitted;
    uint samples;
};

// Adds sample `m`.
void gather(inout Gathered g, float m, float opacity, vec3 emission) {
    g.samples += 1u;
    if (EMISSION) {
        precise vec3 emitted = g.emitted + g.transparency * emission;
        g.emitted = emitted;
    }
    bool shows = opacity > 0.0;
    precise float light = g.light + g.transparency * (m + 1.0 - g.since);
    precise float transparency = g.transparency * (1.0 - opacity);
    g.light = shows ? light : g.light;
    g.since = shows ? m + 1.0 : g.since;
    g.transparency = transparency;
}

// Samples of a ray that lie inside the field: beyond it nothing absorbs or emits. The ray starts in it, or its first sample may
// lie outside already.
uint samples_inside(vec3 start_ix, vec3 step_ix, uint parts) {
    vec3 border = mix(vec3(0.0), volume.field_ix, greaterThan(step_ix, vec3(0.0)));
    vec3 steps = mix((border - start_ix) / step_ix, vec3(FAR_STEPS), equal(step_ix, vec3(0.0)));
    float inside = min(steps.x, min(steps.y, steps.z)) + 0.5;
    return uint(clamp(inside, 0.0, float(parts)));
}

// Light from one direction: rgb with emission, a without; or how many samples that took.
vec4 light_along(vec3 p_ix, int level) {
    float extent_mm = push.radius_mm - push.offset_mm;
    uint parts = uint(max(ceil(push.parts / step_growth(level) - 1e-4), 1.0));
    vec3 step_ix = push.direction_ix * (extent_mm / float(parts));
    vec3 start_ix = p_ix + push.direction_ix * push.offset_mm;
    float unit_exponent = push.exponent_mm * (extent_mm / push.parts);
    float share = push.parts / float(parts);

    float longest_step = max(abs(step_ix.x), max(abs(step_ix.y), abs(step_ix.z)));
    Gathered g = Gathered(1.0, 0.0, 0.0, vec3(0.0), 0u);
    uint shift = heading_of(step_ix).shift;
    uint inside = samples_inside(start_ix, step_ix, parts);
    uint m = 0u;
    if (m < inside) {
        do {
            bool empty;
            do {
                precise vec3 at_ix = start_ix + (float(m) + 0.5) * step_ix;
                at_ix = clamp(at_ix, vec3(0.0), volume.field_ix);
                uint leap = leap_at(at_ix, shift);
                empty = leap > 0u || !brick_at(at_ix).resident;
                // The next leap - 1 cells are empty too. (Where exactly the ray leaves that box is not worth finding out:
                // rays are short.)
                float reach = float(max(int(leap) - 1, 0) * SKIP_CELLS);
                uint run = uint(max(reach / longest_step, 1.0));
                m += empty ? run : 0u;
            } while (empty && m < inside);
            if (m < inside) {
                uint run_end = min(m + LIGHT_RUN, inside);
                do {
                    precise vec3 at_ix = start_ix + (float(m) + 0.5) * step_ix;
                    at_ix = clamp(at_ix, vec3(0.0), volume.field_ix);
                    Brick brick = brick_at(at_ix);
                    Classified c = classify_light(reconstruct_linear(brick, brick_local(brick, at_ix)), unit_exponent);
                    // Coarse bricks take longer samples than the table is made for.
                    float opacity = UNIFORM_GRID ? c.opacity : opacity_over(c.opacity, share);
                    bool hidden = is_hidden(at_ix) || !brick.resident;
                    gather(g, float(m), hidden ? 0.0 : opacity, hidden ? vec3(0.0) : c.emission);
                    ++m;
                } while (m < run_end && g.transparency >= DARK);
            }
        } while (m < inside && g.transparency >= DARK);
    }
    if (COUNT) {
        return vec4(float(g.samples));
    }
    float light = g.light + g.transparency * (float(parts) - g.since);
    return vec4(vec3(light) + g.emitted, light) / float(parts);
}

void main() {
    if (gl_WorkGroupID.x >= push.count) {
        return;
    }
    uvec4 entry = work[push.first + gl_WorkGroupID.x];
    if (!has_sample(entry, gl_LocalInvocationIndex)) {
        return;
    }
    LightSample s = light_sample(entry, listed_sample(entry, gl_LocalInvocationIndex));
    Brick brick = brick_of(s.record);
    vec4 light = light_along(sample_position_ix(brick, s.local), brick.level);
    vec4 mean = push.ray == 0u ? vec4(0.0) : imageLoad(i_light, s.sample_at);
    if (COUNT) {
        imageStore(i_light, s.sample_at, mean + light);
        return;
    }
    light *= push.weight;
    imageStore(i_light, s.sample_at, round_to_half(mean + (light - mean) / float(push.ray + 1u)));
}
