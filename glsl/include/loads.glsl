// How single texels are read.
#ifndef LOADS_GLSL
#define LOADS_GLSL

// As storage images. Of a sampled image llvmpipe finds out the level of detail for every lane and fetch, which costs more than the read;
// GPUs read sampled images through caches of their own.
layout(constant_id = SPEC_LOADS) const bool LOADS = false;

#endif
