// Walks a body's points strictly inside spheres of a tool. Cost follows the tool, not the body.
#pragma once

#include <atomic>
#include <utility>
#include <vector>

#include "libvpm/backend/sphere_location.h"
#include "libvpm/core/parallel.h"
#include "libvpm/core/pose.h"

namespace vpm {

using PointRanges = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

// Calls visit(sphere, point, x), x in tool coordinates, from several threads at once. Returns the
// number of distinct points inside. `points` are those of a body (BodyKind::prepared); `ranges` is
// scratch.
template <class Points, class Visit>
std::uint32_t for_points_inside(const Points& points, const ToolModel& tool, const Level& level,
                                const Pose& pose, PointRanges& ranges, const Visit& visit) {
  const Pose to_tool = relative_to(pose, {{}, points.origin()});
  const Vec3 center = pose.rotation * tool.center_of_mass + (pose.translation - points.origin());
  ranges.clear();
  ranges.reserve(points.most_ranges());
  points.for_ranges_in_ball(center, tool.radius,
                            [&](std::uint32_t b, std::uint32_t e) { ranges.emplace_back(b, e); });

  const GridView grid = view_of(level.grid);
  std::atomic<std::uint32_t> total{0};
  constexpr std::size_t kRangesPerTask = 16;
  ParallelRegion region;
  region.loop(ranges.size(), kRangesPerTask, [&](std::size_t begin, std::size_t end) {
    std::uint32_t found = 0;
    for (std::size_t r = begin; r < end; ++r) {
      for (std::uint32_t k = ranges[r].first; k < ranges[r].second; ++k) {
        const Vec3 x = to_tool * widen(points.positions()[k]);
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

}  // namespace vpm
