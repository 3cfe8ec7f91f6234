#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "libvpm/core/host_device.h"

namespace vpm {

// Range of depths, m, whose inverse floats hold well; others get no normal.
inline constexpr float kMinDepth = 0x1p-80F, kMaxDepth = 0x1p80F;

// Depth along the optical axis in metres, row by row. Values that are not finite and positive are
// unmeasured; files store 0 there. -0 is unmeasured, too, and tells why: something that is known
// was seen there and has been taken out, so that nothing is known of what is behind it, however
// narrow it is. Holes of other zeros are closed where they are narrow.
struct DepthImage {
  std::uint32_t width = 0, height = 0;
  std::vector<float> depth;

  std::size_t index(std::uint32_t u, std::uint32_t v) const { return std::size_t{v} * width + u; }
};

VPM_HD constexpr bool is_measured(float depth) {
  return depth > 0 && depth < HUGE_VALF;
}

inline constexpr float kRemovedDepth = -0.0F;
VPM_HD inline bool is_removed(float depth) {
  return (depth == 0) & (std::copysign(1.0F, depth) < 0);
}

// Returns the depth as clouds keep it: 0 where it is unmeasured, but for what was removed.
VPM_HD inline float kept_depth(float depth) {
  return is_measured(depth) || is_removed(depth) ? depth : 0.0F;
}

// Returns a sensor's raw value in metres; 0 if it is no measurement.
VPM_HD constexpr float depth_in_metres(double value, double units_per_metre) {
  const auto depth = static_cast<float>(value / units_per_metre);
  return is_measured(depth) ? depth : 0.0F;
}

// Returns the depth, or 0 where it is unmeasured or outside kMinDepth to kMaxDepth. Normals and
// queries use these.
VPM_HD constexpr float usable_depth(float depth) {
  return depth >= kMinDepth && depth <= kMaxDepth ? depth : 0.0F;
}
// Returns 1 / depth, or 0 for 0.
VPM_HD constexpr float inverse_of_usable(float depth) {
  const float reciprocal = 1.0F / (depth > 0 ? depth : 1.0F);
  return depth > 0 ? reciprocal : 0.0F;
}
// Returns the inverse of any depth: 0 where it is unmeasured or out of range, -0 where it was
// removed.
VPM_HD inline float inverse_or_removed(float depth) {
  return is_removed(depth) ? depth : inverse_of_usable(usable_depth(depth));
}

}  // namespace vpm
