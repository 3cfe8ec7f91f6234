// Marks functions that GCC compiles for AVX-512, for AVX2 and for baseline x86-64; the loader
// chooses at start. All clones give the same bits: they run the same IEEE operations in the same
// order, and contraction is off. `flatten` inlines callees, so that these are cloned too.
#pragma once

#include <cstdlib>  // defines __GLIBC__ where the loader can choose

#if defined(__x86_64__) && __GNUC__ >= 12 && !defined(__clang__) && defined(__GLIBC__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && !defined(__CUDACC__)
#define VPM_VECTOR_CLONES [[gnu::target_clones("arch=x86-64-v4", "avx2", "default"), gnu::flatten]]
#else
#define VPM_VECTOR_CLONES
#endif
