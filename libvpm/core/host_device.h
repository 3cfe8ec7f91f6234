// Defines VPM_HD, the mark of functions that compile for CPU and GPU.
#pragma once

#ifdef __CUDACC__
#define VPM_HD __host__ __device__
#else
#define VPM_HD
#endif
