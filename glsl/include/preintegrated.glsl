// What the transfer function makes of a segment along which the value runs linearly, from a table over the values at its ends
// (Engel, Kraus and Ertl 2001). Entries lie where the transfer function needs them (src/atlas/preintegration.rs); row 4 of the
// transfer table tells where on an axis each of its bins starts and ends. Values beyond the function's range go to compressed ends.

layout(set = 0, binding = BINDING_PREINTEGRATED) uniform sampler2D t_preintegrated;
layout(set = 0, binding = BINDING_PREINTEGRATED_EMISSION) uniform sampler2D t_preintegrated_emission;
layout(set = 0, binding = BINDING_PREINTEGRATED_LOADS, rgba32f) uniform readonly image2D i_preintegrated;
layout(set = 0, binding = BINDING_PREINTEGRATED_EMISSION_LOADS, rgba32f) uniform readonly image2D i_preintegrated_emission;

const int PLACE_ROW = 4;
// Cells that each compressed end of an axis takes.
const float TAIL_CELLS = 64.0;

// Place of a texture sample on an axis of the table, in texels.
float table_place(float value) {
    float x = (value - volume.first_sample) * volume.bin_from_sample;
    float inner = volume.last_bin - 1.0;
    float inside = clamp(x, 0.0, inner);
    float bin = min(floor(inside), inner - 1.0);
    vec2 ends = transfer_texel(int(bin) + 1, PLACE_ROW).rg;
    float place = mix(ends.x, ends.y, inside - bin);
    float beyond = (x - inside) * volume.table_tail;
    place = x < 0.0 ? TAIL_CELLS : x >= inner ? volume.table_end : place;
    return place + beyond / (1.0 + abs(beyond) / TAIL_CELLS);
}

// By hand: a texture unit's weights are too coarse, and a place on an entry must not see its neighbour, or empty space would not
// be empty.
// (A macro: reflection does not follow images into functions.)
#define TABLE_BETWEEN(texel, i, f) \
    mix(mix(texel(i), texel(i + ivec2(1, 0)), f.x), mix(texel(i + ivec2(0, 1)), texel(i + ivec2(1, 1)), f.x), f.y)

vec4 table_texel(ivec2 i) {
    return LOADS ? imageLoad(i_preintegrated, i) : texelFetch(t_preintegrated, i, 0);
}

vec4 table_emission_texel(ivec2 i) {
    return LOADS ? imageLoad(i_preintegrated_emission, i) : texelFetch(t_preintegrated_emission, i, 0);
}

// A whole step from one value to another; places from table_place.
Classified classify_step(float front, float back) {
    vec2 at = vec2(front, back);
    ivec2 i = ivec2(min(at, vec2(volume.table_end + TAIL_CELLS - 1.0)));
    vec2 f = at - vec2(i);
    vec4 step = TABLE_BETWEEN(table_texel, i, f);
    // The table holds associated colours, which is what can be interpolated.
    float per_opacity = step.a > 0.0 ? 1.0 / step.a : 0.0;
    Classified c = Classified(step.rgb * per_opacity, vec3(0.0), step.a);
    if (EMISSION) {
        c.emission = TABLE_BETWEEN(table_emission_texel, i, f).rgb * per_opacity;
    }
    return c;
}
