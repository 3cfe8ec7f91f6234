// Walks the cloud's points strictly inside spheres of a tool. Cost follows the tool, not the cloud.
#pragma once

#include <atomic>
#include <utility>
#include <vector>

#include "libvpm/backend/sphere_location.h"
#include "libvpm/core/parallel.h"
#include "libvpm/scene/prepared_cloud.h"

namespace vpm {

using PointRanges = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

// Calls visit(sphere, point, x), x in tool coordinates, from several threads at once. Returns the
// number of distinct points inside. `ranges` is scratch.
template <class Visit>
std::uint32_t for_points_inside(const PreparedCloud& cloud, const ToolModel& tool,
                                const Level& level, const Pose& pose, PointRanges& ranges,
                                const Visit& visit) {
  const Pose to_tool = relative_to(pose, {{}, cloud.origin()});
  const Vec3 center = pose.rotation * tool.center_of_mass + (pose.translation - cloud.origin());
  ranges.clear();
  ranges.reserve(cloud.most_ranges());
  cloud.for_ranges_in_ball(center, tool.reach,
                           [&](std::uint32_t b, std::uint32_t e) { ranges.emplace_back(b, e); });

  const GridView grid = view_of(level.grid);
  std::atomic<std::uint32_t> total{0};
  constexpr std::size_t kRangesPerTask = 16;
  ParallelRegion region;
  region.loop(ranges.size(), kRangesPerTask, [&](std::size_t begin, std::size_t end) {
    std::uint32_t found = 0;
    for (std::size_t r = begin; r < end; ++r) {
      for (std::uint32_t k = ranges[r].first; k < ranges[r].second; ++k) {
        const Vec3 x = to_tool * widen(cloud.positions()[k]);
        bool inside = false;
        const auto take = [&](std::uint32_t sphere) {
          inside = true;
          visit(sphere, k, x);
        };
        for_spheres_at(grid, tool.spheres.data(), x, take);
        found += inside;
      }
    }
    total.fetch_add(found, std::memory_order_relaxed);
  });
  return total;
}

// Counts those points sphere by sphere, for callers that know which spheres have any.
class PointsOfSphere {
 public:
  PointsOfSphere(const PreparedCloud& cloud, const Pose& pose)
      : cloud_(cloud),
        to_tool_(relative_to(pose, {{}, cloud.origin()})),
        to_cloud_(relative_to({{}, cloud.origin()}, pose)) {}

  // Returns the number of points in a sphere whose ball was classified.
  std::uint32_t count(const Sphere& sphere, const DepthSurface::BallClass& in_ball) const {
    const Near near = near_to(sphere);
    std::uint32_t found = 0;
    cloud_.for_ranges_in_pixels(in_ball.pixels, [&](std::uint32_t begin, std::uint32_t end) {
      found += count(near, begin, end);
    });
    return found;
  }
  template <class BallClass>
  std::uint32_t count(const Sphere& sphere, const BallClass&) const {
    const Near near = near_to(sphere);
    std::uint32_t found = 0;
    cloud_.for_ranges_in_ball(
        near.center, near.radius,
        [&](std::uint32_t begin, std::uint32_t end) { found += count(near, begin, end); });
    return found;
  }

 private:
  // Describes a ball about the cloud's origin that holds the sphere despite rounding.
  struct Near {
    const Sphere& sphere;
    Vec3 center;
    double radius;
  };
  Near near_to(const Sphere& sphere) const {
    constexpr double kRounding = 1e-9;  // far above that of double
    const Vec3 center = to_cloud_ * sphere.center;
    const double rounded = sphere.radius + norm(sphere.center) + norm(center);
    return {sphere, center, sphere.radius + kRounding * rounded};
  }
  // Tests points against the ball first; few need the exact test.
  std::uint32_t count(const Near& near, std::uint32_t begin, std::uint32_t end) const {
    std::uint32_t found = 0;
    const double squared = near.radius * near.radius;
    for (std::uint32_t k = begin; k < end; ++k) {
      const Vec3 x = widen(cloud_.positions()[k]);
      if (squared_norm(x - near.center) < squared)
        found += strictly_inside(near.sphere, to_tool_ * x);
    }
    return found;
  }

  const PreparedCloud& cloud_;
  Pose to_tool_, to_cloud_;
};

}  // namespace vpm
