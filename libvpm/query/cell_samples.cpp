#include "libvpm/query/cell_samples.h"

#include <iterator>

#include "libvpm/core/vec3x4.h"
#include "libvpm/core/vector_clones.h"

namespace vpm {
namespace {

// A row in each lane.
struct FourRows {
  Double4 weight{};
  Vec3x4 moment{Double4{}, Double4{}, Double4{}};
};

[[gnu::always_inline]] inline FourRows operator+(const FourRows& a, const FourRows& b) {
  return {a.weight + b.weight, a.moment + b.moment};
}
// By halves.
[[gnu::always_inline]] inline double sum(const Double4& rows) {
  return (rows[0] + rows[2]) + (rows[1] + rows[3]);
}

// Slopes of four samples at once.
struct FourSlopes {
  Double4 rate{}, xx{}, xy{}, xz{}, yy{}, yz{}, zz{};
  Vec3x4 turn{Double4{}, Double4{}, Double4{}};

  // Of samples of which a plane cuts off less by `rate` as it comes nearer by a metre.
  [[gnu::always_inline]] void add(const Double4& rates, const Vec3& normal, const Vec3x4& center) {
    const Vec3x4 arm = cross(center, Vec3x4(normal, normal, normal, normal));
    const Vec3x4 part = rates * arm;
    rate = rate + rates;
    turn = turn + part;
    xx = xx + part.x * arm.x, xy = xy + part.x * arm.y, xz = xz + part.x * arm.z;
    yy = yy + part.y * arm.y, yz = yz + part.y * arm.z, zz = zz + part.z * arm.z;
  }
  [[gnu::always_inline]] CrossedSlopes sums() const {
    return {
        sum(rate),
        {sum(turn.x), sum(turn.y), sum(turn.z)},
        {{sum(xx), sum(xy), sum(xz)}, {sum(xy), sum(yy), sum(yz)}, {sum(xz), sum(yz), sum(zz)}}};
  }
};
struct NoSlopes {
  [[gnu::always_inline]] void add(const Double4&, const Vec3&, const Vec3x4&) {}
};

template <class Slopes>
[[gnu::always_inline]] inline CrossedSums crossed_sums_of(const CrossingPlane& plane,
                                                          std::span<const CellSample> samples,
                                                          Slopes& slopes) {
  FourRows rows[kSumRows / kFour];
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
    const Double4 away = distance / radius;
    const Double4 fraction = fraction_of_cut_ball<Double4>(away);
    Double4 inside = reached ? (is_cut ? weight * fraction : weight) : Double4{};
    Double4 rate = is_cut ? weight * slope_of_cut_ball<Double4>(away) / radius : Double4{};
    for (std::size_t k = count - first; k < kFour; ++k) inside[k] = rate[k] = 0;
    slopes.add(rate, plane.normal, center);
    FourRows& row = rows[first / kFour % std::size(rows)];
    row = row + FourRows{inside, inside * center};
  }
  static_assert(std::size(rows) == 4);
  const FourRows all = (rows[0] + rows[2]) + (rows[1] + rows[3]);
  return {sum(all.weight), {sum(all.moment.x), sum(all.moment.y), sum(all.moment.z)}, any(any_cut)};
}

}  // namespace

VPM_VECTOR_CLONES
CrossedSums crossed_sums(const CrossingPlane& plane, std::span<const CellSample> samples) {
  NoSlopes none;
  return crossed_sums_of(plane, samples, none);
}

VPM_VECTOR_CLONES
CrossedSums crossed_sums(const CrossingPlane& plane, std::span<const CellSample> samples,
                         CrossedSlopes& slopes) {
  FourSlopes four;
  const CrossedSums sums = crossed_sums_of(plane, samples, four);
  slopes = four.sums();
  return sums;
}

}  // namespace vpm
