#include "libvpm/mesh/ray_crossings.h"

#include "libvpm/core/box.h"

namespace vpm {
namespace {

// Bounds on what rounding decides, relative to the lengths that are multiplied: far above the few
// roundings of the products, for directions and for distances from a triangle's plane. The latter
// is above what solid angles (shells.cpp, winding_number.cpp) take for a point on a triangle.
constexpr double kDoubtfulSide = 1e-14, kDoubtfulHeight = 1e-8;

struct Flat {
  double x, y, size;
};

Flat along_ray(Vec3 p) {
  const Vec3 d = RayCrossings::kDirection;
  return {p.x - d.x * p.z, p.y - d.y * p.z, std::abs(p.x) + std::abs(p.y) + std::abs(p.z)};
}

// Returns the sign of the turn from p to q about the ray, 0 if rounding could decide.
int turn(const Flat& p, const Flat& q) {
  const double area = p.x * q.y - p.y * q.x, bound = kDoubtfulSide * p.size * q.size;
  return area > bound ? 1 : area < -bound ? -1 : 0;
}

// Slack of comparisons with sheared triangles, relative to the mesh's size: above the heights that
// are doubtful for a point in the mesh.
constexpr double kSlack = 1e-7;

Box box_around(const std::vector<Vec3>& vertices) {
  Box box;
  for (const Vec3& p : vertices) box.add(p);
  return box;
}

Vec3 center_of(const std::vector<Vec3>& vertices) {
  const Box box = box_around(vertices);
  return box.low + 0.5 * box.size();
}

}  // namespace

RayCrossings::RayCrossings(const std::vector<Vec3>& vertices,
                           const std::vector<Triangle>& triangles)
    : vertices_(vertices),
      triangles_(triangles),
      center_(center_of(vertices)),
      slack_(kSlack * norm(box_around(vertices).size())),
      bvh_(sheared(vertices, center_), triangles) {}

std::vector<Vec3> RayCrossings::sheared(const std::vector<Vec3>& vertices, Vec3 center) {
  std::vector<Vec3> result;
  result.reserve(vertices.size());
  for (const Vec3& p : vertices) result.push_back(sheared(p - center));
  return result;
}

Crossing RayCrossings::crossing(Vec3 x, Vec3 a, Vec3 b, Vec3 c) {
  const Vec3 p = a - x, q = b - x, r = c - x;
  const Flat u = along_ray(p), v = along_ray(q), w = along_ray(r);
  const int uv = turn(u, v), vw = turn(v, w), wu = turn(w, u);
  const bool left = uv > 0 || vw > 0 || wu > 0, right = uv < 0 || vw < 0 || wu < 0;
  if (left && right) return Crossing::none;
  const double height = dot(p, cross(q, r)), bound = kDoubtfulHeight * norm(p) * norm(q) * norm(r);
  const bool above = left ? height > bound : height < -bound;
  const bool below = left ? height < -bound : height > bound;
  if (uv != 0 && vw != 0 && wu != 0 && (above || below))
    return below ? Crossing::none : left ? Crossing::outward : Crossing::inward;
  // A triangle seen edge-on passes the ray if all corners lie on one side of it.
  const auto beside = [](double i, double j, double k, double size) {
    const double near = kDoubtfulSide * size;
    return (i > near && j > near && k > near) || (i < -near && j < -near && k < -near);
  };
  const double size = u.size + v.size + w.size;
  return beside(u.x, v.x, w.x, size) || beside(u.y, v.y, w.y, size) ? Crossing::none
                                                                    : Crossing::doubtful;
}

}  // namespace vpm
