#include "libvpm/packing/surface_gap.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "libvpm/core/parallel.h"
#include "libvpm/graph/sphere_bvh.h"

namespace vpm {
namespace {

constexpr std::size_t kSamples = 50000;
// Roberts' sequence, the two-dimensional golden ratio, spreads any number of points evenly.
constexpr double kRoberts1 = 0.7548776662466927, kRoberts2 = 0.5698402909980532;

// Returns points spread evenly over the surface's area.
std::vector<Vec3> samples_of(const Solid& solid) {
  std::vector<double> area_up_to;
  double area = 0;
  for (const auto& [a, b, c] : solid.triangles) {
    area += 0.5 * norm(cross(solid.vertices[b] - solid.vertices[a],
                             solid.vertices[c] - solid.vertices[a]));
    area_up_to.push_back(area);
  }
  std::vector<Vec3> points;
  std::size_t t = 0;
  for (std::size_t k = 0; k < kSamples; ++k) {
    const double at = area * (static_cast<double>(k) + 0.5) / kSamples;
    while (t + 1 < area_up_to.size() && area_up_to[t] < at) ++t;
    double u = kRoberts1 * static_cast<double>(k), v = kRoberts2 * static_cast<double>(k);
    u -= std::floor(u);
    v -= std::floor(v);
    if (u + v > 1) u = 1 - u, v = 1 - v;
    const auto [a, b, c] = solid.triangles[t];
    const Vec3 from = solid.vertices[a];
    points.push_back(from + u * (solid.vertices[b] - from) + v * (solid.vertices[c] - from));
  }
  return points;
}

std::vector<double> gaps_of(const std::vector<Vec3>& points, const SphereBvh& bvh, Vec3 origin,
                            double unit) {
  std::vector<double> gaps(points.size());
  constexpr std::size_t kTogether = 256;
  parallel_for(points.size(), kTogether, [&](std::size_t begin, std::size_t end) {
    std::uint32_t nearest = 0;
    for (std::size_t k = begin; k < end; ++k) {
      const Vec3 p = (points[k] - origin) / unit;
      nearest = bvh.nearest_surface(p, nearest);
      gaps[k] = unit * std::max(surface_distance(p, bvh.spheres()[nearest]), 0.0);
    }
  });
  return gaps;
}

}  // namespace

SurfaceGap surface_gap(const Solid& solid, const std::vector<Sphere>& spheres) {
  // Scales to coordinates of magnitude 1, which SphereBvh needs.
  const Vec3 origin = spheres.front().center;
  const double unit = reach(solid, origin);
  std::vector<Sphere> scaled;
  scaled.reserve(spheres.size());
  for (const Sphere& s : spheres) scaled.push_back({(s.center - origin) / unit, s.radius / unit});
  const SphereBvh bvh(scaled);

  std::vector<double> gaps = gaps_of(samples_of(solid), bvh, origin, unit);
  const std::vector<double> at_vertices = gaps_of(solid.vertices, bvh, origin, unit);
  std::sort(gaps.begin(), gaps.end());
  SurfaceGap result;
  for (const double gap : gaps) result.mean += gap / kSamples;
  result.p95 = gaps[kSamples * 95 / 100];
  result.largest = std::max(gaps.back(), *std::max_element(at_vertices.begin(), at_vertices.end()));
  return result;
}

}  // namespace vpm
