#include "libvpm/packing/thin_part.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "libvpm/core/box.h"

namespace vpm {
namespace {

constexpr std::size_t kMaxTriangles = 48, kMaxGapTriangles = 256;
// Size of the region searched, in half edges: the way from a point between the planes to the nearer
// one must not leave it.
constexpr double kAround = 1.5;
// Distance from the planes, in half edges, of points that tell the side beyond them.
constexpr double kBeyond = 0.1;
constexpr double kRounding = 1e-13;  // rounding of coordinates in the unit cube

using Polygon = std::vector<Vec3>;

// Writes the part of a convex polygon about the origin with sign * coordinate <= limit to `kept`.
void clip(const Polygon& polygon, int axis, double sign, double limit, Polygon& kept) {
  kept.clear();
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vec3 p = polygon[k], q = polygon[k + 1 < polygon.size() ? k + 1 : 0];
    const double beyond_p = sign * coordinate(p, axis) - limit,
                 beyond_q = sign * coordinate(q, axis) - limit;
    if (beyond_p <= 0) kept.push_back(p);
    if ((beyond_p <= 0) != (beyond_q <= 0))
      kept.push_back(p + beyond_p / (beyond_p - beyond_q) * (q - p));
  }
}

// Returns the part of a triangle in the cube with this half edge, relative to its centre.
Polygon clipped(const TriangleBvh::Corners& t, Vec3 center, double half_edge) {
  constexpr std::size_t kCorners = 3 + 6;  // each side of the cube adds one at most
  Polygon polygon, kept;
  polygon.reserve(kCorners), kept.reserve(kCorners);
  polygon = {t.a - center, t.b - center, t.c - center};
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {-1.0, 1.0}) {
      clip(polygon, axis, sign, half_edge, kept);
      polygon.swap(kept);
    }
  }
  return polygon;
}

struct Face {
  Polygon polygon;  // relative to the cube's centre
  Vec3 normal;      // unit normal of the triangle
  double area = 0;  // area of the polygon
};

double area_of(const Polygon& polygon) {
  Vec3 twice;
  for (std::size_t k = 2; k < polygon.size(); ++k)
    twice += cross(polygon[k - 1] - polygon[0], polygon[k] - polygon[0]);
  return 0.5 * norm(twice);
}

Vec3 normal_of(const TriangleBvh::Corners& t) {
  return normalized_or_zero(cross(t.b - t.a, t.c - t.a));
}

// Returns the parts of the triangles in the cube with this half edge.
std::vector<Face> faces_in(const SolidDistance& solid, std::span<const std::uint32_t> triangles,
                           Vec3 center, double half_edge) {
  std::vector<Face> faces;
  for (const std::uint32_t index : triangles) {
    const TriangleBvh::Corners& t = solid.corners(index);
    Polygon polygon = clipped(t, center, half_edge);
    const double area = area_of(polygon);
    if (!polygon.empty()) faces.push_back({std::move(polygon), normal_of(t), area});
  }
  return faces;
}

}  // namespace

ThinPart thin_part(const SolidDistance& solid, Vec3 center, double half_edge) {
  const double around = kAround * half_edge;
  std::array<std::uint32_t, kMaxTriangles> found;
  const std::size_t count = solid.around(center, around, found);
  if (count == 0 || count > kMaxTriangles) return {};
  const std::span<const std::uint32_t> triangles(found.data(), count);
  const Vec3 first = normal_of(solid.corners(found[0]));
  const auto turns_away = [&](std::uint32_t t) {
    return dot(normal_of(solid.corners(t)), first) <= 0.5;
  };
  if (std::none_of(triangles.begin(), triangles.end(), turns_away)) return {HUGE_VAL, false};

  const std::vector<Face> faces = faces_in(solid, triangles, center, around);
  const auto widest = std::max_element(
      faces.begin(), faces.end(), [](const Face& a, const Face& b) { return a.area < b.area; });
  if (widest == faces.end() || !(widest->area > 0)) return {};
  const Vec3 up = widest->normal;
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (const Face& face : faces) {
    for (const Vec3& p : face.polygon) {
      low = std::min(low, dot(up, p) - kRounding);
      high = std::max(high, dot(up, p) + kRounding);
    }
  }
  const double above = std::max(0.0, high + kBeyond * half_edge),
               below = std::min(0.0, low - kBeyond * half_edge);
  const bool in_sight = high - low <= 2 * (around - half_edge) && above < around && -below < around;
  if (!in_sight || solid.inside(center + above * up) || solid.inside(center + below * up))
    return {};
  return {.bound = 0.5 * (high - low)};
}

// The ray ends outside if it reaches the plane above all triangles around the cube, which turns its
// back on the sphere, and if a point beyond that plane is outside. It starts at the sphere's
// surface, so it climbs from there only.
double gap_bound(const SolidDistance& solid, const Sphere& sphere, Vec3 center, double half_edge,
                 double below) {
  const double around = kAround * half_edge, margin = kBeyond * half_edge;
  const Vec3 from = center - sphere.center;
  const double distance = norm(from), half_diagonal = std::sqrt(3.0) * half_edge;
  if (!(distance > half_diagonal)) return HUGE_VAL;
  const Vec3 up = from / distance;
  // Points of the cube outside of the sphere are at least this high above the cube's centre, and
  // their rays this steep.
  const double across = std::min(half_diagonal / sphere.radius, 1.0);
  const double low =
      std::max(sphere.radius * std::sqrt(1 - across * across) - distance, -half_diagonal);
  const double steepness = (distance + low) / std::hypot(distance + low, half_diagonal);
  const double highest = std::min(around, low + (around - half_edge) * steepness) - margin;
  const double reach = sphere.radius + 2 * below;

  std::array<std::uint32_t, kMaxGapTriangles> found;
  const std::size_t count = solid.around(center, around, found);
  if (count == 0 || count > kMaxGapTriangles) return HUGE_VAL;
  double high = -around, farthest2 = 0;
  const auto is_below = [&](Vec3 p) {
    return dot(up, p) <= high && squared_norm(from + p) <= farthest2;
  };
  for (std::size_t k = 0; k < count; ++k) {
    const TriangleBvh::Corners& t = solid.corners(found[k]);
    if (is_below(t.a - center) && is_below(t.b - center) && is_below(t.c - center)) continue;
    for (const Vec3& p : clipped(t, center, around)) {
      high = std::max(high, dot(up, p));
      farthest2 = std::max(farthest2, squared_norm(from + p));
    }
    if (high > highest || farthest2 > reach * reach) return HUGE_VAL;
  }
  if (solid.is_inside_near(center + (high + margin) * up)) return HUGE_VAL;
  return 0.5 * (std::sqrt(farthest2) - sphere.radius + kRounding);
}

}  // namespace vpm
