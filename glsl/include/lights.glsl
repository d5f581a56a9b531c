// Lights of a scene. Includes medium.glsl and phase.glsl first.

// 0 none, 1 the same radiance from everywhere, 2 a map.
layout(constant_id = SPEC_ENVIRONMENT) const uint ENVIRONMENT = 0;

layout(set = 0, binding = BINDING_ENVIRONMENT) uniform sampler2D t_environment;

// What arrives at a point from one light when nothing is in its way.
struct Incident {
    vec3 towards_ws;    // unit
    float distance_mm;  // FAR_MM for parallel light
    vec3 irradiance;
};

const float FAR_MM = 3.0e38;

Incident incident_from(uint light, vec3 p_ws) {
    vec4 place = medium.light_place[light];
    vec4 color = medium.light_color[light];
    if (place.w == 0.0) {
        return Incident(place.xyz, FAR_MM, color.rgb);
    }
    vec3 d = place.xyz - p_ws;
    float square = max(dot(d, d), 1e-12);
    vec3 towards = d * inversesqrt(square);
    vec4 axis = medium.light_axis[light];
    float angle = acos(clamp(dot(-towards, axis.xyz), -1.0, 1.0));
    float falloff = color.w > 0.0 ? clamp((color.w - angle) / (color.w - axis.w), 0.0, 1.0) : 1.0;
    return Incident(towards, sqrt(square), color.rgb * (falloff / square));
}

// Radiance that comes from a direction (`towards_ws`: where one looks to see it).
vec3 environment_radiance(vec3 towards_ws) {
    if (ENVIRONMENT == 0u) {
        return vec3(0.0);
    }
    if (ENVIRONMENT == 1u) {
        return medium.environment.rgb;
    }
    vec3 d = vec3(
        dot(medium.environment_x.xyz, towards_ws),
        dot(medium.environment_y.xyz, towards_ws),
        dot(medium.environment_z.xyz, towards_ws));
    ivec2 size = textureSize(t_environment, 0);
    // The middle column lies towards x, columns run clockwise seen from above.
    float u = 0.5 - atan(d.y, d.x) / (2.0 * PI);
    float v = acos(clamp(d.z, -1.0, 1.0)) / PI;
    vec2 at = vec2(u, v) * vec2(size) - 0.5;
    vec2 f = at - floor(at);
    ivec2 i = ivec2(floor(at));
    // Around in columns, not over the poles; by hand, since 32-bit floats need not be filterable.
    ivec2 x = ivec2((i.x + size.x) % size.x, (i.x + 1) % size.x);
    ivec2 y = clamp(ivec2(i.y, i.y + 1), ivec2(0), ivec2(size.y - 1));
    vec3 upper = mix(texelFetch(t_environment, ivec2(x.x, y.x), 0).rgb, texelFetch(t_environment, ivec2(x.y, y.x), 0).rgb, f.x);
    vec3 lower = mix(texelFetch(t_environment, ivec2(x.x, y.y), 0).rgb, texelFetch(t_environment, ivec2(x.y, y.y), 0).rgb, f.x);
    return mix(upper, lower, f.y) * medium.environment.rgb;
}
