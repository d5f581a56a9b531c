// Labels beside the volume: samples that they hide, and colours that they give. Includes params.glsl first.

layout(constant_id = SPEC_LABELS) const bool LABELS = false;

// Where each voxel's label stands in the table; the label map has a grid of its own.
layout(set = 0, binding = BINDING_LABELS) uniform usampler3D t_labels;
// By label, in rows of LABEL_ROW: linear colour and its share, negative where the label is hidden. 0 is the background.
layout(set = 0, binding = BINDING_LABEL_TABLE) uniform sampler2D t_label_table;

const uint LABEL_ROW = 256u;

// The table's entry for the voxel nearest to a position; beyond the label map that of the background.
vec4 label_style(vec3 p_ix) {
    vec4 p = vec4(p_ix, 1.0);
    // `precise`: variants of a pass must find the same voxel.
    precise vec3 at = vec3(dot(volume.label_ix_from_ix_x, p), dot(volume.label_ix_from_ix_y, p), dot(volume.label_ix_from_ix_z, p));
    vec3 voxel = floor(at + 0.5);
    vec3 last = vec3(textureSize(t_labels, 0) - 1);
    bool beyond = any(lessThan(voxel, vec3(0.0))) || any(greaterThan(voxel, last));
    uint label = texelFetch(t_labels, ivec3(clamp(voxel, vec3(0.0), last)), 0).r;
    label = beyond ? 0u : label;
    return texelFetch(t_label_table, ivec2(label % LABEL_ROW, label / LABEL_ROW), 0);
}

bool is_hidden(vec3 p_ix) {
    bool hidden = false;
    if (LABELS) {
        hidden = label_style(p_ix).a < 0.0;
    }
    return hidden;
}

// What the label at a position leaves of a colour and an opacity.
void apply_label(vec3 p_ix, inout vec3 color, inout float opacity) {
    if (LABELS) {
        vec4 style = label_style(p_ix);
        precise vec3 tinted = mix(color, style.rgb, max(style.a, 0.0));
        color = tinted;
        opacity = style.a < 0.0 ? 0.0 : opacity;
    }
}
