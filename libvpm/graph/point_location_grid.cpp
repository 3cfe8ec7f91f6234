#include "libvpm/graph/point_location_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace vpm {
namespace {

constexpr double kCellsPerSphere = 4;
constexpr double kMaxCells = 16777216;  // 2^24: 64 MiB of row offsets
// Distance, in grid cells, that a point may have from the grid cell of its rounded index.
constexpr double kIndexMargin = 1e-6;

struct Box {
  Vec3 low, high;
};

Box box_of(std::span<const Sphere> spheres) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Box box{{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};
  for (const Sphere& s : spheres) {
    const Vec3 low = s.center - Vec3{s.radius, s.radius, s.radius};
    const Vec3 high = s.center + Vec3{s.radius, s.radius, s.radius};
    box.low = {std::min(box.low.x, low.x), std::min(box.low.y, low.y), std::min(box.low.z, low.z)};
    box.high = {std::max(box.high.x, high.x), std::max(box.high.y, high.y),
                std::max(box.high.z, high.z)};
  }
  return box;
}

// Returns the rounding error of coordinates far from the origin, which no margin relative to the
// grid cell covers.
double coordinate_rounding(const Box& box) {
  const double largest =
      std::max({std::abs(box.low.x), std::abs(box.low.y), std::abs(box.low.z), std::abs(box.high.x),
                std::abs(box.high.y), std::abs(box.high.z)});
  return 8 * std::numeric_limits<double>::epsilon() * largest;
}

std::uint32_t cells_along(double extent, double cell) {
  return static_cast<std::uint32_t>(extent / cell) + 1;
}

double cell_for(Vec3 extent, double cells) {
  // Takes the cube root of a normalised number: it rounds differently for different exponents, but
  // scaling by a power of two must change no digit.
  const double unit = std::ldexp(1.0, std::ilogb(extent.x));
  const double ratio = extent.y / unit * (extent.z / unit) * (extent.x / unit);
  double cell = unit * std::cbrt(ratio / cells);
  // The grid has one cell more along each axis than the extent holds, so the cells of a thin box
  // are enlarged until their number keeps the limit.
  constexpr double kGrow = 1.0625;
  const auto count = [&] {
    return (extent.x / cell + 1) * (extent.y / cell + 1) * (extent.z / cell + 1);
  };
  while (count() > std::min(2 * cells, kMaxCells)) cell *= kGrow;
  return cell;
}

// Calls visit(index) for every grid cell that the sphere intersects, x fastest.
template <class Visit>
void for_cells(const PointLocationGrid& grid, const Sphere& s, double margin, Visit&& visit) {
  const double r = s.radius + margin;
  const auto first = [&](double value) {
    return static_cast<std::uint32_t>(std::max(0.0, std::floor((value - r) / grid.cell)));
  };
  const auto last = [&](double value, std::uint32_t n) {
    return static_cast<std::uint32_t>(
        std::clamp(std::floor((value + r) / grid.cell), 0.0, n - 1.0));
  };
  // Returns the distance along one axis between the centre and grid cell k.
  const auto apart = [&](double value, std::uint32_t k) {
    const double low = k * grid.cell, high = low + grid.cell;
    return value < low ? low - value : (value > high ? value - high : 0.0);
  };
  const Vec3 c = s.center - grid.low;
  for (std::uint32_t z = first(c.z); z <= last(c.z, grid.nz); ++z) {
    const double dz = apart(c.z, z);
    for (std::uint32_t y = first(c.y); y <= last(c.y, grid.ny); ++y) {
      const double dy = apart(c.y, y);
      for (std::uint32_t x = first(c.x); x <= last(c.x, grid.nx); ++x) {
        const double dx = apart(c.x, x);
        if (dx * dx + dy * dy + dz * dz <= r * r) {
          visit((std::size_t{z} * grid.ny + y) * grid.nx + x);
        }
      }
    }
  }
}

}  // namespace

PointLocationGrid build_point_location_grid(std::span<const Sphere> spheres) {
  const Box box = box_of(spheres);
  const double count = std::min(kCellsPerSphere * static_cast<double>(spheres.size()), kMaxCells);
  PointLocationGrid grid;
  grid.cell = cell_for(box.high - box.low, count);
  const double margin = kIndexMargin * grid.cell + coordinate_rounding(box);
  grid.low = box.low - Vec3{margin, margin, margin};
  const Vec3 extent = box.high - grid.low + Vec3{margin, margin, margin};
  grid.nx = cells_along(extent.x, grid.cell);
  grid.ny = cells_along(extent.y, grid.cell);
  grid.nz = cells_along(extent.z, grid.cell);

  grid.begin.assign(std::size_t{grid.nx} * grid.ny * grid.nz + 1, 0);
  for (const Sphere& s : spheres) {
    for_cells(grid, s, margin, [&](std::size_t cell) { ++grid.begin[cell + 1]; });
  }
  for (std::size_t cell = 1; cell < grid.begin.size(); ++cell)
    grid.begin[cell] += grid.begin[cell - 1];
  grid.spheres.resize(grid.begin.back());
  std::vector<std::uint32_t> next(grid.begin.begin(), grid.begin.end() - 1);
  for (std::uint32_t i = 0; i < spheres.size(); ++i) {
    for_cells(grid, spheres[i], margin, [&](std::size_t cell) { grid.spheres[next[cell]++] = i; });
  }
  return grid;
}

}  // namespace vpm
