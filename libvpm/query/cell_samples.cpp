#include "libvpm/query/cell_samples.h"

#include <cstddef>
#include <cstring>

#include "libvpm/core/vec3x4.h"
#include "libvpm/core/vector_clones.h"

namespace vpm {
namespace {

// The centre; in the last lane the radius, which nobody uses.
[[gnu::always_inline]] inline Double4 center_of(const CellSample& sample) {
  static_assert(offsetof(CellSample, center) == 0 && sizeof(CellSample) >= sizeof(Float4));
  Float4 center;
  std::memcpy(&center, &sample, sizeof center);
  return widen(center);
}

}  // namespace

VPM_VECTOR_CLONES
CrossedSums crossed_sums(const CrossingPlane& plane, std::span<const CellSample> samples) {
  CrossedSums sums;
  Double4 moment{};
  Mask4 any_cut{};
  const std::size_t count = samples.size();
  for (std::size_t first = 0; first < count; first += kFour) {
    const auto [a, b, c, d] = four_of(samples, first);
    const Vec3x4 center(a.center, b.center, c.center, d.center);
    const Double4 radius = widen(Float4{a.radius, b.radius, c.radius, d.radius});
    const Double4 weight{a.weight, b.weight, c.weight, d.weight};
    const Double4 distance = dot(plane.normal, center) + plane.height;
    const Mask4 reached = ~(distance >= radius), is_cut = reached & ~(distance <= -radius);
    if (!any(reached)) continue;
    any_cut |= is_cut;
    const Double4 fraction = fraction_of_cut_ball<Double4>(distance / radius);
    const Double4 inside = reached ? (is_cut ? weight * fraction : weight) : Double4{};
    for (std::size_t k = 0; k < kFour && first + k < count; ++k) {
      sums.weight += inside[k];
      moment += inside[k] * center_of(samples[first + k]);
    }
  }
  sums.moment = {moment[0], moment[1], moment[2]};
  sums.is_cut = any(any_cut);
  return sums;
}

}  // namespace vpm
