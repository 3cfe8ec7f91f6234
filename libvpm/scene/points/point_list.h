// Lists a few points, which are faster to search than a tree. For host and device.
#pragma once

#include <cmath>
#include <cstdint>

#include "libvpm/core/vec3.h"

namespace vpm {

class PointList {
 public:
  static constexpr int kMost = 256;

  VPM_HD bool is_empty() const { return size_ == 0; }
  VPM_HD void clear() { size_ = 0; }
  // Adds a point; indices must ascend. Returns false if there is no room.
  VPM_HD bool add(std::uint32_t index, Vec3f place) {
    if (size_ == kMost) return false;
    places_[0][size_] = place.x, places_[1][size_] = place.y, places_[2][size_] = place.z;
    indices_[size_++] = index;
    return true;
  }

  // Returns the index of the point nearest to x; ties go to the smaller index. Requires a point.
  VPM_HD std::uint32_t nearest(Vec3 x) const {
#ifdef __CUDA_ARCH__
    return indices_[nearest_in_turn(x)];
#else
    return indices_[nearest_by_vectors(x)];
#endif
  }

 private:
  VPM_HD int nearest_in_turn(Vec3 x) const {
    double least = HUGE_VAL;
    int best = 0;
    for (int k = 0; k < size_; ++k) {
      const double squared =
          squared_norm(widen(Vec3f{places_[0][k], places_[1][k], places_[2][k]}) - x);
      if (!(squared < least)) continue;
      least = squared;
      best = k;
    }
    return best;
  }
  int nearest_by_vectors(Vec3 x) const;

  int size_ = 0;
  float places_[3][kMost];
  std::uint32_t indices_[kMost];
};

}  // namespace vpm
