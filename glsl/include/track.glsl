// Null-collision tracking through the medium (Woodcock et al. 1965; Novák, Selle, Jarosz 2014 for transmittance). Includes
// medium.glsl, skip.glsl and random.glsl first.

// One majorant for the whole volume instead of one for each skip cell.
layout(constant_id = SPEC_GLOBAL_MAJORANT) const bool GLOBAL_MAJORANT = false;

// Largest extinction of each skip cell, per mm, before the channels' factors.
layout(set = 0, binding = BINDING_MAJORANT) uniform sampler3D t_majorant;

// A way through the field, in mm.
struct Flight {
    vec3 origin_ix;
    vec3 d_ix;       // index units per mm
    Heading heading;
    float at_mm;
    float reach_mm;
};

Flight flight_from(vec3 p_ix, vec3 direction_ws, float length_mm) {
    vec3 d_ix = ix_from_direction(direction_ws);
    return Flight(p_ix, d_ix, heading_of(d_ix), 0.0, min(distance_to_exit(p_ix, d_ix), length_mm));
}

vec3 flight_position(Flight flight) {
    return clamp(flight.origin_ix + flight.at_mm * flight.d_ix, vec3(0.0), volume.field_ix);
}

// (A function: reflection does not evaluate negations of specialization constants.)
bool is_global() {
    bool global = GLOBAL_MAJORANT;
    return global;
}

float largest_factor() {
    return max(medium.extinction.r, max(medium.extinction.g, medium.extinction.b));
}

// Goes on to the next tentative collision. Its density, per mm; 0: the flight left the field, or reached its end, first.
float next_collision(inout Flight flight, inout Random random) {
    float left = -log(1.0 - next_random(random));
    float least_mm = 1e-5 / length(flight.d_ix);
    while (flight.at_mm < flight.reach_mm) {
        vec3 p_ix = flight_position(flight);
        float majorant = medium.tracking.x;
        float ahead = flight.reach_mm - flight.at_mm;
        if (!is_global()) {
            ivec3 cell = skip_cell_of(p_ix);
            uint leap = leap_from(skip_word(cell), flight.heading.shift);
            majorant = leap > 0u ? 0.0 : max(texelFetch(t_majorant, cell, 0).r, medium.tracking.y);
            // To the border and, whatever the size of the numbers, a little beyond it.
            vec3 border = border_of(cell, float(max(leap, 1u)), float(SKIP_CELLS), flight.heading);
            vec3 to_border = mix((border - p_ix) * flight.heading.steps_per_ix, vec3(FAR_STEPS), flight.heading.still);
            float inside = max(min(to_border.x, min(to_border.y, to_border.z)), 0.0);
            ahead = min(ahead, inside + max(least_mm, 4e-7 * (flight.at_mm + inside)));
        }
        majorant *= largest_factor();
        if (left < majorant * ahead) {
            flight.at_mm += left / majorant;
            return majorant;
        }
        left -= majorant * ahead;
        flight.at_mm += ahead;
    }
    return 0.0;
}

// Share of each channel's light that comes through, by ratio tracking.
vec3 tracked_transmittance(Flight flight, inout Random random) {
    vec3 through = vec3(1.0);
    while (max(through.r, max(through.g, through.b)) > 0.0) {
        float majorant = next_collision(flight, random);
        if (majorant <= 0.0) {
            break;
        }
        float extinction = extinction_at(flight_position(flight));
        through *= max(1.0 - medium.extinction * (extinction / majorant), vec3(0.0));
        // What is left of little is decided by chance.
        float most = max(through.r, max(through.g, through.b));
        if (most < 0.05) {
            through = next_random(random) < 0.5 ? vec3(0.0) : 2.0 * through;
        }
    }
    return through;
}
