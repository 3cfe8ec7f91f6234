#include "libvpm/backend/cpu/cell_samples.h"

#include <iterator>

#include "libvpm/core/lanes.h"
#include "libvpm/core/vec3x4.h"

namespace vpm {
namespace {

// Holds four rows of partial sums, one in each lane.
struct FourRows {
  Double4 weight{};
  Vec3x4 moment{Double4{}, Double4{}, Double4{}};
};

[[gnu::always_inline]] inline FourRows operator+(const FourRows& a, const FourRows& b) {
  return {a.weight + b.weight, a.moment + b.moment};
}
// Adds lanes by halves, as clipped_in_turn() does.
[[gnu::always_inline]] inline double sum(const Double4& rows) {
  return (rows[0] + rows[2]) + (rows[1] + rows[3]);
}

}  // namespace

VPM_VECTOR_CLONES
ClippedMoments clipped_moments(const ClipPlane& plane, std::span<const CellSample> samples) {
  FourRows rows[kSumRows / kFour];
  Mask4 any_cut{};
  const std::size_t count = samples.size();
  for (std::size_t first = 0; first < count; first += kFour) {
    const auto [a, b, c, d] = four_of(samples, first);
    const Vec3x4 center(a.center, b.center, c.center, d.center);
    const Double4 radius = widen(Float4{a.radius, b.radius, c.radius, d.radius});
    const Double4 weight{a.weight, b.weight, c.weight, d.weight};
    const Double4 distance = dot(plane.normal, center) + plane.height;
    if (!any(distance < radius)) continue;
    Mask4 is_cut{};
    Double4 inside =
        weight_behind(BallShape<Double4>{radius}, plane.normal, distance, weight, is_cut);
    any_cut |= is_cut;
    for (std::size_t k = count - first; k < kFour; ++k) inside[k] = 0;
    FourRows& row = rows[first / kFour % std::size(rows)];
    row = row + FourRows{inside, inside * center};
  }
  static_assert(std::size(rows) == 4);
  const FourRows all = (rows[0] + rows[2]) + (rows[1] + rows[3]);
  return {sum(all.weight), {sum(all.moment.x), sum(all.moment.y), sum(all.moment.z)}, any(any_cut)};
}

}  // namespace vpm
