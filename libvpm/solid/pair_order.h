// The one order in which a pair of solids is computed, so that its answer has the same bits
// whichever of them is called the first.
#pragma once

#include <array>

#include "libvpm/core/pose.h"

namespace vpm {

class PairOrder {
 public:
  // Keys tell the solids apart; those of twins are equal, and their poses order them.
  template <class Key>
  PairOrder(const Key& a, const Key& b) : is_turned_(b < a), are_twins_(a == b) {}

  // Returns whether b comes first, by the keys alone.
  bool is_turned() const { return is_turned_; }
  // Returns whether b comes first at these poses.
  bool is_turned(const Pose& pose_a, const Pose& pose_b) const {
    return are_twins_ ? key_of(pose_b) < key_of(pose_a) : is_turned_;
  }

 private:
  static std::array<double, 12> key_of(const Pose& p) {
    const auto& [x, y, z] = p.rotation;
    const Vec3 t = p.translation;
    return {t.x, t.y, t.z, x.x, x.y, x.z, y.x, y.y, y.z, z.x, z.y, z.z};
  }

  bool is_turned_, are_twins_;
};

}  // namespace vpm
