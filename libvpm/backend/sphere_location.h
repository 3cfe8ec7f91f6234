// Finds the spheres of a packing that hold a point strictly inside, by the grid of the tool model.
#pragma once

#include <cstdint>

#include "libvpm/model/tool_model.h"

namespace vpm {

VPM_HD constexpr bool strictly_inside(const Sphere& s, Vec3 x) {
  return squared_norm(x - s.center) < s.radius * s.radius;
}

// Holds plain pointers to a PointLocationGrid, for host or device.
struct GridView {
  Vec3 low;
  double cell = 0;
  std::uint32_t nx = 0, ny = 0, nz = 0;
  const std::uint32_t* begin = nullptr;
  const std::uint32_t* spheres = nullptr;
};
inline GridView view_of(const PointLocationGrid& grid) {
  return {grid.low, grid.cell, grid.nx, grid.ny, grid.nz, grid.begin.data(), grid.spheres.data()};
}

// Calls visit(index) for every sphere that strictly holds x, tool coordinates.
template <class Visit>
VPM_HD void for_spheres_at(const GridView& grid, const Sphere* spheres, Vec3 x,
                           const Visit& visit) {
  const Vec3 at = (x - grid.low) / grid.cell;
  if (!(at.x >= 0 && at.y >= 0 && at.z >= 0 && at.x < grid.nx && at.y < grid.ny && at.z < grid.nz))
    return;
  const std::size_t cell =
      (static_cast<std::size_t>(at.z) * grid.ny + static_cast<std::size_t>(at.y)) * grid.nx +
      static_cast<std::size_t>(at.x);
  for (std::uint32_t k = grid.begin[cell]; k < grid.begin[cell + 1]; ++k) {
    if (strictly_inside(spheres[grid.spheres[k]], x)) visit(grid.spheres[k]);
  }
}

}  // namespace vpm
