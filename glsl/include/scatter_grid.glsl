// The grid on which scattered light is computed: its points, and what the medium is around them. Includes medium.glsl first.

layout(push_constant) uniform Push { ScatterPush push; };

// Scattering (rgb) and extinction (a) per mm, averaged over the cell of a point, before the channels' factors.
layout(set = 0, binding = BINDING_GRID_MEDIUM) uniform sampler3D t_grid_medium;
// Radiance per mm that is emitted there.
layout(set = 0, binding = BINDING_GRID_EMISSION) uniform sampler3D t_grid_emission;

// Nothing has been scattered yet.
const uint FIRST = 1u;
// The medium attenuates nothing.
const uint UNATTENUATED = 2u;
// Only light from around the volume is wanted: nothing is scattered or emitted on the way.
const uint SURROUNDINGS = 4u;

bool has(uint flag) {
    return (push.flags & flag) != 0u;
}

vec3 grid_cells() {
    return vec3(medium.scatter_points - 1);
}

vec3 grid_position(ivec3 point) {
    return vec3(point) / grid_cells() * volume.field_ix;
}

vec3 grid_scattering(ivec3 point) {
    return texelFetch(t_grid_medium, point, 0).rgb * medium.extinction;
}

vec3 grid_extinction(ivec3 point) {
    return has(UNATTENUATED) ? vec3(0.0) : texelFetch(t_grid_medium, point, 0).a * medium.extinction;
}

vec3 grid_emission(ivec3 point) {
    return texelFetch(t_grid_emission, point, 0).rgb;
}
