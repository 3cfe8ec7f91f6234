#include "libvpm/packing/solid_cells.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>

#include "libvpm/core/box.h"
#include "libvpm/graph/enclosing_sphere.h"

namespace vpm {
namespace {

// More balls of a cell than these are joined, those of each of so many parts along each axis.
constexpr std::size_t kMostBalls = 96;
constexpr int kParts = 6;
// Relative to the longest side, for the rounding of cuts, of which none is above 1e-14.
constexpr double kTolerance = 1e-9;

double& along(Vec3& p, int axis) {
  return axis == 0 ? p.x : axis == 1 ? p.y : p.z;
}

// Keeps what a polygon has on one side of the plane where the coordinate is `at`: above it if
// `sign` is 1, below it if it is -1.
void cut(std::vector<Vec3>& polygon, std::vector<Vec3>& kept, int axis, double at, double sign) {
  kept.clear();
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vec3 a = polygon[k], b = polygon[(k + 1) % polygon.size()];
    const double above_a = sign * (coordinate(a, axis) - at),
                 above_b = sign * (coordinate(b, axis) - at);
    if (above_a >= 0) kept.push_back(a);
    if ((above_a > 0 && above_b < 0) || (above_a < 0 && above_b > 0)) {
      Vec3 p = a + (above_a / (above_a - above_b)) * (b - a);
      along(p, axis) = at;
      kept.push_back(p);
    }
  }
  polygon.swap(kept);
}

// Joins the balls of each part of a cell to one that holds them.
std::vector<Sphere> joined(const Cell& cell, const std::vector<Sphere>& balls) {
  std::map<std::array<int, 3>, std::vector<Sphere>> parts;
  for (const Sphere& ball : balls) {
    std::array<int, 3> part{};
    for (int axis = 0; axis < 3; ++axis) {
      const double low = coordinate(cell.low, axis), side = coordinate(cell.high, axis) - low;
      const double at = side > 0 ? (coordinate(ball.center, axis) - low) / side : 0;
      part[static_cast<std::size_t>(axis)] =
          std::clamp(static_cast<int>(kParts * at), 0, kParts - 1);
    }
    parts[part].push_back(ball);
  }
  std::vector<Sphere> fewer;
  for (const auto& [part, members] : parts) fewer.push_back(enclosing_sphere(members));
  return fewer;
}

}  // namespace

Vec3 Cell::corner(int k) const {
  return {k & 1 ? high.x : low.x, k & 2 ? high.y : low.y, k & 4 ? high.z : low.z};
}

double Cell::longest() const {
  return std::max({high.x - low.x, high.y - low.y, high.z - low.z});
}

double Cell::volume() const {
  return (high.x - low.x) * (high.y - low.y) * (high.z - low.z);
}

std::array<Cell, 2> Cell::halves() const {
  const int axis = Box{low, high}.longest_axis();
  std::array<Cell, 2> both{*this, *this};
  along(both[0].high, axis) = along(both[1].low, axis) = coordinate(center(), axis);
  return both;
}

SolidCells::SolidCells(const Solid& solid, const Enclosure* enclosure)
    : distance_(solid, enclosure) {
  const UnitFrame& frame = distance_.frame();
  Box box;
  for (const Vec3& vertex : solid.vertices) box.add(frame.to_unit(vertex));
  box_ = {box.low, box.high};
  tolerance_ = std::max(kTolerance * frame.longest, frame.rounding / frame.scale);
}

SolidCells::Place SolidCells::place(const Cell& cell) const {
  const Vec3 center = cell.center();
  const double reach = norm(cell.high - center) + tolerance_;
  if (distance_.closest(center, reach).triangle != SurfacePoint::kNone) return Place::cut;
  return distance_.inside(center) ? Place::inside : Place::outside;
}

bool SolidCells::is_outside(Vec3 corner) const {
  // Whoever is on the surface to rounding counts as inside.
  return distance_.closest(corner, tolerance_).triangle == SurfacePoint::kNone &&
         !distance_.is_inside_near(corner);
}

std::vector<Sphere> SolidCells::hull(const Cell& cell, double slack) const {
  std::vector<Sphere> balls;
  for (int k = 0; k < 8; ++k)
    if (!is_outside(cell.corner(k))) balls.push_back({cell.corner(k), slack});
  std::vector<std::uint32_t> found(256);
  const double reach = 0.5 * cell.longest() + tolerance_;
  std::size_t count = distance_.around(cell.center(), reach, found);
  while (count > found.size()) {
    found.resize(8 * found.size());
    count = distance_.around(cell.center(), reach, found);
  }
  std::vector<Vec3> polygon, kept;
  for (std::size_t k = 0; k < count; ++k) {
    const TriangleBvh::Corners& t = distance_.corners(found[k]);
    polygon = {t.a, t.b, t.c};
    for (int axis = 0; axis < 3 && !polygon.empty(); ++axis) {
      cut(polygon, kept, axis, coordinate(cell.low, axis) - tolerance_, 1);
      cut(polygon, kept, axis, coordinate(cell.high, axis) + tolerance_, -1);
    }
    for (const Vec3& p : polygon) balls.push_back({p, slack});
  }
  return balls.size() > kMostBalls ? joined(cell, balls) : balls;
}

}  // namespace vpm
