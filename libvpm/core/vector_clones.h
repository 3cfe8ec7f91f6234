// Functions that GCC compiles for AVX-512, for AVX2 and for every x86-64, and that the loader
// chooses. No value depends on the choice: all are the same IEEE operations in the same order, and
// contraction to fused multiply-add is off. `flatten` inlines what the function calls, so that it
// is compiled for each too.
#pragma once

#include <cstdlib>  // defines __GLIBC__ where the loader can choose

#if defined(__x86_64__) && __GNUC__ >= 12 && !defined(__clang__) && defined(__GLIBC__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && !defined(__CUDACC__)
#define VPM_VECTOR_CLONES [[gnu::target_clones("arch=x86-64-v4", "avx2", "default"), gnu::flatten]]
#else
#define VPM_VECTOR_CLONES
#endif
