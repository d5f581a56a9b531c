// What specializes the march, and how it leaves its result; beams.comp, which finishes what shows nothing, shares it. Includes
// frame.glsl and composite.glsl first.

// When the transfer function is applied: after interpolation, before it, or along each segment (src/pass/picture.rs).
const uint POST = 0u;
const uint PRE = 1u;
const uint PREINTEGRATED = 2u;
// A module of its own where segments are integrated: llvmpipe translates and inlines all of a module before it leaves out what a
// variant does not use, which is most of a process's first frame.
#ifdef MARCH_ENDS
const uint CLASSIFICATION = PREINTEGRATED;
#else
layout(constant_id = SPEC_CLASSIFICATION) const uint CLASSIFICATION = 0;
#endif

// Opacity alone, of which the optical depth is kept (Max's absorption-only model).
layout(constant_id = SPEC_XRAY) const bool XRAY = false;

void march_store(uvec2 px, Accumulated acc) {
    float depth = XRAY ? acc.optical_depth : expected_depth(acc);
    frame_store(px, vec4(acc.radiance, acc.opacity), vec4(acc.depth_mm, float(acc.samples), acc.median_mm, depth));
}
