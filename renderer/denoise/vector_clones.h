// VECTOR_CLONES before a function: it is compiled for AVX2 too, and the program takes what the machine has. The bits
// are the same: nothing is contracted, and no sum is reordered. Not under sanitizers, which start after the choice.
#pragma once

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define VECTOR_CLONES
#else
#define VECTOR_CLONES __attribute__((target_clones("avx2", "default")))
#endif
