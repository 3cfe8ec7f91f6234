// How many of the cloud's points lie strictly inside each sphere of a tool.
#pragma once

#include <math_constants.h>

#include "libvpm/query/cuda/team.h"
#include "libvpm/query/cuda/views.h"

namespace vpm::cuda {

// Adds one to the count of each sphere that holds the point. All threads of a warp together;
// `active`: this thread has a point.
__device__ inline void count_point(const LevelView& level, const Pose& to_tool, Vec3 point,
                                   bool active, std::uint32_t* counts) {
  constexpr std::uint32_t kNone = 0xffffffffU;
  std::uint32_t found = kNone;
  if (active) {
    for_spheres_at(level.grid, level.spheres, to_tool * point, [&](std::uint32_t sphere) {
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

// For a part of the pixels that the pose can reach; warps take pieces of rows.
__device__ inline void count_pixels(const LevelView& level, const PointsView& points,
                                    const PoseFrame& frame, std::uint32_t warp, std::uint32_t warps,
                                    std::uint32_t* counts) {
  const double reach_squared = level.spheres_reach * level.spheres_reach;
  const std::uint32_t lane = threadIdx.x % 32;
  const PixelRectangle r = frame.pixels;
  if (r.u0 > r.u1 || r.v0 > r.v1) return;
  const auto columns = static_cast<std::uint32_t>(r.u1 - r.u0 + 1);
  const std::uint32_t per_row = (columns + 31) / 32;
  const std::uint32_t count = per_row * static_cast<std::uint32_t>(r.v1 - r.v0 + 1);
  const Vec3f nowhere{CUDART_NAN_F, CUDART_NAN_F, CUDART_NAN_F};
  const auto position = [&](std::uint32_t k) {
    const std::uint32_t row = k / per_row, column = 32 * (k - row * per_row) + lane;
    if (k >= count || column >= columns) return nowhere;
    return points.positions[(r.v0 + row) * points.width + r.u0 + column];
  };
  Vec3f next = position(warp);
  for (std::uint32_t k = warp; k < count; k += warps) {
    const Vec3 point = widen(next);
    next = position(k + warps);  // read while this one is looked for
    const bool active = squared_norm(point - frame.center) <= reach_squared;
    count_point(level, frame.to_tool, point, active, counts);
  }
}

// For a part of the points that the pose can reach, by all threads of a block.
__device__ inline void count_points(const LevelView& level, const PointsView& points,
                                    const PoseFrame& frame, Part part, std::uint32_t* counts) {
  const std::uint32_t warp = part.part * (blockDim.x / 32) + threadIdx.x / 32;
  const std::uint32_t warps = part.parts * (blockDim.x / 32);
  if (points.width > 0) {
    count_pixels(level, points, frame, warp, warps, counts);
    return;
  }
  const double reach_squared = level.spheres_reach * level.spheres_reach;
  constexpr std::uint32_t kLeaf = DiskSurface::kLeafSize;
  for (std::uint32_t first = 32 * warp; first < points.count; first += 32 * warps) {
    const std::uint32_t k = first + threadIdx.x % 32;
    const bool active =
        k < points.count &&
        DiskSurface::squared_distance(points.leaves[k / kLeaf], frame.center) <= reach_squared;
    const Vec3 point = active ? widen(points.positions[k]) : Vec3{};
    count_point(level, frame.to_tool, point, active, counts);
  }
}

}  // namespace vpm::cuda
