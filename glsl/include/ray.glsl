// Rays through the field, in index space, parametrized in steps.

struct Ray {
    vec3 origin_ix;     // where the ray enters the field, or the eye inside it
    vec3 step_ix;       // one step
    vec3 direction_ws;  // unit
    float enter;        // steps from the eye to `origin_ix`
    float extent;       // steps from there to the exit; < 0: the field is missed
};

// One piece of the ray: sampled at its middle.
struct Segment {
    float middle;  // steps from the ray's origin
    float extent;  // steps
};

// A remainder shorter than this (in steps) is no segment of its own: it is rounding.
const float SHORTEST_SEGMENT = 1e-4;

Ray ray_through(vec2 pixel, FrameParams f, vec3 field_ix) {
    vec3 eye = f.origin_ix + pixel.x * f.origin_dx_ix + pixel.y * f.origin_dy_ix;
    vec3 d = f.direction_ix + pixel.x * f.direction_dx_ix + pixel.y * f.direction_dy_ix;
    vec3 d_ws = f.direction_ws + pixel.x * f.direction_dx_ws + pixel.y * f.direction_dy_ws;
    float scale = 1.0 / length(d_ws);
    Ray ray;
    ray.direction_ws = d_ws * scale;
    ray.step_ix = d * scale;
    bvec3 parallel = equal(ray.step_ix, vec3(0.0));
    vec3 a = mix((vec3(0.0) - eye) / ray.step_ix, vec3(-3.0e38), parallel);
    vec3 b = mix((field_ix - eye) / ray.step_ix, vec3(3.0e38), parallel);
    bvec3 beside = bvec3(uvec3(parallel) & (uvec3(lessThan(eye, vec3(0.0))) | uvec3(greaterThan(eye, field_ix))));
    vec3 near = min(a, b);
    vec3 far = max(a, b);
    ray.enter = max(max(near.x, near.y), max(near.z, 0.0));
    float exit = min(far.x, min(far.y, far.z));
    ray.extent = any(beside) ? -1.0 : exit - ray.enter;
    ray.origin_ix = clamp(eye + ray.enter * ray.step_ix, vec3(0.0), field_ix);
    return ray;
}

// Segments of a ray whose first one is shortened by `shift` in [0, 1) of a step.
uint segment_count(Ray ray, float shift) {
    return ray.extent < 0.0 ? 0u : uint(max(ceil(ray.extent + shift - SHORTEST_SEGMENT), 0.0));
}

Segment segment_of(uint i, uint count, float ray_extent, float shift) {
    float start = max(float(i) - shift, 0.0);
    float end = i + 1u == count ? ray_extent : float(i + 1u) - shift;
    return Segment(0.5 * (start + end), end - start);
}

vec3 ray_position(Ray ray, float steps, vec3 field_ix) {
    precise vec3 p = ray.origin_ix + steps * ray.step_ix;
    return clamp(p, vec3(0.0), field_ix);
}
