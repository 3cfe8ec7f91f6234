// Bounds of a piece of a surface, and a test of two pieces in floats, for host and device.
#pragma once

#include <array>
#include <cmath>

#include "libvpm/core/pose.h"

namespace vpm {

// Box and slab of a piece of surface, padded so that floats never hide it.
struct alignas(16) SurfaceBounds {
  std::array<float, 3> center, half;  // box, m
  std::array<float, 3> normal;        // of the slab, unit length
  float offset, width;                // |normal.x - offset| <= width, m
  float size;                         // of the box; 0 for one triangle
};

// Motion from one frame to another in floats, for bounds that are padded for that.
struct FloatPose {
  std::array<float, 9> rotation, size;  // rows; size: magnitudes, a little more
  std::array<float, 3> translation;

  VPM_HD explicit FloatPose(const Pose& pose) {
    const auto& [x, y, z] = pose.rotation;
    const double rows[]{x.x, x.y, x.z, y.x, y.y, y.z, z.x, z.y, z.z};
    for (std::size_t k = 0; k < 9; ++k) {
      rotation[k] = static_cast<float>(rows[k]);
      size[k] = std::fabs(rotation[k]) + 1e-6f;
    }
    const Vec3f t = narrow(pose.translation);
    translation = {t.x, t.y, t.z};
  }
};

// Returns whether two pieces may have a point in common; `pose` maps b's frame to a's. Never misses
// two that have. Tests boxes along the axes of both frames, and the slabs, as TreeWalk does for
// sixteen pairs at once.
VPM_HD inline bool may_meet(const SurfaceBounds& a, const SurfaceBounds& b, const FloatPose& pose) {
  const auto& r = pose.rotation;
  const auto& s = pose.size;
  float center[3], apart[3];  // of b, and from there to a's centre; in a's frame
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t k = 3 * i;
    center[i] =
        r[k] * b.center[0] + r[k + 1] * b.center[1] + r[k + 2] * b.center[2] + pose.translation[i];
    apart[i] = a.center[i] - center[i];
    const float half = s[k] * b.half[0] + s[k + 1] * b.half[1] + s[k + 2] * b.half[2];
    if (!(std::fabs(apart[i]) <= a.half[i] + half)) return false;
  }
  float height = -a.offset, reach = a.width;  // of b's box in a's slab
  float other_height = b.normal[0] * b.center[0] + b.normal[1] * b.center[1] +
                       b.normal[2] * b.center[2] - b.offset,
        other_reach = b.width;  // of a's box in b's slab
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t k = 3 * i;
    const float normal = r[k] * b.normal[0] + r[k + 1] * b.normal[1] + r[k + 2] * b.normal[2];
    height += a.normal[i] * center[i];
    reach +=
        std::fabs(a.normal[0] * r[i] + a.normal[1] * r[3 + i] + a.normal[2] * r[6 + i]) * b.half[i];
    other_height += normal * apart[i];
    other_reach += std::fabs(normal) * a.half[i];
    const float along = r[i] * apart[0] + r[3 + i] * apart[1] + r[6 + i] * apart[2];
    const float half = s[i] * a.half[0] + s[3 + i] * a.half[1] + s[6 + i] * a.half[2];
    if (!(std::fabs(along) <= b.half[i] + half)) return false;
  }
  return std::fabs(height) <= reach && std::fabs(other_height) <= other_reach;
}

}  // namespace vpm
