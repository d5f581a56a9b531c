// What the transfer function makes of a segment along which the value runs linearly, from a table over the values at its ends
// (Engel, Kraus and Ertl 2001). The table's axes are linear over the transfer function's range, 4/5 of the table, and compress
// what lies beyond on either side into the rest.

layout(set = 0, binding = BINDING_PREINTEGRATED) uniform sampler2D t_preintegrated;
layout(set = 0, binding = BINDING_PREINTEGRATED_EMISSION) uniform sampler2D t_preintegrated_emission;

// Where the compressed ends begin, in ranges of the transfer function, and how fast they saturate.
const float TABLE_TAIL = 0.125;

// Place of a texture sample on an axis of the table, in texels.
float table_place(float value) {
    float t = (value - volume.table_first) * volume.table_from_sample;
    float inside = clamp(t, 0.0, 1.0);
    float beyond = t - inside;
    float x = inside + beyond / (1.0 + abs(beyond) / TABLE_TAIL);
    return (x + TABLE_TAIL) * (volume.table_last / (1.0 + 2.0 * TABLE_TAIL));
}

// By hand: a texture unit's weights are too coarse, and a place on an entry must not see its neighbour, or empty space would not
// be empty.
vec4 table_between(sampler2D table, ivec2 i, vec2 f) {
    vec4 low = mix(texelFetch(table, i, 0), texelFetch(table, i + ivec2(1, 0), 0), f.x);
    vec4 high = mix(texelFetch(table, i + ivec2(0, 1), 0), texelFetch(table, i + ivec2(1, 1), 0), f.x);
    return mix(low, high, f.y);
}

// A whole step from one value to another; places from table_place.
Classified classify_step(float front, float back) {
    vec2 at = vec2(front, back);
    ivec2 i = ivec2(min(at, vec2(volume.table_last - 1.0)));
    vec2 f = at - vec2(i);
    vec4 step = table_between(t_preintegrated, i, f);
    // The table holds associated colours, which is what can be interpolated.
    float per_opacity = step.a > 0.0 ? 1.0 / step.a : 0.0;
    Classified c = Classified(step.rgb * per_opacity, vec3(0.0), step.a);
    if (EMISSION) {
        c.emission = table_between(t_preintegrated_emission, i, f).rgb * per_opacity;
    }
    return c;
}
