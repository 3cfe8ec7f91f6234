// Limits of normal estimation, shared by host and device.
#pragma once

#include "libvpm/include/vpm/camera.h"

namespace vpm {

inline constexpr int kMinWindow = 3, kMaxWindow = 31;

// Fewest pixels of a window that determine a plane, and the least variance along their narrowest
// direction, px^2; two neighbouring diagonals have 1/8.
inline constexpr int kMinSupport = 6;
inline constexpr float kMinSpread = 0.1F;

// Range of depths, m, whose inverse floats hold well; others get no normal.
inline constexpr float kMinDepth = 0x1p-80F, kMaxDepth = 0x1p80F;

}  // namespace vpm
