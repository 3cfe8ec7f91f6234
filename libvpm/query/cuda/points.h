// How many of the cloud's points lie strictly inside each sphere of a tool.
#pragma once

#include "libvpm/query/cuda/team.h"
#include "libvpm/query/cuda/views.h"

namespace vpm::cuda {

// Adds one to the count of each sphere that holds the point. All threads of a warp together;
// `active`: this thread has a point.
__device__ inline void count_point(const LevelView& level, const PointsView& points,
                                   const Pose& to_tool, std::uint32_t point, bool active,
                                   std::uint32_t* counts) {
  constexpr std::uint32_t kNone = 0xffffffffU;
  std::uint32_t found = kNone;
  if (active) {
    const Vec3 x = to_tool * widen(points.positions[point]);
    for_spheres_at(level.grid, level.spheres, x, [&](std::uint32_t sphere) {
      if (found != kNone) atomicAdd(&counts[found], 1U);
      found = sphere;
    });
  }
  // Neighbouring pixels lie in few spheres: one addition for each.
  for (unsigned rest = __ballot_sync(~0U, found != kNone); rest != 0;) {
    const int leader = __ffs(static_cast<int>(rest)) - 1;
    const unsigned same = __ballot_sync(~0U, found == __shfl_sync(~0U, found, leader));
    if (static_cast<int>(threadIdx.x % 32) == leader) atomicAdd(&counts[found], __popc(same));
    rest &= ~same;
  }
}

// For a part of the points that the pose can reach, by all threads of a block.
__device__ inline void count_points(const LevelView& level, const PointsView& points,
                                    const PoseFrame& frame, Part part, std::uint32_t* counts) {
  const std::uint32_t warp = part.part * (blockDim.x / 32) + threadIdx.x / 32;
  const std::uint32_t warps = part.parts * (blockDim.x / 32), lane = threadIdx.x % 32;
  const double reach_squared = level.spheres_reach * level.spheres_reach;
  if (points.width > 0) {
    const PixelRectangle r = frame.pixels;
    if (r.u0 > r.u1 || r.v0 > r.v1) return;
    const auto columns = static_cast<std::uint32_t>(r.u1 - r.u0 + 1);
    const std::uint32_t per_row = (columns + 31) / 32;
    const std::uint32_t count = per_row * static_cast<std::uint32_t>(r.v1 - r.v0 + 1);
    for (std::uint32_t k = warp; k < count; k += warps) {
      const std::uint32_t row = k / per_row, column = 32 * (k - row * per_row) + lane;
      const std::uint32_t pixel = (r.v0 + row) * points.width + r.u0 + column;
      // Not so where the pixel has no point.
      const bool active = column < columns && squared_norm(widen(points.positions[pixel]) -
                                                           frame.center) <= reach_squared;
      count_point(level, points, frame.to_tool, pixel, active, counts);
    }
    return;
  }
  constexpr std::uint32_t kLeaf = DiskSurface::kLeafSize;
  for (std::uint32_t first = 32 * warp; first < points.count; first += 32 * warps) {
    const std::uint32_t k = first + lane;
    const bool active =
        k < points.count &&
        DiskSurface::squared_distance(points.leaves[k / kLeaf], frame.center) <= reach_squared;
    count_point(level, points, frame.to_tool, k, active, counts);
  }
}

}  // namespace vpm::cuda
