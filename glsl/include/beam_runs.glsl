// How the march follows the beams that beams.comp left: which one an invocation belongs to, and which segments may show something.
// Includes beams.glsl first.

// A subgroup's rays go through the same segments then, none looks for a way of its own, and no subgroup runs for pixels that show
// nothing: CPU drivers execute what a branch leaves out.
layout(constant_id = SPEC_BEAMS) const bool BEAMS = false;

layout(set = 0, binding = BINDING_BEAM_TILES) readonly buffer BeamTiles { uint beam_tiles[]; };
layout(set = 0, binding = BINDING_BEAM_LIST) readonly buffer BeamList { uint beam_list[]; };
layout(set = 0, binding = BINDING_BEAM_RUNS) readonly buffer BeamRuns { uint beam_runs[]; };

// The bits of a beam, and the segments [first, end) beyond which none of them is set.
struct ListedBeam {
    uint bits_at;
    uint first;
    uint end;
};

// The pixel of an invocation, beyond the tile where the list has ended; and its beam.
uvec2 beam_pixel(out ListedBeam listed_beam) {
    uint at = gl_LocalInvocationIndex;
    // Each run of the dispatch follows the beams that the same run cast: the processor that takes it has them at hand.
    uint rows = max(gl_NumWorkGroups.y / RUNS, 1u);
    uint run = times_in(rows, gl_WorkGroupID.y);
    uint group = (gl_WorkGroupID.y - run * rows) * BEAM_GROUPS_A_ROW + gl_WorkGroupID.x;
    uint place = group * BEAMS_A_GROUP + at / BEAM_PIXELS;
    bool listed = place < beam_tiles[beam_list_length_at(run)];
    uint entry = beam_list[beam_list_at(run) + (listed ? place : 0u)];
    uvec2 beam = uvec2(entry & 0x7ffu, entry >> 11 & 0xfffu);
    listed_beam = ListedBeam(beam_at(beam) * frame.beam_words, 0u, ~0u);
    if (SHOWN_CELLS) {
        listed_beam.first = (entry >> 23 & 15u) * 128u;
        listed_beam.end = ((entry >> 27) + 1u) * 128u;
    }
    uvec2 px = push.tile_px + BEAM_PX * beam + pixel_of_beam(at % BEAM_PIXELS);
    return listed ? px : push.tile_end_px;
}

// Segments [first, end) of which some may show something.
struct BeamRun {
    uint first;
    uint end;
};

// The next ones from segment `i` on, before `end`; without any both are at or beyond it.
BeamRun next_beam_run(uint bits_at, uint i, uint end) {
    uint bit = i >> frame.beam_shift;
    uint last_word = frame.beam_words - 1u;
    uint bits;
    bool none;
    do {
        bits = beam_runs[bits_at + min(bit / 32u, last_word)] >> (bit & 31u);
        none = bits == 0u;
        bit += none ? 32u - (bit & 31u) : 0u;
    } while (none && bit << frame.beam_shift < end);
    uint skipped = none ? 0u : uint(findLSB(bits));
    uint others = ~(bits >> skipped);
    uint shown = others == 0u ? 32u : uint(findLSB(others));
    uint first = (bit + skipped) << frame.beam_shift;
    return BeamRun(first, min(first + (shown << frame.beam_shift), end));
}
