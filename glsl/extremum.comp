#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#extension GL_EXT_shader_image_load_formatted : require
// Projections of values, classified at the end: the largest, the smallest or the mean sample of each ray.

#include "bindings.glsl"
#include "structs.glsl"
#include "volume.glsl"
#include "reconstruct.glsl"
#include "classify.glsl"
#include "skip.glsl"
#include "random.glsl"
#include "ray.glsl"
#include "target.glsl"
#include "frame.glsl"
#include "labels.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

const uint MAXIMUM = 0u;
const uint MINIMUM = 1u;
const uint MEAN = 2u;
layout(constant_id = SPEC_PROJECTION) const uint PROJECTION = 0;

// Smallest and largest texture sample in each skip cell.
layout(set = 0, binding = BINDING_RANGE) uniform sampler3D t_range;

struct Found {
    float value;   // texture sample; of the mean, times length so far
    float steps;   // where; of the mean, length so far
    uint samples;
};

bool is_better(float value, float than) {
    return PROJECTION == MINIMUM ? value < than : value > than;
}

// True when nothing in a skip cell can change what was found.
bool is_beaten(vec3 p_ix, Found found) {
    if (SKIPPING) {
        if (PROJECTION != MEAN) {
            vec2 range = texelFetch(t_range, skip_cell_of(p_ix), 0).rg;
            return found.samples > 0u && !is_better(PROJECTION == MINIMUM ? range.x : range.y, found.value);
        }
    }
    return false;
}

void add(inout Found found, float value, Segment segment) {
    if (PROJECTION == MEAN) {
        precise float sum = found.value + value * segment.extent;
        precise float length = found.steps + segment.extent;
        found.value = sum;
        found.steps = length;
    } else {
        bool better = found.samples == 0u || is_better(value, found.value);
        found.value = better ? value : found.value;
        found.steps = better ? segment.middle : found.steps;
    }
    found.samples += 1u;
}

Found search(Ray ray, float shift) {
    Found found = Found(0.0, 0.0, 0u);
    uint count = segment_count(ray, shift);
    Heading heading = heading_of(ray.step_ix);
    uint i = 0u;
    if (i < count) {
        do {
            Brick b;
            bool passed;
            uint run_end;
            do {
                vec3 p_ix = ray_position(ray, segment_of(i, count, ray.extent, shift).middle, volume.field_ix);
                b = brick_at(p_ix);
                vec3 border_ix = border_of(skip_cell_of(p_ix), 1.0, float(SKIP_CELLS), heading);
                uint run = samples_before(steps_to_border(p_ix, heading, border_ix));
                run_end = min(i + run, count);
                passed = is_beaten(p_ix, found) || !b.resident;
                i = passed ? run_end : i;
            } while (passed && i < count);
            if (i < run_end) {
                do {
                    Segment segment = segment_of(i, count, ray.extent, shift);
                    vec3 p_ix = ray_position(ray, segment.middle, volume.field_ix);
                    if (!is_hidden(p_ix)) {
                        add(found, reconstruct(b, p_ix), segment);
                    }
                    ++i;
                } while (i < run_end);
            }
        } while (i < count);
    }
    if (PROJECTION == MEAN) {
        found.value /= max(found.steps, 1e-30);
    }
    return found;
}

void main() {
    uvec2 px = frame_pixel();
    if (is_outside(px)) {
        return;
    }
    Ray ray = frame_ray(px);
    Found found = search(ray, frame_shift(px));
    vec4 color = vec4(0.0);
    float depth = uintBitsToFloat(0x7f800000u);
    float value = uintBitsToFloat(0x7fc00000u);
    if (found.samples > 0u) {
        // The table is made for the unit distance here: a value has no length.
        Classified c = classify(found.value, 1.0);
        color = vec4((c.color + c.emission) * c.opacity, c.opacity);
        depth = PROJECTION == MEAN ? depth : depth_mm(ray, found.steps);
        value = frame.value_from_sample * found.value + frame.value_offset;
    }
    frame_store(px, color, vec4(depth, float(found.samples), depth, value));
}
