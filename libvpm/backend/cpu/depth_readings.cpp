#include "libvpm/backend/cpu/depth_readings.h"

#include "libvpm/core/vec3x4.h"
#include "libvpm/core/vector_clones.h"

namespace vpm {
namespace {

using FourReadings = ReadingOf<Double4>;

[[gnu::always_inline]] inline FourReadings read_at(const DepthSurface& surface, const Vec3x4& x) {
  return surface.read_and(x, [](const Int4&, const Int4&) {});
}
// Puts together readings that are known.
[[gnu::always_inline]] inline FourReadings joined(const Reading& a, const Reading& b,
                                                  const Reading& c, const Reading& d) {
  FourReadings four;
  four.known = ~Mask4{};
  four.distance = Double4{a.distance, b.distance, c.distance, d.distance};
  four.normal = {a.normal, b.normal, c.normal, d.normal};
  four.foot = {a.foot, b.foot, c.foot, d.foot};
  four.point = Int4{static_cast<std::int32_t>(a.point), static_cast<std::int32_t>(b.point),
                    static_cast<std::int32_t>(c.point), static_cast<std::int32_t>(d.point)};
  return four;
}
[[gnu::always_inline]] inline Reading of_lane(const FourReadings& four, int lane) {
  if (four.known[lane] == 0) return {};
  return {true, four.distance[lane], four.normal.of(lane), four.foot.of(lane),
          static_cast<std::uint32_t>(four.point[lane])};
}

}  // namespace

VPM_VECTOR_CLONES
void read_four(const DepthSurface& surface, const Vec3 (&places)[4], Reading (&readings)[4]) {
  const FourReadings four = read_at(surface, {places[0], places[1], places[2], places[3]});
  for (int k = 0; k < kFour; ++k) readings[k] = of_lane(four, k);
}

VPM_VECTOR_CLONES
std::uint32_t read_samples(const DepthSurface& surface, const Pose& to_surface,
                           std::span<const CellSample> samples, SampleReading* readings) {
  const auto count = static_cast<std::uint32_t>(samples.size());
  std::uint32_t found = 0;
  for (std::uint32_t first = 0; first < count; first += kFour) {
    const auto [a, b, c, d] = four_of(samples, first);
    const Vec3x4 x = to_surface * Vec3x4(a.center, b.center, c.center, d.center);
    const Double4 radius = widen(Float4{a.radius, b.radius, c.radius, d.radius});
    const FourReadings four = read_at(surface, x);
    const Mask4 reached = four.known & (four.distance < radius);
    if (!any(reached)) continue;
    for (int k = 0; k < kFour && first + k < count; ++k) {
      if (reached[k] != 0) readings[found++] = {first + k, {x.of(k), of_lane(four, k)}};
    }
  }
  return found;
}

VPM_VECTOR_CLONES
void closest_normals(const DepthSurface& surface, std::span<const PlaceReading> places,
                     Vec3* normals) {
  const std::size_t count = places.size();
  for (std::size_t first = 0; first < count; first += kFour) {
    const auto [a, b, c, d] = four_of(places, first);
    const Vec3x4 normal = search_normal(surface, Vec3x4(a.x, b.x, c.x, d.x),
                                        joined(a.reading, b.reading, c.reading, d.reading));
    for (int k = 0; k < kFour && first + k < count; ++k) normals[first + k] = normal.of(k);
  }
}

}  // namespace vpm
