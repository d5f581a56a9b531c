// What comes straight from the lights to a point of the grid of scattered light. Includes lights.glsl and scatter_grid.glsl first.

// Optical depth towards each light, one volume above the other.
layout(set = 0, binding = BINDING_SHADOW) uniform sampler3D t_shadow;

vec3 swept_through(uint light, vec3 p_ix) {
    vec3 last = vec3(medium.shadow_points - 1);
    vec3 at = p_ix / volume.field_ix * last + vec3(0.0, 0.0, float(int(light) * medium.shadow_points.z));
    return exp(-medium.extinction * textureLod(t_shadow, (at + 0.5) / vec3(textureSize(t_shadow, 0)), 0.0).r);
}

vec3 direct_fluence(ivec3 point) {
    vec3 p_ix = grid_position(point);
    vec3 sum = vec3(0.0);
    for (uint light = 0u; light < medium.light_count; ++light) {
        sum += incident_from(light, ws_from_ix(p_ix)).irradiance * swept_through(light, p_ix);
    }
    return sum;
}

// Scattered into a direction.
vec3 direct_scattered(ivec3 point, vec3 direction_ws) {
    vec3 p_ix = grid_position(point);
    vec3 sum = vec3(0.0);
    for (uint light = 0u; light < medium.light_count; ++light) {
        Incident incident = incident_from(light, ws_from_ix(p_ix));
        float phase = phase_function(medium.phase, dot(-incident.towards_ws, direction_ws));
        sum += incident.irradiance * swept_through(light, p_ix) * phase;
    }
    return sum;
}
