// What the medium scatters towards the eye: of light that comes straight from the lights, and of what was scattered before.
// Includes lights.glsl, reflect.glsl and shadow_ray.glsl first.

// How the light that reaches a sample is known: 0 nothing is in its way, 1 from the swept volume, 2 by rays.
layout(constant_id = SPEC_SHADOWS) const uint SHADOWS = 0;
// There is a volume of scattered light besides what comes straight from the lights.
layout(constant_id = SPEC_SCATTERED) const bool SCATTERED = false;

// Optical depth towards each light, one volume above the other.
layout(set = 0, binding = BINDING_SHADOW) uniform sampler3D t_shadow;
// Mean scattered radiance, weighted by the phase function, towards the eye.
layout(set = 0, binding = BINDING_SCATTERED) uniform sampler3D t_scattered;

// Towards a light, before the channels' factors.
float depth_to_light(uint light, vec3 p_ix, Incident incident) {
    if (SHADOWS == 1u) {
        vec3 last = vec3(medium.shadow_points - 1);
        vec3 at = p_ix / volume.field_ix * last + vec3(0.0, 0.0, float(int(light) * medium.shadow_points.z));
        return textureLod(t_shadow, (at + 0.5) / vec3(textureSize(t_shadow, 0)), 0.0).r;
    }
    if (SHADOWS == 2u) {
        return optical_depth_along(p_ix, ix_from_direction(incident.towards_ws), incident.distance_mm);
    }
    return 0.0;
}

// Radiance per mm that a point scatters towards the eye.
vec3 scattered_source(Brick b, vec3 p_ix, vec3 direction_ws, Matter matter) {
    vec3 p_ws = ws_from_ix(p_ix);
    vec3 albedo = matter.color * medium.albedo;
    vec3 scattering = albedo * medium.extinction * matter.extinction;
    float opacity = opacity_of(matter.extinction * medium.unit_mm);
    vec3 gradient = vec3(0.0);
    if (REFLECTANCE != 0u) {
        gradient = gradient_ws(b, p_ix);
    }
    vec3 source = vec3(0.0);
    for (uint light = 0u; light < medium.light_count; ++light) {
        Incident incident = incident_from(light, p_ws);
        vec3 arriving = incident.irradiance * exp(-medium.extinction * depth_to_light(light, p_ix, incident));
        if (REFLECTANCE == 0u) {
            source += scattering * arriving * phase_function(medium.phase, dot(incident.towards_ws, direction_ws));
        } else {
            source += surface_reflectance(gradient, albedo, opacity, incident.towards_ws, -direction_ws) * arriving;
        }
    }
    if (SCATTERED) {
        vec3 at = p_ix / volume.field_ix * vec3(medium.scatter_points - 1);
        source += scattering * textureLod(t_scattered, (at + 0.5) / vec3(medium.scatter_points), 0.0).rgb;
    }
    return source;
}
