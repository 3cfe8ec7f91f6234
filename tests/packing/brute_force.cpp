#include "tests/packing/brute_force.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace vpm::test {
namespace {

using Long = long double;
using Point = std::array<Long, 3>;

Point minus(const Point& a, const Point& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Long inner(const Point& a, const Point& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Point outer(const Point& a, const Point& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Long length(const Point& a) {
  return std::sqrt(inner(a, a));
}
Point about(Vec3 x, Vec3 origin) {
  return {Long{x.x} - origin.x, Long{x.y} - origin.y, Long{x.z} - origin.z};
}

// Returns the distance of the origin from the segment.
Long to_segment(const Point& a, const Point& b) {
  const Point ab = minus(b, a);
  const Long t = std::clamp(-inner(a, ab) / inner(ab, ab), Long{0}, Long{1});
  return length({a[0] + t * ab[0], a[1] + t * ab[1], a[2] + t * ab[2]});
}

// Returns the distance of the origin from the triangle, by barycentric coordinates of its foot.
Long to_triangle(const Point& a, const Point& b, const Point& c) {
  const Point ab = minus(b, a), ac = minus(c, a);
  const Long bb = inner(ab, ab), bc = inner(ab, ac), cc = inner(ac, ac);
  const Long b0 = -inner(a, ab), c0 = -inner(a, ac);
  const Long det = bb * cc - bc * bc;
  const Long v = (cc * b0 - bc * c0) / det, w = (bb * c0 - bc * b0) / det;
  if (v >= 0 && w >= 0 && v + w <= 1) {
    const Point n = outer(ab, ac);
    return std::abs(inner(n, a)) / length(n);
  }
  return std::min({to_segment(a, b), to_segment(b, c), to_segment(c, a)});
}

Long solid_angle(const Point& a, const Point& b, const Point& c) {
  const Long la = length(a), lb = length(b), lc = length(c);
  return 2 * std::atan2(inner(a, outer(b, c)),
                        la * lb * lc + inner(a, b) * lc + inner(b, c) * la + inner(c, a) * lb);
}

}  // namespace

double distance_to_mesh(const Solid& solid, Vec3 x) {
  Long best = HUGE_VALL;
  for (const auto& [a, b, c] : solid.triangles)
    best = std::min(best, to_triangle(about(solid.vertices[a], x), about(solid.vertices[b], x),
                                      about(solid.vertices[c], x)));
  return static_cast<double>(best);
}

bool encloses(const Solid& solid, Vec3 x) {
  Long sum = 0;
  for (const auto& [a, b, c] : solid.triangles)
    sum += solid_angle(about(solid.vertices[a], x), about(solid.vertices[b], x),
                       about(solid.vertices[c], x));
  return std::abs(sum) > 2 * Long{kPi};
}

double worst_protrusion(const Solid& solid, const std::vector<Sphere>& spheres) {
  double worst = -HUGE_VAL;
  for (const Sphere& s : spheres) {
    const double d = distance_to_mesh(solid, s.center);
    worst = std::max(worst, s.radius - (encloses(solid, s.center) ? d : -d));
  }
  return worst;
}

double worst_overlap(const std::vector<Sphere>& spheres) {
  double worst = -HUGE_VAL;
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const Long gap = length(about(spheres[i].center, spheres[j].center));
      worst =
          std::max(worst, static_cast<double>(Long{spheres[i].radius} + spheres[j].radius - gap));
    }
  }
  return worst;
}

double separation(const Solid& solid, const std::vector<Sphere>& spheres, Vec3 x,
                  std::size_t except) {
  double d = distance_to_mesh(solid, x);
  if (!encloses(solid, x)) d = -d;
  for (std::size_t i = 0; i < spheres.size(); ++i)
    if (i != except) d = std::min(d, norm(x - spheres[i].center) - spheres[i].radius);
  return d;
}

}  // namespace vpm::test
