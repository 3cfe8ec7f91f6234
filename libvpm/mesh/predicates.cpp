#include "libvpm/mesh/predicates.h"

#include <array>
#include <cmath>

namespace vpm {
namespace {

int exact_orientation(Vec2 a, Vec2 b, Vec2 c) {
  Expansion<16> determinant;
  add_product(determinant, 1, difference(a.x, c.x), difference(b.y, c.y));
  add_product(determinant, -1, difference(a.y, c.y), difference(b.x, c.x));
  return determinant.sign();
}

// As kOrientationBound: Shewchuk's (3 + 16 e) e.
constexpr double kBound2 = (3 + 16 * kRoundingUnit) * kRoundingUnit;

}  // namespace

int orientation(Vec2 a, Vec2 b, Vec2 c) {
  const double left = (a.x - c.x) * (b.y - c.y), right = (a.y - c.y) * (b.x - c.x);
  const double determinant = left - right;
  const double bound = kBound2 * (std::abs(left) + std::abs(right));
  // A zero bound means that every term has a factor that is exactly zero.
  if (std::abs(determinant) > bound || bound == 0) return sign_of(determinant);
  return exact_orientation(a, b, c);
}

namespace {

using Corners = std::array<Vec3, 3>;

Vec2 without(Vec3 p, int axis) {
  if (axis == 0) return {p.y, p.z};
  if (axis == 1) return {p.z, p.x};
  return {p.x, p.y};
}

// Returns an axis along which the triangle is not seen edge-on; -1 if there is none.
int open_axis(const Corners& t) {
  const Vec3 normal = cross(t[1] - t[0], t[2] - t[0]);
  const std::array<double, 3> size{std::abs(normal.x), std::abs(normal.y), std::abs(normal.z)};
  const int largest = size[0] >= size[1] && size[0] >= size[2] ? 0 : size[1] >= size[2] ? 1 : 2;
  for (const int axis : {largest, (largest + 1) % 3, (largest + 2) % 3}) {
    if (orientation(without(t[0], axis), without(t[1], axis), without(t[2], axis)) != 0)
      return axis;
  }
  return -1;
}

// True if the closed segments a-b and c-d of a plane meet.
bool segments_meet(Vec2 a, Vec2 b, Vec2 c, Vec2 d) {
  const int abc = orientation(a, b, c), abd = orientation(a, b, d);
  const int cda = orientation(c, d, a), cdb = orientation(c, d, b);
  if (abc * abd > 0 || cda * cdb > 0) return false;
  if (abc != 0 || abd != 0 || cda != 0 || cdb != 0) return true;
  const auto apart = [](double p, double q, double r, double s) {
    return std::fmax(p, q) < std::fmin(r, s) || std::fmax(r, s) < std::fmin(p, q);
  };
  return !apart(a.x, b.x, c.x, d.x) && !apart(a.y, b.y, c.y, d.y);
}

bool holds(const std::array<Vec2, 3>& t, Vec2 p) {
  const int a = orientation(t[0], t[1], p), b = orientation(t[1], t[2], p),
            c = orientation(t[2], t[0], p);
  return (a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0);
}

bool segment_meets_coplanar(Vec3 p, Vec3 q, const Corners& t) {
  const int axis = open_axis(t);
  if (axis < 0) return false;
  const std::array<Vec2, 3> flat{without(t[0], axis), without(t[1], axis), without(t[2], axis)};
  const Vec2 a = without(p, axis), b = without(q, axis);
  return holds(flat, a) || segments_meet(a, b, flat[0], flat[1]) ||
         segments_meet(a, b, flat[1], flat[2]) || segments_meet(a, b, flat[2], flat[0]);
}

bool segment_meets(Vec3 p, Vec3 q, const Corners& t) {
  const int at_p = orientation(t[0], t[1], t[2], p), at_q = orientation(t[0], t[1], t[2], q);
  if (at_p * at_q > 0) return false;
  if (at_p == 0 && at_q == 0) return segment_meets_coplanar(p, q, t);
  const int a = orientation(p, q, t[0], t[1]), b = orientation(p, q, t[1], t[2]),
            c = orientation(p, q, t[2], t[0]);
  return (a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0);
}

Corners corners_of(const std::vector<Vec3>& vertices, const Triangle& t) {
  return {vertices[t[0]], vertices[t[1]], vertices[t[2]]};
}

// True if triangles that share one edge overlap: both lie in one plane, on the same side of the
// edge.
bool folded_flat(const Corners& s, Vec3 edge_from, Vec3 edge_to, Vec3 s_apex, Vec3 t_apex) {
  if (orientation(s[0], s[1], s[2], t_apex) != 0) return false;
  const int axis = open_axis(s);
  if (axis < 0) return false;
  const Vec2 from = without(edge_from, axis), to = without(edge_to, axis);
  return orientation(from, to, without(s_apex, axis)) ==
         orientation(from, to, without(t_apex, axis));
}

}  // namespace

bool has_area(Vec3 a, Vec3 b, Vec3 c) {
  return open_axis({a, b, c}) >= 0;
}

bool triangles_intersect(const std::vector<Vec3>& vertices, const Triangle& s, const Triangle& t) {
  std::array<bool, 3> s_shared{}, t_shared{};
  int shared = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      if (s[i] != t[j]) continue;
      s_shared[i] = t_shared[j] = true;
      ++shared;
    }
  }
  const Corners a = corners_of(vertices, s), b = corners_of(vertices, t);
  if (shared == 3) return true;
  if (shared == 0) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (segment_meets(a[k], a[(k + 1) % 3], b) || segment_meets(b[k], b[(k + 1) % 3], a))
        return true;
    }
    return false;
  }
  const auto place = [](const std::array<bool, 3>& marks, bool wanted) {
    return static_cast<std::size_t>(marks[0] == wanted ? 0 : marks[1] == wanted ? 1 : 2);
  };
  if (shared == 2) {
    const std::size_t i = place(s_shared, false), j = place(t_shared, false);
    return folded_flat(a, a[(i + 1) % 3], a[(i + 2) % 3], a[i], b[j]);
  }
  // Triangles that share one vertex: any other common point reaches the opposite edge of one of
  // them.
  const std::size_t i = place(s_shared, true), j = place(t_shared, true);
  return segment_meets(a[(i + 1) % 3], a[(i + 2) % 3], b) ||
         segment_meets(b[(j + 1) % 3], b[(j + 2) % 3], a);
}

}  // namespace vpm
