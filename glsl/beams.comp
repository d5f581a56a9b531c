#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_shader_image_load_formatted : require
// Where along the rays of 4x2 pixels something may show: a bit for every few segments. Pixels of which none does are finished here, the
// others listed for the march. One invocation a beam.

#include "bindings.glsl"
#include "structs.glsl"
#include "volume.glsl"
#include "skip.glsl"
#include "optical_depth.glsl"
#include "composite.glsl"
#include "random.glsl"
#include "ray.glsl"
#include "target.glsl"
#include "frame.glsl"
#include "march_variant.glsl"
#include "beams.glsl"
#include "beam_box.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

// By tile: workgroups of the march on x, y and z, and beams listed.
layout(set = 0, binding = BINDING_BEAM_TILES) buffer BeamTiles { uvec4 beam_tiles[]; };
layout(set = 0, binding = BINDING_BEAM_LIST) buffer BeamList { uint beam_list[]; };
layout(set = 0, binding = BINDING_BEAM_RUNS) buffer BeamRuns { uint beam_runs[]; };

// Target and depths were cleared to what shows nothing. Drivers that store pixel by pixel and channel by channel take half of this
// pass for that.
layout(constant_id = SPEC_CLEARED) const bool CLEARED = false;

// Whether pixels that show nothing are stored at all.
bool stores_unseen() {
#ifdef BLEND_FORMAT
    // What is blended over stays, but for what decoding and encoding round.
    bool stores = ENCODE_SRGB;
    if (AUX) {
        stores = true;
    }
#else
    bool stores = true;
    if (CLEARED) {
        stores = false;
    }
#endif
    return stores;
}

void store_unseen(uvec2 first_px, bool seen) {
    // A loop and no branch, which CPU drivers would execute for all.
    uint unseen = seen ? 0u : BEAM_PIXELS;
    for (uint k = 0u; k < unseen; ++k) {
        uvec2 px = first_px + pixel_of_beam(k);
        if (!is_outside(px)) {
            march_store(px, nothing());
        }
    }
}

// Bits of the segments from `i` up to `end`; `i` goes on to where they are known.
uint bits_of(Beam beam, inout uint i, uint end) {
    // Where along a segment samples may lie: at its middle, or from its start, or that of the one before where rays start anywhere in
    // a step, to its end. The middle of a ray's last one, which is shorter, is nearer to its start.
    float from = 0.5;
    float to = 0.5;
    if (CLASSIFICATION == PREINTEGRATED) {
        from = 0.0;
        to = 1.0;
    }
    // The host's geometry may make any segment a ray's last.
    if (SCENE_DEPTH) {
        from = 0.0;
    }
    if (JITTER) {
        from = -1.0;
        to = 1.0;
    }
    uint bits = 0u;
    if (i < end) {
        do {
            uint bit = i >> frame.beam_shift;
            uint next = (bit + 1u) << frame.beam_shift;
            float first = float(i) + (next < beam.shortest ? from : min(from, 0.0));
            vec3 rear_ix = clamp(beam.rear_ix + first * beam.rear_step_ix, vec3(0.0), volume.field_ix);
            ivec3 cell = skip_cell_of(rear_ix);
            uint word = skip_word(cell);
            // The rest of these segments,
            float last = float(next) - 1.0 + to;
            vec3 far_ix = clamp(beam.front_ix + last * beam.front_step_ix, vec3(0.0), volume.field_ix);
            ivec3 far_cell = skip_cell_of(far_ix);
            uvec3 span = uvec3(abs(far_cell - cell));
            bool empty = is_empty_box(word, beam.octants, span) || is_empty_box(skip_word(far_cell), ~beam.octants, span);
            // and how many there are before the beam's front leaves the cube that the leap spans.
            uint leap = leap_from(word, beam.heading.shift);
            vec3 border_ix = border_of(cell, float(leap), float(SKIP_CELLS), beam.heading);
            vec3 front_ix = beam.front_ix + float(i) * beam.front_step_ix;
            float steps = steps_to_border(front_ix, beam.heading, border_ix);
            // On an axis along which it does not move it may be outside all the time.
            vec3 left_ix = (border_ix - front_ix) * (2.0 * beam.heading.ahead - 1.0);
            steps = any(lessThan(left_ix, vec3(MARGIN_IX))) ? 0.0 : steps;
            float inside = floor(clamp(steps + 1.0 - to - MARGIN_STEPS, 0.0, 1.0e9));
            uint leapt = i + (leap > 0u && steps > 0.0 ? uint(inside) : 0u);
            bool shown = !empty && leapt < next;
            // Within a block of which every cell shows something the bits up to its border are known as well.
            vec3 block_border_ix = border_of(block_of(rear_ix), 1.0, float(BLOCK_CELLS), beam.heading);
            uint steps_inside = uint(clamp(steps_to_border(rear_ix, beam.heading, block_border_ix), 0.0, 1.0e9));
            uint more = min(steps_inside >> frame.beam_shift, 31u - (bit & 31u));
            more = word == WHOLE_BLOCK ? more : 0u;
            bits |= shown ? ((2u << more) - 1u) << (bit & 31u) : 0u;
            i = shown ? next + (more << frame.beam_shift) : max(leapt, next);
        } while (i < end);
    }
    return bits;
}

void main() {
    uvec2 beam_xy = lane_pixel();
    uvec2 first_px = push.tile_px + BEAM_PX * beam_xy;
    if (is_outside(first_px)) {
        return;
    }
    Beam beam = beam_through(first_px);
    uint bits_at = beam_at(beam_xy) * frame.beam_words;
    uint i = 0u;
    uint all = 0u;
    uint word = 0u;
    uint end = 0u;
    // Not a loop over frame.beam_words, which bounds the segments (beam_through): lavapipe compiles those anew for every value of a
    // uniform, at every dispatch.
    do {
        end += 32u << frame.beam_shift;
        uint bits = bits_of(beam, i, min(end, beam.segments));
        beam_runs[bits_at + word] = bits;
        all |= bits;
        word++;
    } while (end < beam.segments);
    if (all != 0u) {
        uint place = atomicAdd(beam_tiles[push.beam_tile].w, 1u);
        beam_list[push.first_beam + place] = beam_xy.x | beam_xy.y << 16u;
        const uint row = BEAM_GROUPS_A_ROW * BEAMS_A_GROUP;
        if (place % row == 0u) {
            beam_tiles[push.beam_tile].x = BEAM_GROUPS_A_ROW;
            atomicMax(beam_tiles[push.beam_tile].y, place / row + 1u);
            beam_tiles[push.beam_tile].z = 1u;
        }
    }
    if (stores_unseen()) {
        store_unseen(first_px, all != 0u);
    }
}
