// One definition of the math for CPU and GPU: functions marked VPM_HD compile for both.
#pragma once

#ifdef __CUDACC__
#define VPM_HD __host__ __device__
#else
#define VPM_HD
#endif
