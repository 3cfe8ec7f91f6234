#include "tests/solid/pair_cases.h"

namespace vpm::test {
namespace {

// Keeps what lies below the plane n.x = offset (Sutherland and Hodgman 1974).
std::vector<Vec3> below_plane(const std::vector<Vec3>& polygon, Vec3 n, double offset) {
  std::vector<Vec3> kept;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vec3 p = polygon[k], q = polygon[(k + 1) % polygon.size()];
    const double at_p = dot(n, p) - offset, at_q = dot(n, q) - offset;
    if (at_p <= 0) kept.push_back(p);
    if ((at_p <= 0) != (at_q <= 0)) kept.push_back(p + at_p / (at_p - at_q) * (q - p));
  }
  return kept;
}

}  // namespace

std::vector<Vec3> clipped(std::vector<Vec3> polygon, const Solid& convex) {
  for (const auto& [i, j, k] : convex.triangles) {
    const Vec3 a = convex.vertices[i];
    const Vec3 n = normalized_or_zero(cross(convex.vertices[j] - a, convex.vertices[k] - a));
    polygon = below_plane(polygon, n, dot(n, a));
    if (polygon.empty()) break;
  }
  return polygon;
}

MassProperties convex_intersection(const Solid& a, const Solid& b) {
  double six_volumes = 0;
  Vec3 moment;
  for (const auto& [own, other] : {std::pair(&a, &b), std::pair(&b, &a)}) {
    for (const auto& [i, j, k] : own->triangles) {
      const std::vector<Vec3> part =
          clipped({own->vertices[i], own->vertices[j], own->vertices[k]}, *other);
      for (std::size_t m = 2; m < part.size(); ++m) {
        const double six = dot(part[0], cross(part[m - 1], part[m]));
        six_volumes += six;
        moment += six * (part[0] + part[m - 1] + part[m]);
      }
    }
  }
  if (!(six_volumes > 0)) return {};
  return {six_volumes / 6, moment / (4 * six_volumes)};
}

}  // namespace vpm::test
