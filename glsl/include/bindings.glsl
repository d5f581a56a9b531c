// Every binding number and specialization id. `cargo xtask shaders` gives the host the same numbers.
// All passes use set 0.
#define BINDING_VOLUME 0
#define BINDING_FRAME 1
#define BINDING_ATLAS 2
#define BINDING_INDEX 3
#define BINDING_SKIP 4
#define BINDING_TRANSFER 5
#define BINDING_LIGHT 6
#define BINDING_SCENE_DEPTH 7
#define BINDING_TARGET 8
#define BINDING_AUX 9
#define BINDING_BRICKS 10
#define BINDING_WORK 11
#define BINDING_LIGHT_STORE 12
#define BINDING_VOXELS 13

#define SPEC_NEAREST 0
#define SPEC_BLOCKS_APART 1
#define SPEC_SKIPPING 2
#define SPEC_EMISSION 3
#define SPEC_LIGHT 4
#define SPEC_DIFFUSE 5
#define SPEC_JITTER 6
#define SPEC_AUX 7
#define SPEC_SCENE_DEPTH 8
#define SPEC_ENCODE_SRGB 9
#define SPEC_MANUAL_FILTER 10
#define SPEC_UNIFORM_GRID 11
#define SPEC_EXACT_BINS 12
