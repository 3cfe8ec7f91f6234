// Functions that GCC compiles twice, for AVX2 and for every x86-64, and that the loader chooses.
// No value depends on the choice: both are the same IEEE operations in the same order, and neither
// has fused multiply-add. `flatten` inlines what the function calls, so that it is compiled twice
// too.
#pragma once

#include <cstdlib>  // defines __GLIBC__ where the loader can choose

#if defined(__x86_64__) && !defined(__clang__) && defined(__GLIBC__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && !defined(__CUDACC__)
#define VPM_VECTOR_CLONES [[gnu::target_clones("avx2", "default"), gnu::flatten]]
#else
#define VPM_VECTOR_CLONES
#endif
