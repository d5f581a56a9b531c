// Samples that lie farther apart the farther out they are; parts between them are interpolated (src/occlusion.rs).
// Includes light_ray.glsl first.

// Share of the light that the rest of a ray may matter by without being sampled, where nothing glows.
const float FAINT = 1e-3;

// Part in which sample `n` lies.
float part_of(float n) {
    precise float part = n * (1.0 + 0.5 * push.growth * (n - 1.0)) + 1e-3;
    return floor(part);
}

// A sample such that all before it lie before part `m`.
float sample_behind(float m) {
    float first = 1.0 - 0.5 * push.growth;
    return floor(2.0 * m / (first + sqrt(first * first + 2.0 * push.growth * m)));
}

// Adds the parts behind `p` up to `q`, of which the samples `near` and `here` are known, and `far` in part `f` before them: between
// samples stands the mean of the line through two and the parabola through three. Without `far`, `f` is `p`.
void gather_between(inout Gathered g, float f, float p, float q, vec4 far, vec4 near, vec4 here) {
    precise vec4 slope = (here - near) / (q - p);
    precise vec4 bend = f < p ? 0.5 * (slope - (near - far) / (p - f)) / (q - f) : vec4(0.0);
    float m = p;
    do {
        m += 1.0;
        precise vec4 between = near + (m - p) * (slope + bend * (m - q));
        vec4 part = m < q ? max(between, vec4(0.0)) : here;
        gather(g, m, min(part.a, 1.0), part.rgb);
    } while (m < q);
}

void gather_growing(inout Gathered g, LightRay ray) {
    float inside = float(ray.inside);
    // Nothing lies behind the last part, so that it needs no sample of its own.
    float end = min(inside, max(float(ray.parts) - 1.0, 1.0));
    // The next sample, its part, and the two samples before it with theirs.
    float n = 0.0;
    float q = 0.0;
    float p = -1.0;
    float f = -1.0;
    vec4 near = vec4(0.0);
    vec4 far = vec4(0.0);
    bool bright = true;
    float faint = FAINT;
    if (EMISSION) {
        faint = DARK;
    }
    if (q < end) {
        do {
            bool empty;
            do {
                float ahead;
                empty = is_empty(ray, middle_of_part(ray, q), ahead);
                // What falls to nothing here is gathered; beyond, nothing is.
                if (empty && near != vec4(0.0)) {
                    gather_between(g, f, p, q, far, near, vec4(0.0));
                }
                float next = empty ? max(sample_behind(q + ahead), n + 1.0) : n;
                far = empty ? (next > n + 1.0 ? vec4(0.0) : near) : far;
                near = empty ? vec4(0.0) : near;
                p = empty ? part_of(next - 1.0) : p;
                f = empty ? (next < 2.0 ? p : part_of(next - 2.0)) : f;
                n = next;
                q = part_of(n);
            } while (empty && q < end);
            if (q < end) {
                float run_end = min(q + float(LIGHT_RUN), end);
                do {
                    vec4 here = light_sample_at(ray, middle_of_part(ray, q));
                    g.samples += 1u;
                    gather_between(g, f, p, q, far, near, here);
                    // Decided where something shows: leaping over the rest and visiting it give the same bits.
                    bright = here.a <= 0.0 || g.transparency * (float(ray.parts) - q) >= faint * float(ray.parts);
                    far = near;
                    near = here;
                    f = n < 1.0 ? q : p;
                    p = q;
                    n += 1.0;
                    q = part_of(n);
                } while (q < run_end && bright);
            }
        } while (q < end && bright);
        // The last sample stands for the rest.
        if (p + 1.0 < inside && near != vec4(0.0)) {
            gather_between(g, p, p, inside - 1.0, near, near, near);
        }
    }
}
