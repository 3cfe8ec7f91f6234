// Visits the cloud's points that a pose can reach, and counts those strictly inside spheres.
#pragma once

#include <math_constants.h>

#include "libvpm/backend/cuda/lanes.h"
#include "libvpm/backend/cuda/views.h"

namespace vpm::cuda {

// Adds one to the count of each sphere that holds the point. Call from all threads of a warp;
// `active` ones have a point.
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
  // Adds once per sphere and warp, since neighbouring pixels lie in few spheres.
  for (unsigned rest = __ballot_sync(~0U, found != kNone); rest != 0;) {
    const int leader = __ffs(static_cast<int>(rest)) - 1;
    const unsigned same = __ballot_sync(~0U, found == __shfl_sync(~0U, found, leader));
    if (static_cast<int>(threadIdx.x % 32) == leader) atomicAdd(&counts[found], __popc(same));
    rest &= ~same;
  }
}

// Calls visit(index, point, active) for a part of the pixels that the pose can reach, from all
// threads of a warp; warps take pieces of rows. `active` means within `reach`, m, of the centre.
template <class Visit>
__device__ void for_pixels(const PointsView& points, const PoseFrame& frame, double reach,
                           std::uint32_t warp, std::uint32_t warps, const Visit& visit) {
  const double reach_squared = reach * reach;
  const std::uint32_t lane = threadIdx.x % 32;
  const PixelRectangle r = frame.pixels;
  if (is_empty(r)) return;
  const auto columns = static_cast<std::uint32_t>(r.u1 - r.u0 + 1);
  const std::uint32_t per_row = (columns + 31) / 32;
  const std::uint32_t count = per_row * static_cast<std::uint32_t>(r.v1 - r.v0 + 1);
  const Vec3f nowhere{CUDART_NAN_F, CUDART_NAN_F, CUDART_NAN_F};
  const auto index = [&](std::uint32_t k) {
    const std::uint32_t row = k / per_row, column = 32 * (k - row * per_row) + lane;
    return (r.v0 + row) * points.width + r.u0 + column;
  };
  const auto position = [&](std::uint32_t k) {
    const std::uint32_t column = 32 * (k % per_row) + lane;
    if (k >= count || column >= columns) return nowhere;
    return points.positions[index(k)];
  };
  Vec3f next = position(warp);
  for (std::uint32_t k = warp; k < count; k += warps) {
    const Vec3 point = widen(next);
    next = position(k + warps);  // loaded while this point is visited
    visit(index(k), point, squared_norm(point - frame.center) <= reach_squared);
  }
}

// Calls visit(index, point, active) for the points of any cloud, by all threads of a block.
template <class Visit>
__device__ void for_points(const PointsView& points, const PoseFrame& frame, double reach,
                           BlockRange part, const Visit& visit) {
  const std::uint32_t warp = part.part * (blockDim.x / 32) + threadIdx.x / 32;
  const std::uint32_t warps = part.parts * (blockDim.x / 32);
  if (points.width > 0) {
    for_pixels(points, frame, reach, warp, warps, visit);
    return;
  }
  const double reach_squared = reach * reach;
  for (std::uint32_t first = 32 * warp; first < points.count; first += 32 * warps) {
    const std::uint32_t k = first + threadIdx.x % 32;
    const bool active =
        k < points.count && points.tree.leaf_of(k).squared_distance(frame.center) <= reach_squared;
    visit(k, active ? widen(points.positions[k]) : Vec3{}, active);
  }
}

// Counts a part of the points that the pose can reach. Call from all threads of a block.
__device__ inline void count_points(const LevelView& level, const PointsView& points,
                                    const PoseFrame& frame, BlockRange part,
                                    std::uint32_t* counts) {
  for_points(points, frame, level.spheres_reach, part, [&](std::uint32_t, Vec3 point, bool active) {
    count_point(level, frame.to_tool, point, active, counts);
  });
}

}  // namespace vpm::cuda
