// Walks the cloud's points that lie strictly inside spheres of a tool: cost follows the tool's
// reach, not the cloud.
#pragma once

#include <atomic>
#include <utility>
#include <vector>

#include "libvpm/core/parallel.h"
#include "libvpm/query/prepared_cloud.h"
#include "libvpm/query/sphere_location.h"

namespace vpm {

// How a point finds its sphere; the results are the same bits.
enum class PointLocation { grid, hierarchy };

using PointRanges = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

// Calls visit(sphere, point, x), x in tool coordinates, from several threads at once. Returns the
// number of distinct points inside. `ranges` is scratch.
template <class Visit>
std::uint32_t for_points_inside(const PreparedCloud& cloud, const ToolModel& tool,
                                const Level& level, PointLocation location, const Pose& pose,
                                PointRanges& ranges, const Visit& visit) {
  const Pose to_tool = relative_to(pose, {{}, cloud.origin()});
  const Vec3 center = pose.rotation * tool.center_of_mass + (pose.translation - cloud.origin());
  ranges.clear();
  cloud.for_ranges_in_ball(center, tool.reach,
                           [&](std::uint32_t b, std::uint32_t e) { ranges.emplace_back(b, e); });

  const GridView grid = view_of(level.grid);
  std::atomic<std::uint32_t> total{0};
  constexpr std::size_t kRangesPerTask = 16;
  parallel_for(ranges.size(), kRangesPerTask, [&](std::size_t begin, std::size_t end) {
    std::uint32_t found = 0;
    for (std::size_t r = begin; r < end; ++r) {
      for (std::uint32_t k = ranges[r].first; k < ranges[r].second; ++k) {
        const Vec3 x = to_tool * widen(cloud.positions()[k]);
        bool inside = false;
        const auto take = [&](std::uint32_t sphere) {
          inside = true;
          visit(sphere, k, x);
        };
        if (location == PointLocation::grid) {
          for_spheres_at(grid, tool.spheres.data(), x, take);
        } else {
          for_spheres_at(level.hierarchy, tool.spheres.data(), x, take);
        }
        found += inside;
      }
    }
    total.fetch_add(found, std::memory_order_relaxed);
  });
  return total;
}

}  // namespace vpm
