#include "libvpm/packing/cell_room.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "libvpm/packing/thin_part.h"

namespace vpm {
namespace {

// Distance of the mesh from a cell's centre, in half diagonals, up to which thin parts are searched
// for.
constexpr float kNearFace = 0.5f;
// A sphere counts as nearest to a point if no triangle is nearer than its distance plus these
// relative and absolute margins: a triangle that it touches may lie between.
constexpr double kBehind = 1e-3, kTouching = 1e-9;

float round_down(double v) {
  return std::nextafter(static_cast<float>(v), 0.0f);
}

float round_up(double v) {
  return std::nextafter(static_cast<float>(v), HUGE_VALF);
}

}  // namespace

CellRoom::Cell CellRoom::root(const ListedSpheres& listed) const {
  Cell root{};
  root.x = root.y = root.z = 0.5f;
  root.triangle = SurfacePoint::kNone;
  estimate(root, listed);
  measure(root);
  return root;
}

// Returns the surface point nearest to the cell's centre, if nearer than `within`. Starts from the
// triangle nearest to a parent's centre, which makes the search short.
SurfacePoint CellRoom::nearest_on_mesh(const Cell& cell, double within) const {
  const Vec3 x = cell.center();
  if (cell.triangle == SurfacePoint::kNone) return solid_.closest(x, within);
  const Vec3 p = solid_.closest_on(cell.triangle, x);
  const SurfacePoint known{p, norm(x - p), cell.triangle};
  if (cell.exact) return known.distance < within ? known : SurfacePoint{};
  if (known.distance >= within) return solid_.closest(x, within);
  const SurfacePoint nearer = solid_.closest(x, known.distance);
  return nearer.triangle == SurfacePoint::kNone ? known : nearer;
}

// Sets d and bound from the spheres and from the triangle nearest to a parent. Needs cell.mesh.
void CellRoom::estimate(Cell& cell, const ListedSpheres& listed) const {
  const Vec3 x = cell.center();
  double d = listed.distance, bound = d + half_diagonal(cell.level);
  const auto take = [&](const Sphere& s) {
    const Vec3 from = x - s.center;
    if (is_beyond(from, s.radius, d)) return;
    const double beside = norm(from) - s.radius;
    if (beside >= d) return;
    d = beside;
    bound = farthest(cell, s);
  };
  for (const std::uint32_t i : listed.spheres) take(spheres_[i]);
  cell.measured = d <= cell.mesh;
  if (!cell.measured && cell.triangle != SurfacePoint::kNone)
    take({solid_.closest_on(cell.triangle, x), 0});
  cell.d = static_cast<float>(d);
  cell.bound = round_up(bound);
}

void CellRoom::measure(Cell& cell) const {
  cell.measured = true;
  const SurfacePoint p = nearest_on_mesh(cell, cell.d);
  if (p.triangle != SurfacePoint::kNone) {
    cell.triangle = p.triangle;
    cell.exact = true;
    cell.d = static_cast<float>(p.distance);
    cell.bound = std::min(cell.bound, round_up(farthest(cell, {p.point, 0})));
  }
  cell.mesh = std::max(cell.mesh, round_down(cell.d));
  // This centre and the parent's are on the same side if both lie in a ball that the mesh does not
  // meet.
  const bool same = cell.side == Side::unknown && cell.mesh > half_diagonal(cell.level);
  settle(cell, same ? cell.parent : cell.side);
}

void CellRoom::bound_narrow_part(Cell& cell, const ListedSpheres& listed) const {
  const float half = half_diagonal(cell.level);
  if (cell.mesh > kNearFace * half) return;
  const Vec3 x = cell.center();
  const double half_edge = edge_of_level(cell.level + 1);
  if (!cell.thick) {
    const ThinPart part = thin_part(solid_, x, half_edge);
    cell.thick = !part.faces_meet;
    cell.bound = std::min(cell.bound, round_up(part.bound));
  }
  const Sphere* nearest = nullptr;
  double beside = half;
  for (const std::uint32_t i : listed.spheres) {
    const double d = norm(x - spheres_[i].center) - spheres_[i].radius;
    if (d < beside) beside = d, nearest = &spheres_[i];
  }
  if (nearest != nullptr) {
    const double bound = gap_bound(solid_, *nearest, x, half_edge, cell.bound);
    cell.bound = std::min(cell.bound, round_up(bound));
  }
}

// Bounds the clearance over a cell by all nearby obstacles together. Distances are convex with
// curvature at most 1 / distance, so planes bound them from above within the cell.
double CellRoom::joint_bound(Cell& cell, const ListedSpheres& listed,
                             std::vector<LinearBound>& planes) const {
  const Vec3 x = cell.center();
  const double half = half_diagonal(cell.level), horizon = cell.d + 2 * half;
  planes.clear();
  const auto add = [&](Vec3 from, double radius, bool flat) {
    if (is_beyond(from, radius, horizon)) return;
    const double distance = norm(from);
    if (!(distance > 0) || distance - radius > horizon) return;
    const double curvature = flat ? 0 : 1 / distance;
    planes.push_back({from / distance, distance - radius + 0.5 * curvature * half * half});
  };
  for (const std::uint32_t i : listed.spheres)
    add(x - spheres_[i].center, spheres_[i].radius, false);
  if (cell.mesh < horizon) {
    const SurfacePoint p = nearest_on_mesh(cell, horizon);
    if (p.triangle != SurfacePoint::kNone) {
      cell.triangle = p.triangle;
      cell.exact = true;
      add(x - p.point, 0, solid_.holds_disk(p.triangle, p.point, half));
    }
    cell.mesh = std::max(cell.mesh, round_down(std::min(p.distance, horizon)));
  }
  if (planes.empty()) return HUGE_VAL;
  return max_min_step(planes, edge_of_level(cell.level + 1)).value;
}

// Returns the largest distance of a point of the cell from a sphere; it is at some corner.
double CellRoom::farthest(const Cell& cell, const Sphere& from) {
  const double h = edge_of_level(cell.level + 1);
  const Vec3 d = cell.center() - from.center;
  return norm({std::abs(d.x) + h, std::abs(d.y) + h, std::abs(d.z) + h}) - from.radius;
}

// Returns the side of a measured cell's centre. The nearest obstacle mostly decides: a face has the
// inside behind it, and a sphere lies inside. Winding numbers take far longer.
CellRoom::Side CellRoom::side_of(const Cell& cell, const ListedSpheres& listed) const {
  const Vec3 x = cell.center();
  std::uint32_t nearest = cell.exact ? cell.triangle : SurfacePoint::kNone;
  if (!cell.exact) {
    double beside = listed.distance;
    for (const std::uint32_t i : listed.spheres)
      beside = std::min(beside, norm(x - spheres_[i].center) - spheres_[i].radius);
    if (beside < listed.distance) {
      nearest = solid_.closest(x, std::max(beside, 0.0) * (1 + kBehind) + kTouching).triangle;
      if (nearest == SurfacePoint::kNone) return Side::inside;
    }
  }
  const std::optional<bool> told =
      nearest == SurfacePoint::kNone ? std::nullopt : solid_.inside_of_face(nearest, x);
  return (told ? *told : solid_.inside(x)) ? Side::inside : Side::outside;
}

// Sets the side of the centre; outside, that bounds the cell.
void CellRoom::settle(Cell& cell, Side side) {
  cell.side = side;
  if (side == Side::outside)
    cell.bound = std::min(cell.bound, half_diagonal(cell.level) - cell.mesh);
}

void CellRoom::split(const Cell& cell, const ListedSpheres& listed,
                     std::vector<Cell>& parts) const {
  const auto level = static_cast<std::uint8_t>(cell.level + 1);
  const auto offset = static_cast<float>(edge_of_level(level + 1));
  // Half a part's diagonal, which is the distance of its centre from the cell's.
  const float half = half_diagonal(level);
  for (int octant = 0; octant < 8; ++octant) {
    Cell part{};
    part.x = cell.x + (octant & 1 ? offset : -offset);
    part.y = cell.y + (octant & 2 ? offset : -offset);
    part.z = cell.z + (octant & 4 ? offset : -offset);
    part.mesh = cell.mesh - half;
    part.level = level;
    part.parent = cell.side;
    part.triangle = cell.triangle;
    part.thick = cell.thick;
    estimate(part, listed);
    part.bound = std::min(part.bound, cell.bound);
    if (cell.mesh > half) settle(part, cell.side);  // both centres lie in a ball without triangles
    if (part.bound > smallest_) parts.push_back(part);
  }
}

void CellRoom::bound_jointly(Cell& cell, const ListedSpheres& listed,
                             std::vector<LinearBound>& planes) const {
  cell.bound = std::min(cell.bound, round_up(joint_bound(cell, listed, planes)));
}

void CellRoom::find_side(Cell& cell, const ListedSpheres& listed) const {
  settle(cell, side_of(cell, listed));
}

void CellRoom::take_from(Cell& cell, const Sphere& sphere) {
  const Vec3 from = cell.center() - sphere.center;
  if (is_beyond(from, sphere.radius, double{std::max(cell.d, cell.bound)})) return;
  cell.d = std::min(cell.d, static_cast<float>(norm(from) - sphere.radius));
  cell.bound = std::min(cell.bound, round_up(farthest(cell, sphere)));
}

}  // namespace vpm
