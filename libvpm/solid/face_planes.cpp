#include "libvpm/solid/face_planes.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace vpm {
namespace {

// Distance from a plane, relative to the reach, up to which vertices lie in it: files hold places
// in 24 bits.
constexpr double kFlat = 0x1p-20;

using Plane = FacePlanes::Plane;
using OfTriangle = FacePlanes::Near::OfTriangle;

// Convex polygon: a triangle that planes clip adds one corner for each.
struct Polygon {
  std::array<Vec3, 3 + FacePlanes::kMost> corner;
  std::size_t count = 0;

  void add(Vec3 x) { corner[count++] = x; }
};

// Sets `kept` to the part of a polygon where the first plane is nearer below than the second.
void clip(const Polygon& polygon, const Plane& nearer, const Plane& other, Polygon& kept) {
  const auto further = [&](Vec3 x) { return nearer.depth(x) - other.depth(x); };
  kept.count = 0;
  Vec3 from = polygon.corner[polygon.count - 1];
  double at_from = further(from);
  for (std::size_t k = 0; k < polygon.count; ++k) {
    const Vec3 to = polygon.corner[k];
    const double at_to = further(to);
    if ((at_from <= 0) != (at_to <= 0)) kept.add(from + at_from / (at_from - at_to) * (to - from));
    if (at_to <= 0) kept.add(to);
    from = to, at_from = at_to;
  }
}

// Adds the depth below one plane over a convex polygon.
void add(std::span<const Vec3> polygon, const Plane& plane, Vec3 normal, OfTriangle& sum) {
  if (polygon.empty()) return;
  const auto key = [](double depth, Vec3 at) { return std::tuple(depth, at.x, at.y, at.z); };
  for (const Vec3& x : polygon) {
    const double depth = plane.depth(x);
    if (key(depth, x) > key(sum.greatest, sum.deepest)) sum.greatest = depth, sum.deepest = x;
  }
  const Vec3 a = polygon[0];
  const double at_a = plane.depth(a);
  for (std::size_t k = 2; k < polygon.size(); ++k) {
    const Vec3 b = polygon[k - 1], c = polygon[k];
    const double at_b = plane.depth(b), at_c = plane.depth(c), all = at_a + at_b + at_c;
    const double area = 0.5 * dot(cross(b - a, c - a), normal);
    sum.integral.volume += area / 3 * all;
    sum.integral.moment += area / 12 * (at_a * a + at_b * b + at_c * c + all * (a + b + c));
  }
}

double area2_of(std::span<const Vec3> vertices, const Triangle& t) {
  return squared_norm(cross(vertices[t[1]] - vertices[t[0]], vertices[t[2]] - vertices[t[0]]));
}

}  // namespace

std::optional<FacePlanes> FacePlanes::of(std::span<const Vec3> vertices,
                                         std::span<const Triangle> triangles, double reach) {
  const double flat = kFlat * reach;
  FacePlanes found;
  const auto lies_in = [&](const Triangle& t) {
    return std::ranges::any_of(found.planes_, [&](const Plane& plane) {
      return std::ranges::all_of(
          t, [&](std::uint32_t v) { return std::abs(plane.depth(vertices[v])) <= flat; });
    });
  };
  // Large triangles first: the planes of slivers are those of rounding.
  std::vector<std::pair<double, std::uint32_t>> by_area;
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    by_area.emplace_back(-area2_of(vertices, triangles[t]), t);
  std::ranges::sort(by_area);
  for (const auto& [area2, t] : by_area) {
    if (lies_in(triangles[t])) continue;
    if (found.planes_.size() == kMost) return std::nullopt;
    const auto& [i, j, k] = triangles[t];
    const Vec3 a = vertices[i];
    const Vec3 normal = normalized_or_zero(cross(vertices[j] - a, vertices[k] - a));
    const Plane plane{normal, dot(normal, a)};
    if (std::ranges::any_of(vertices, [&](Vec3 x) { return plane.depth(x) < -flat; }))
      return std::nullopt;
    found.planes_.push_back(plane);
  }
  return found;
}

Depth FacePlanes::depth(Vec3 x) const {
  Depth least{HUGE_VAL, {}};
  for (const Plane& plane : planes_)
    if (const double depth = plane.depth(x); depth < least.value) least = {depth, -plane.normal};
  return least;
}

std::optional<Depth> FacePlanes::linear_depth(Vec3 x, double radius) const {
  const Depth least = depth(x);
  const auto stays_further = [&](const Plane& plane) {
    const double more = plane.depth(x) - least.value;
    const Vec3 turned = plane.normal + least.gradient;
    return more >= radius * norm(turned);
  };
  if (std::ranges::all_of(planes_, stays_further)) return least;
  return std::nullopt;
}

void FacePlanes::place(const FacePlanes& own, const Pose& pose, double per_metre) {
  planes_.clear();
  for (const auto& [normal, offset] : own.planes_) {
    const Vec3 placed = pose.rotation * normal;
    planes_.push_back({placed, per_metre * (offset + dot(placed, pose.translation))});
  }
}

FacePlanes::Near::Near(std::span<const Plane> planes, const std::array<Vec3, 3>& corner) {
  const Vec3 middle = (corner[0] + corner[1] + corner[2]) / 3;
  const Plane& first = *std::ranges::min_element(
      planes, {}, [&](const Plane& plane) { return plane.depth(middle); });
  planes_[count_++] = first;
  const std::array<double, 3> least{first.depth(corner[0]), first.depth(corner[1]),
                                    first.depth(corner[2])};
  // One that is nearer than the first anywhere in the triangle is so at a corner.
  for (const Plane& plane : planes) {
    if (plane.depth(corner[0]) < least[0] || plane.depth(corner[1]) < least[1] ||
        plane.depth(corner[2]) < least[2])
      planes_[count_++] = plane;
  }
}

OfTriangle FacePlanes::Near::of_triangle(const std::array<Vec3, 3>& corner, Vec3 normal) const {
  OfTriangle sum;
  if (count_ == 1) {
    add(corner, planes_[0], normal, sum);
    return sum;
  }
  const Near near({planes_.data(), count_}, corner);
  std::array<Polygon, 2> polygons;
  Polygon *polygon = &polygons[0], *kept = &polygons[1];
  for (std::size_t i = 0; i < near.count_; ++i) {
    polygon->count = 0;
    for (const Vec3& x : corner) polygon->add(x);
    for (std::size_t j = 0; j < near.count_ && polygon->count > 0; ++j) {
      if (j == i) continue;
      clip(*polygon, near.planes_[i], near.planes_[j], *kept);
      std::swap(polygon, kept);
    }
    add(std::span(polygon->corner).first(polygon->count), near.planes_[i], normal, sum);
  }
  return sum;
}

}  // namespace vpm
