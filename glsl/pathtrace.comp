#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#extension GL_EXT_shader_image_load_formatted : require
// Multiple scattering by Monte Carlo: one more path from every pixel, traced against the light, added to those before.

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
#include "medium.glsl"
#include "phase.glsl"
#include "lights.glsl"
#include "track.glsl"
#include "path.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

// Sums over the paths of a pixel: radiance, its square, and what came straight through.
layout(set = 0, binding = BINDING_PATHS_SUM, rgba32f) uniform image2D i_paths_sum;
layout(set = 0, binding = BINDING_PATHS_SQUARE, rgba32f) uniform image2D i_paths_square;
layout(set = 0, binding = BINDING_PATHS_THROUGH, rgba32f) uniform image2D i_paths_through;

void main() {
    uvec2 px = frame_pixel();
    if (is_outside(px)) {
        return;
    }
    Random random = random_sequence(px, frame.frame, frame.jitter_seed);
    vec2 within = vec2(next_random(random), next_random(random));
    Ray ray = frame_ray_through(px, within);
    Path path = Path(vec3(0.0), vec3(1.0), vec3(1.0), 0u);
    path.through = ray.extent < 0.0 ? vec3(1.0) : vec3(0.0);
    if (ray.extent >= 0.0) {
        trace(path, ray, random);
    }
    bool surrounded = ENVIRONMENT != 0u && medium.environment.w > 0.0;
    if (SCENE_DEPTH) {
        surrounded = surrounded && steps_to_scene(ivec2(px), ray) == FAR_STEPS;
    }
    if (surrounded) {
        path.radiance += path.through * environment_radiance(ray.direction_ws);
        path.through = vec3(0.0);
    }
    // The first path finds whatever the images held before. Selected, not branched on: lavapipe compiles branches by a uniform alone
    // anew at every dispatch.
    bvec4 first = bvec4(frame.frame == 0u);
    vec4 sum = vec4(path.radiance, 0.0) + mix(imageLoad(i_paths_sum, ivec2(px)), vec4(0.0), first);
    vec4 square = vec4(path.radiance * path.radiance, 0.0) + mix(imageLoad(i_paths_square, ivec2(px)), vec4(0.0), first);
    vec4 through = vec4(path.through, float(path.samples)) + mix(imageLoad(i_paths_through, ivec2(px)), vec4(0.0), first);
    imageStore(i_paths_sum, ivec2(px), sum);
    imageStore(i_paths_square, ivec2(px), square);
    imageStore(i_paths_through, ivec2(px), through);
    float share = 1.0 / float(frame.frame + 1u);
    vec3 mean_through = through.rgb * share;
    float opacity = surrounded ? 1.0 : 1.0 - dot(mean_through, vec3(1.0 / 3.0));
    float far = uintBitsToFloat(0x7f800000u);
    frame_store_through(px, vec4(sum.rgb * share, opacity), mean_through, vec4(far, through.a, far, far));
}
