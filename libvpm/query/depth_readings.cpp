#include "libvpm/query/depth_readings.h"

#include "libvpm/core/vector_clones.h"
#include "libvpm/surface/depth_lanes.h"

namespace vpm {

VPM_VECTOR_CLONES
void read_four(const DepthSurface& surface, const Vec3 (&places)[4], Reading (&readings)[4]) {
  const LaneReading reading =
      DepthLanes(surface).read({places[0], places[1], places[2], places[3]});
  for (int k = 0; k < kFour; ++k) readings[k] = reading.of(k, surface.width);
}

VPM_VECTOR_CLONES
std::uint32_t read_samples(const DepthSurface& surface, const Pose& to_surface,
                           std::span<const CellSample> samples, SampleReading* readings) {
  const DepthLanes depths(surface);
  const auto count = static_cast<std::uint32_t>(samples.size());
  std::uint32_t found = 0;
  for (std::uint32_t first = 0; first < count; first += kFour) {
    const auto [a, b, c, d] = four_of(samples, first);
    const Vec3x4 x = to_surface * Vec3x4(a.center, b.center, c.center, d.center);
    const Double4 radius = widen(Float4{a.radius, b.radius, c.radius, d.radius});
    const LaneReading reading = depths.read(x);
    const Mask4 reached = reading.known & (reading.distance < radius);
    if (!any(reached)) continue;
    for (int k = 0; k < kFour && first + k < count; ++k) {
      if (reached[k] != 0) readings[found++] = {first + k, {x.of(k), reading.of(k, surface.width)}};
    }
  }
  return found;
}

VPM_VECTOR_CLONES
void closest_normals(const DepthSurface& surface, std::span<const PlaceReading> places,
                     Vec3* normals) {
  const DepthLanes depths(surface);
  const std::size_t count = places.size();
  for (std::size_t first = 0; first < count; first += kFour) {
    const auto [a, b, c, d] = four_of(places, first);
    const LaneReading reading(a.reading, b.reading, c.reading, d.reading, surface.width);
    const Vec3x4 normal = depths.closest_normal({a.x, b.x, c.x, d.x}, reading);
    for (int k = 0; k < kFour && first + k < count; ++k) normals[first + k] = normal.of(k);
  }
}

}  // namespace vpm
