// Fixture of tests/shaders.rs: one of each thing that is reflected.
// fixture.spv: glslc -O0 --target-env=vulkan1.2 fixture.comp -o fixture.spv
#version 460

struct Block {
    uvec3 origin_ix;
    uint level;
};

layout(constant_id = 7) const uint STEPS = 4;
layout(local_size_x = 8, local_size_y = 4) in;

layout(set = 0, binding = 0) uniform Frame {
    mat4 world_from_clip;
    vec3 eye_ws;
    float step_ws;
} u_frame;
layout(set = 0, binding = 1) readonly buffer Blocks { Block b_blocks[]; };
layout(set = 0, binding = 2) buffer Requests {
    uint count;
    uint capacity;
    uint blocks[];
} b_requests;
layout(set = 1, binding = 0) uniform sampler3D t_density;
layout(set = 1, binding = 3, rgba32f) writeonly uniform image2D i_color;

layout(push_constant) uniform FixturePush {
    uvec2 tile_px;
    uint frame;
} pc;

void main() {
    ivec2 pixel = ivec2(pc.tile_px + gl_GlobalInvocationID.xy);
    vec4 position_ws = u_frame.world_from_clip * vec4(vec2(pixel), 0.0, 1.0);
    Block block = b_blocks[pc.frame];
    vec3 texel = (position_ws.xyz - u_frame.eye_ws) * u_frame.step_ws + vec3(block.origin_ix);
    float sum = 0.0;
    for (uint i = 0; i < STEPS; ++i) {
        sum += textureLod(t_density, texel, float(block.level)).r;
    }
    if (b_requests.count < b_requests.capacity) {
        b_requests.blocks[b_requests.count] = block.level;
    }
    imageStore(i_color, pixel, vec4(sum));
}
