#include "libvpm/query/cell_samples.h"

#include <cstddef>

#include "libvpm/core/lane_vec3.h"
#include "libvpm/core/vector_clones.h"

namespace vpm {
namespace {

static_assert(offsetof(CellSample, center) == 0 && offsetof(CellSample, radius) == 12);
// Centre and radius.
[[gnu::always_inline]] inline Doubles head(const CellSample& sample) {
  return widen(load<HalfFloats>(reinterpret_cast<const float*>(&sample)));
}

VPM_VECTOR_CLONES void add_lanes(const CrossingPlane& plane, const CellSample* samples,
                                 std::uint32_t count, CrossedSums& sums) {
  Doubles moment{};
  LaneMask cut{};
  for (std::uint32_t first = 0; first < count; first += kVec3Lanes) {
    const auto sample = [&](std::uint32_t k) -> const CellSample& {
      return samples[first + k < count ? first + k : count - 1];
    };
    const CellSample &a = sample(0), &b = sample(1), &c = sample(2), &d = sample(3);
    const LaneVec3 center = lanes(a.center, b.center, c.center, d.center);
    const Doubles radius = widen(HalfFloats{a.radius, b.radius, c.radius, d.radius});
    const Doubles weight{a.weight, b.weight, c.weight, d.weight};
    const Doubles distance = dot(plane.normal, center) + plane.height;
    const LaneMask reached = distance < radius, is_cut = reached & (distance > -radius);
    if (!any(reached)) continue;
    cut |= is_cut;
    const Doubles fraction = fraction_of_cut_ball(Doubles(distance / radius));
    const Doubles inside = reached ? (is_cut ? weight * fraction : weight) : Doubles{};
    for (std::uint32_t k = 0; k < kVec3Lanes && first + k < count; ++k) {
      sums.weight += inside[k];
      moment += inside[k] * head(samples[first + k]);
    }
  }
  sums.moment = {moment[0], moment[1], moment[2]};
  sums.is_cut = any(cut);
}

}  // namespace

CrossedSums crossed_sums(const CrossingPlane& plane, const CellSample* samples,
                         std::uint32_t count) {
  CrossedSums sums;
  add_lanes(plane, samples, count, sums);
  return sums;
}

}  // namespace vpm
