#include "libvpm/packing/solid_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libvpm/core/error.h"
#include "libvpm/mesh/triangle_bvh.h"

namespace vpm {
namespace {

// Rounding in units in the last place: of three coordinates on both ways, and of a distance to a
// triangle of aspect 1:1000. Needles of this aspect were measured to need 5.
constexpr double kFrameRoundings = 8;
constexpr double kDistanceRoundings = 64;

// Least width of a face, and least distance from it, for it to decide sides; rounding is far less.
constexpr double kTelling = 1e-9;

// Relative amount by which radii shrink on the way back to metres.
constexpr double kMargin = 1e-12;

UnitFrame unit_frame(const Solid& solid) {
  Vec3 low{HUGE_VAL, HUGE_VAL, HUGE_VAL}, high{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
  for (const Vec3 p : solid.vertices) {
    if (!is_finite(p)) refuse("the solid has a vertex that is not finite", {}, "repair the mesh");
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  const Vec3 side = high - low;
  const double longest = std::max({side.x, side.y, side.z});
  if (!(longest > 0) || !std::isfinite(longest)) {
    refuse("the solid has no extent", {}, "a packing needs a mesh that encloses a volume");
  }
  UnitFrame frame;
  frame.center = low + 0.5 * side;
  frame.scale = std::ldexp(1.0, std::ilogb(longest) + 1);
  frame.longest = longest / frame.scale;
  const double farthest = std::max({std::abs(low.x), std::abs(low.y), std::abs(low.z),
                                    std::abs(high.x), std::abs(high.y), std::abs(high.z)});
  // Adds rounding on the way to the frame and back, which grows with the distance from the origin,
  // and rounding of distances to triangles with small angles.
  frame.rounding = std::numeric_limits<double>::epsilon() *
                   (kFrameRoundings * farthest + kDistanceRoundings * frame.scale);
  return frame;
}

std::vector<Vec3> in_unit_frame(const Solid& solid, const UnitFrame& frame) {
  std::vector<Vec3> vertices;
  vertices.reserve(solid.vertices.size());
  for (const Vec3 p : solid.vertices) vertices.push_back(frame.to_unit(p));
  return vertices;
}

}  // namespace

Sphere UnitFrame::to_solid(const Sphere& s) const {
  return {to_solid(s.center), (1 - kMargin) * s.radius * scale - rounding};
}

SolidDistance::SolidDistance(const Solid& solid, const Enclosure* enclosure)
    : frame_(unit_frame(solid)),
      vertices_(in_unit_frame(solid, frame_)),
      triangles_(solid.triangles),
      mesh_(vertices_, triangles_),
      winding_(mesh_),
      boundary_(&mesh_) {
  std::optional<Enclosure> found;
  if (enclosure == nullptr) enclosure = &found.emplace(enclosure_of(solid));
  faces_tell_ = enclosure->faces_tell;
  volume_ = enclosure->volume;
  if (!enclosure->surface) return;
  vertices_ = in_unit_frame(*enclosure->surface, frame_);
  triangles_ = enclosure->surface->triangles;
  boundary_ = &surface_.emplace(vertices_, triangles_);
}

Vec3 SolidDistance::closest_on(std::uint32_t triangle, Vec3 x) const {
  const auto [a, b, c] = triangles_[triangle];
  return closest_point_on_triangle(x, vertices_[a], vertices_[b], vertices_[c]);
}

std::optional<bool> SolidDistance::inside_of_face(std::uint32_t nearest, Vec3 x) const {
  const auto [i, j, k] = triangles_[nearest];
  const Vec3 a = vertices_[i], b = vertices_[j], c = vertices_[k];
  const Vec3 ab = b - a, bc = c - b, ca = a - c, normal = cross(bc, ca);
  const double normal2 = squared_norm(normal), height = dot(normal, x - a);
  const double edge2 = std::max({squared_norm(ab), squared_norm(bc), squared_norm(ca)});
  const bool sure = faces_tell_ && normal2 > kTelling * kTelling * edge2 &&
                    height * height > kTelling * kTelling * normal2;
  const auto beyond = [&](Vec3 edge, Vec3 from) { return dot(cross(normal, edge), x - from) < 0; };
  if (!sure || beyond(ab, a) || beyond(bc, b) || beyond(ca, c)) return std::nullopt;
  return height < 0;
}

bool SolidDistance::is_inside_near(Vec3 x) const {
  const SurfacePoint nearest = boundary_->closest(x);
  const std::optional<bool> told =
      nearest.triangle == SurfacePoint::kNone ? std::nullopt : inside_of_face(nearest.triangle, x);
  return told ? *told : inside(x);
}

bool SolidDistance::holds_disk(std::uint32_t triangle, Vec3 point, double radius) const {
  const auto [a, b, c] = triangles_[triangle];
  const auto beyond = [&](std::uint32_t from, std::uint32_t to) {
    const Vec3 along = vertices_[to] - vertices_[from];
    return squared_norm(cross(along, point - vertices_[from])) >=
           radius * radius * squared_norm(along);
  };
  return beyond(a, b) && beyond(b, c) && beyond(c, a);
}

}  // namespace vpm
