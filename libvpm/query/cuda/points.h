// The cloud's points that lie strictly inside spheres of a tool, as libvpm/query/points_inside.h
// walks them.
#pragma once

#include "libvpm/query/cuda/team.h"
#include "libvpm/query/cuda/views.h"

namespace vpm::cuda {

// Calls visit(sphere, point, x), x in tool coordinates, for this thread's part of the points.
// Returns how many of them lie inside.
template <class Visit>
__device__ std::uint32_t try_point(const LevelView& level, const PointsView& points,
                                   const Pose& to_tool, std::uint32_t point, const Visit& visit) {
  const Vec3 x = to_tool * widen(points.positions[point]);
  std::uint32_t inside = 0;
  for_spheres_at(level.grid, level.spheres, x, [&](std::uint32_t sphere) {
    inside = 1;
    visit(sphere, point, x);
  });
  return inside;
}

template <class Visit>
__device__ std::uint32_t for_points_inside(const LevelView& level, const PointsView& points,
                                           const PoseFrame& frame, Share share,
                                           const Visit& visit) {
  if (share.parts == 0) return 0;
  const std::uint32_t first = share.part * blockDim.x + threadIdx.x;
  const std::uint32_t step = share.parts * blockDim.x;
  std::uint32_t found = 0;
  if (points.width > 0) {
    const PixelRectangle r = frame.pixels;
    if (r.u0 > r.u1 || r.v0 > r.v1) return 0;
    const auto columns = static_cast<std::uint32_t>(r.u1 - r.u0 + 1);
    const std::uint32_t count = columns * static_cast<std::uint32_t>(r.v1 - r.v0 + 1);
    for (std::uint32_t k = first; k < count; k += step) {
      const std::uint32_t pixel = (r.v0 + k / columns) * points.width + r.u0 + k % columns;
      found += try_point(level, points, frame.to_tool, pixel, visit);
    }
    return found;
  }
  const double reach_squared = level.tool_reach * level.tool_reach;
  constexpr std::uint32_t kLeaf = DiskSurface::kLeafSize;
  for (std::uint32_t k = first; k < points.count; k += step) {
    if (DiskSurface::squared_distance(points.leaves[k / kLeaf], frame.center) <= reach_squared)
      found += try_point(level, points, frame.to_tool, k, visit);
  }
  return found;
}

}  // namespace vpm::cuda
