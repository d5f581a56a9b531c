// Rays of local ambient occlusion, and what they gather. Includes reconstruct.glsl, classify.glsl, skip.glsl and labels.glsl first,
// and names the push constants.

// Transparency below which the rest of a ray cannot matter: it adds less than this to the light.
const float DARK = 1e-5;

// Growth of the step for coarse bricks: 1 at the finest level, 8.5 at level 0.
float step_growth(int level) {
    float resolution = float(1 << level);
    return (16.0 + resolution) / (2.0 * resolution);
}

// Parts of a run that starts where something shows; the same for all rays, so that neighbours stay in step.
const uint LIGHT_RUN = 4u;

// What a ray has gathered. Parts that found nothing are added up when the transparency changes, so that leaping over them and
// visiting them give the same bits.
struct Gathered {
    float transparency;
    float light;  // of the parts before `since`
    float since;
    vec3 emitted;
    uint samples; // of the field
};

// Adds part `m`.
void gather(inout Gathered g, float m, float opacity, vec3 emission) {
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

struct LightRay {
    vec3 start_ix;
    vec3 step_ix;         // a part
    uint parts;
    uint inside;          // parts whose middles lie in the field
    float unit_exponent;  // of a part at the finest level
    float share;          // of a part, in those
    float longest_step;   // on any axis
    uint shift;           // for leaps
};

// Parts of a ray that lie inside the field: beyond it nothing absorbs or emits. The ray starts in it, or its first sample may
// lie outside already.
uint parts_inside(vec3 start_ix, vec3 step_ix, uint parts) {
    vec3 border = mix(vec3(0.0), volume.field_ix, greaterThan(step_ix, vec3(0.0)));
    vec3 steps = mix((border - start_ix) / step_ix, vec3(FAR_STEPS), equal(step_ix, vec3(0.0)));
    float inside = min(steps.x, min(steps.y, steps.z)) + 0.5;
    return uint(clamp(inside, 0.0, float(parts)));
}

LightRay light_ray(vec3 p_ix, int level) {
    LightRay ray;
    float extent_mm = push.radius_mm - push.offset_mm;
    ray.parts = uint(max(ceil(push.parts / step_growth(level) - 1e-4), 1.0));
    ray.step_ix = push.direction_ix * (extent_mm / float(ray.parts));
    ray.start_ix = p_ix + push.direction_ix * push.offset_mm;
    ray.unit_exponent = push.exponent_mm * (extent_mm / push.parts);
    ray.share = push.parts / float(ray.parts);
    ray.longest_step = max(abs(ray.step_ix.x), max(abs(ray.step_ix.y), abs(ray.step_ix.z)));
    ray.shift = heading_of(ray.step_ix).shift;
    ray.inside = parts_inside(ray.start_ix, ray.step_ix, ray.parts);
    return ray;
}

vec3 middle_of_part(LightRay ray, float m) {
    precise vec3 at_ix = ray.start_ix + (m + 0.5) * ray.step_ix;
    return clamp(at_ix, vec3(0.0), volume.field_ix);
}

// True where nothing shows; `ahead`: parts from here on of which that is known, this one apart. (Where exactly the ray leaves
// an empty box is not worth finding out: rays are short.)
bool is_empty(LightRay ray, vec3 at_ix, out float ahead) {
    uint leap = leap_at(at_ix, ray.shift);
    // The next leap - 1 cells are empty too.
    ahead = float(max(int(leap) - 1, 0) * SKIP_CELLS) / ray.longest_step;
    return leap > 0u || !brick_at(at_ix).resident;
}

// Emission, and opacity over a part, of a value.
vec4 light_of_value(LightRay ray, Brick brick, vec3 at_ix, float value) {
    Classified c = classify_light(value, ray.unit_exponent);
    // Coarse bricks take longer samples than the table is made for.
    float opacity = UNIFORM_GRID ? c.opacity : opacity_over(c.opacity, ray.share);
    bool hidden = is_hidden(at_ix) || !brick.resident;
    return hidden ? vec4(0.0) : vec4(c.emission, opacity);
}

vec4 light_sample_at(LightRay ray, vec3 at_ix) {
    Brick brick = brick_at(at_ix);
    return light_of_value(ray, brick, at_ix, reconstruct_linear(brick, brick_local(brick, at_ix)));
}

// Two at once, of packed corners (packed_linear_pair).
vec4[2] light_samples_at(LightRay ray, vec3 first_ix, vec3 second_ix) {
    Brick first = brick_at(first_ix);
    Brick second = brick_at(second_ix);
    vec2 values = reconstruct_pair(first, first_ix, second, second_ix);
    return vec4[](
        light_of_value(ray, first, first_ix, values.x), light_of_value(ray, second, second_ix, values.y));
}

// Gathers part `m`, or that and the next one if it comes before `end`. Returns the next one.
uint gather_some(inout Gathered g, LightRay ray, uint m, uint end) {
    vec3 at_ix = middle_of_part(ray, float(m));
    if (PACKED_CELLS != 0u) {
        vec4 here[2] = light_samples_at(ray, at_ix, middle_of_part(ray, float(m + 1u)));
        bool on = true;
        [[unroll]] for (int n = 0; n < 2; ++n) {
            here[n] = on ? here[n] : vec4(0.0);
            g.samples += uint(on);
            gather(g, float(m) + float(n), here[n].a, here[n].rgb);
            on = m + 1u < end && g.transparency >= DARK;
        }
        return min(m + 2u, end);
    }
    vec4 here = light_sample_at(ray, at_ix);
    g.samples += 1u;
    gather(g, float(m), here.a, here.rgb);
    return m + 1u;
}

// A sample in every part.
void gather_uniform(inout Gathered g, LightRay ray) {
    uint m = 0u;
    if (m < ray.inside) {
        do {
            bool empty;
            do {
                float ahead;
                empty = is_empty(ray, middle_of_part(ray, float(m)), ahead);
                m += empty ? uint(max(ahead, 1.0)) : 0u;
            } while (empty && m < ray.inside);
            if (m < ray.inside) {
                uint run_end = min(m + LIGHT_RUN, ray.inside);
                do {
                    m = gather_some(g, ray, m, run_end);
                } while (m < run_end && g.transparency >= DARK);
            }
        } while (m < ray.inside && g.transparency >= DARK);
    }
}
