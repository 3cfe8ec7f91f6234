#include "libvpm/scene/points/point_list.h"

#include "libvpm/core/lanes.h"
#include "libvpm/scene/points/point_tree_vectors.h"

namespace vpm {

VPM_VECTOR_CLONES
int PointList::nearest_by_vectors(Vec3 x) const {
  static_assert(kMost % kFour == 0);
  Double4 least = Double4{} + HUGE_VAL;
  Mask4 lane{0, 1, 2, 3}, best{};
  for (int first = 0; first < size_; first += kFour) {
    const Vec3x4 away{load_four(places_[0] + first) - x.x, load_four(places_[1] + first) - x.y,
                      load_four(places_[2] + first) - x.z};
    const Double4 squared = squared_norm(away);
    const Mask4 nearer = (squared < least) & (lane < size_ - first);
    least = nearer ? squared : least;
    best = nearer ? lane + first : best;
  }
  int k = 0;
  for (int other = 1; other < kFour; ++other) {
    if (least[other] < least[k] || (least[other] == least[k] && best[other] < best[k])) k = other;
  }
  return static_cast<int>(best[k]);
}

}  // namespace vpm
