// The cloud's points that lie strictly inside spheres of a tool, as libvpm/query/points_inside.h
// walks them.
#pragma once

#include "libvpm/query/cuda/team.h"
#include "libvpm/query/cuda/views.h"

namespace vpm::cuda {

// Calls visit(sphere, point, x), x in tool coordinates, for every sphere that holds the point.
template <class Visit>
__device__ void try_point(const LevelView& level, const PointsView& points, const Pose& to_tool,
                          std::uint32_t point, const Visit& visit) {
  const Vec3 x = to_tool * widen(points.positions[point]);
  for_spheres_at(level.grid, level.spheres, x,
                 [&](std::uint32_t sphere) { visit(sphere, point, x); });
}

// The same for this thread's part of the points.
template <class Visit>
__device__ void for_points_inside(const LevelView& level, const PointsView& points,
                                  const PoseFrame& frame, Share share, const Visit& visit) {
  if (share.parts == 0) return;
  const std::uint32_t first = share.part * blockDim.x + threadIdx.x;
  const std::uint32_t step = share.parts * blockDim.x;
  const double reach_squared = level.spheres_reach * level.spheres_reach;
  if (points.width > 0) {
    const PixelRectangle r = frame.pixels;
    if (r.u0 > r.u1 || r.v0 > r.v1) return;
    const auto columns = static_cast<std::uint32_t>(r.u1 - r.u0 + 1);
    const std::uint32_t count = columns * static_cast<std::uint32_t>(r.v1 - r.v0 + 1);
    for (std::uint32_t k = first; k < count; k += step) {
      const std::uint32_t pixel = (r.v0 + k / columns) * points.width + r.u0 + k % columns;
      // Not so where the pixel has no point.
      if (squared_norm(widen(points.positions[pixel]) - frame.center) <= reach_squared)
        try_point(level, points, frame.to_tool, pixel, visit);
    }
    return;
  }
  constexpr std::uint32_t kLeaf = DiskSurface::kLeafSize;
  for (std::uint32_t k = first; k < points.count; k += step) {
    if (DiskSurface::squared_distance(points.leaves[k / kLeaf], frame.center) <= reach_squared)
      try_point(level, points, frame.to_tool, k, visit);
  }
}

}  // namespace vpm::cuda
