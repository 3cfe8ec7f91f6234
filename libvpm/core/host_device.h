// Defines VPM_HD, the mark of functions that compile for CPU and GPU, and VPM_HD_RARE, that of those
// which few queries call: a GPU keeps one copy of them, away from the code that all queries go
// through.
#pragma once

#ifdef __CUDACC__
#define VPM_HD __host__ __device__
#define VPM_HD_RARE __host__ __device__ __noinline__
#else
#define VPM_HD
#define VPM_HD_RARE
#endif
