// Paths against the light through the medium. Includes lights.glsl, track.glsl and frame.glsl first.

// Scatterings before paths may end by chance.
const uint CERTAIN = 6u;

struct Path {
    vec3 radiance;
    vec3 weight;
    vec3 through;   // of the background
    uint samples;
};

vec3 direction_around(vec3 axis, float cosine, float turn) {
    vec3 other = abs(axis.z) < 0.9 ? vec3(0.0, 0.0, 1.0) : vec3(1.0, 0.0, 0.0);
    vec3 u = normalize(cross(other, axis));
    vec3 v = cross(axis, u);
    float sine = sqrt(max(1.0 - cosine * cosine, 0.0));
    return normalize(sine * (cos(turn) * u + sin(turn) * v) + cosine * axis);
}

// Scatters light that is to travel along `outgoing_ws` backwards; `weight` is multiplied by phase function over density.
vec3 scattered_direction(vec3 outgoing_ws, inout Random random, inout vec3 weight) {
    float cosine;
    float g = medium.phase.x;
    switch (PHASE) {
    case 0u:
        cosine = 2.0 * next_random(random) - 1.0;
        break;
    case 2u:
        g = next_random(random) < medium.phase.z ? medium.phase.x : medium.phase.y;
        // Then as one lobe.
    case 1u: {
        float share = next_random(random);
        // The usual form divides by g; this one has no 0/0.
        float t = 1.0 - g + 2.0 * g * share;
        cosine = 0.5 * (g + (2.0 * share - 1.0 + g) * ((1.0 - g * g) / t + 1.0) / t);
        break;
    }
    default: {
        float columns = float(textureSize(t_phase, 0).x - 1);
        float place = next_random(random) * columns;
        int column = min(int(place), int(columns) - 1);
        float low = texelFetch(t_phase, ivec2(column, 0), 0).r;
        float high = texelFetch(t_phase, ivec2(column + 1, 0), 0).r;
        cosine = mix(low, high, place - float(column));
        weight *= phase_function(medium.phase, cosine) * 2.0 * PI * (high - low) * columns;
    }
    }
    cosine = clamp(cosine, -1.0, 1.0);
    return direction_around(outgoing_ws, cosine, 2.0 * PI * next_random(random));
}

// Light that one of the lights, taken by chance, sends to a point and that is scattered into `-direction_ws`.
vec3 light_scattered(vec3 p_ix, vec3 direction_ws, inout Random random) {
    uint light = min(uint(next_random(random) * float(medium.light_count)), medium.light_count - 1u);
    Incident incident = incident_from(light, ws_from_ix(p_ix));
    float scattered = phase_function(medium.phase, dot(incident.towards_ws, direction_ws)) * float(medium.light_count);
    vec3 arriving = incident.irradiance * scattered;
    if (max(arriving.r, max(arriving.g, arriving.b)) > 0.0) {
        arriving *= tracked_transmittance(flight_from(p_ix, incident.towards_ws, incident.distance_mm), random);
    }
    return arriving;
}

// A real collision at a point: what is emitted and scattered there. False where the path ends.
bool collide(inout Path path, vec3 p_ix, Matter matter, inout vec3 direction_ws, uint scatterings, inout Random random) {
    path.radiance += path.weight * matter.emission;
    if (float(scatterings) >= medium.tracking.z) {
        return false;
    }
    path.weight *= matter.color * medium.albedo;
    // A path of no weight meets no light either: by the number of lights alone lavapipe would compile this anew at every dispatch.
    float lit = float(medium.light_count) * max(path.weight.r, max(path.weight.g, path.weight.b));
    if (lit > 0.0) {
        path.radiance += path.weight * light_scattered(p_ix, direction_ws, random);
    }
    direction_ws = scattered_direction(direction_ws, random, path.weight);
    float most = max(path.weight.r, max(path.weight.g, path.weight.b));
    if (scatterings >= CERTAIN && most < 1.0) {
        float survival = max(most, 0.05);
        if (next_random(random) >= survival) {
            return false;
        }
        path.weight /= survival;
    }
    return most > 0.0;
}

void trace(inout Path path, Ray ray, inout Random random) {
    vec3 direction_ws = ray.direction_ws;
    Flight flight = flight_from(ray.origin_ix, direction_ws, max(ray.extent, 0.0) * frame.step_mm);
    uint scatterings = 0u;
    bool alive = true;
    while (alive) {
        float majorant = next_collision(flight, random);
        if (majorant <= 0.0) {
            if (scatterings == 0u) {
                path.through = path.weight;
            } else {
                path.radiance += path.weight * environment_radiance(direction_ws);
            }
            alive = false;
        } else {
            vec3 p_ix = flight_position(flight);
            Brick b = brick_at(p_ix);
            Matter matter = matter_at(b, p_ix);
            matter.extinction = b.resident ? matter.extinction : 0.0;
            matter.source = b.resident ? matter.source : vec3(0.0);
            path.samples += 1u;
            if (GLOWS) {
                path.radiance += path.weight * matter.source / majorant;
            }
            float real = clamp(matter.extinction * largest_factor() / majorant, 0.0, 1.0);
            if (next_random(random) < real) {
                path.weight *= medium.extinction / largest_factor();
                alive = collide(path, p_ix, matter, direction_ws, scatterings, random);
                scatterings += 1u;
                flight = flight_from(p_ix, direction_ws, FAR_MM);
            } else {
                path.weight *= max(majorant - medium.extinction * matter.extinction, vec3(0.0)) / (majorant * (1.0 - real));
            }
        }
    }
}
