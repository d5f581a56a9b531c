#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_shader_image_load_formatted : require
// Where along the rays of 4x2 pixels something may show: a bit for every segment, or for every few. Pixels of which none does are finished
// here, the others listed for the march. One invocation a beam.

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
#include "shown_cells.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = BINDING_BEAM_TILES) buffer BeamTiles { uint beam_tiles[]; };
layout(set = 0, binding = BINDING_BEAM_LIST) buffer BeamList { uint beam_list[]; };
layout(set = 0, binding = BINDING_BEAM_RUNS) buffer BeamRuns { uint beam_runs[]; };

#include "beam_bits.glsl"

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

void main() {
    // Neighbours stay with one run for a while: they share what they read.
    uint width = gl_NumWorkGroups.x;
    Dealt taken = deal(gl_WorkGroupID.y * width + gl_WorkGroupID.x, width * gl_NumWorkGroups.y, 8u);
    uint row = times_in(width, taken.piece);
    uvec2 beam_xy = lane_pixel_in(uvec2(taken.piece - row * width, row));
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
    // Of cells between voxels: whether to look them up, and which words have any bit then.
    ShownGrid grid = shown_grid();
    bool mixed = false;
    uint first_word = 0u;
    uint end_word = 0u;
    // Not a loop over frame.beam_words, which bounds the segments (beam_through): lavapipe compiles those anew for every value of a
    // uniform, at every dispatch.
    do {
        end += 32u << together_shift();
        uint bits = bits_of(beam, i, min(end, beam.segments), mixed);
        if (SHOWN_CELLS) {
            uvec4 singly = refine(beam, grid, 32u * word, mixed ? bits : 0u);
            singly = mixed ? singly : fourfold(bits);
            uint any_of_them = singly.x | singly.y | singly.z | singly.w;
            all |= any_of_them;
            // Nothing reads words before the first that has any.
            uint words = all == 0u ? 0u : 4u;
            for (uint k = 0u; k < words; ++k) {
                beam_runs[bits_at + word + k] = singly[k];
            }
            word += 4u;
            first_word = any_of_them != 0u && first_word == end_word ? word - 4u : first_word;
            end_word = any_of_them != 0u ? word : end_word;
        } else {
            all |= bits;
            beam_runs[bits_at + word] = bits;
            word++;
        }
    } while (end < beam.segments);
    if (all != 0u) {
        uint place = atomicAdd(beam_tiles[beam_list_length_at(taken.run)], 1u);
        beam_list[beam_list_at(taken.run) + place] = beam_listed(beam_xy, first_word, end_word);
        const uint beams_a_row = BEAM_GROUPS_A_ROW * BEAMS_A_GROUP;
        if (place % beams_a_row == 0u) {
            // As many rows for every run.
            uint tile = beam_tile_at();
            beam_tiles[tile] = BEAM_GROUPS_A_ROW;
            atomicMax(beam_tiles[tile + 1u], (place / beams_a_row + 1u) * RUNS);
            beam_tiles[tile + 2u] = 1u;
        }
    }
    if (stores_unseen()) {
        store_unseen(first_px, all != 0u);
    }
}
