// Points with normals on the surfaces of solids, seen from all sides.
#pragma once

#include <cmath>
#include <functional>

#include "libvpm/cloud/cloud.h"
#include "libvpm/core/vec3.h"

namespace vpm {

// Returns the signed distance of a place to a solid's surface, m, negative inside.
using SolidDistance = std::function<double(Vec3)>;

inline void add_point(Vec3 place, Vec3 normal, double spacing, Cloud& cloud) {
  cloud.positions.push_back(narrow(place));
  cloud.normals.push_back(narrow(normalized_or_zero(normal)));
  cloud.radii.push_back(static_cast<float>(0.7 * spacing));
}

// Adds the faces of a box that faces outward, or, of a cavity, inward (`side` is -1). Its middle
// and half widths are given. Points stand in the middle of squares as wide as the spacing, or
// nearly.
inline void add_box(Vec3 middle, Vec3 half, double side, double spacing, Cloud& cloud) {
  const double halves[3] = {half.x, half.y, half.z};
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const auto columns = static_cast<int>(std::lround(2 * halves[u] / spacing)),
               rows = static_cast<int>(std::lround(2 * halves[v] / spacing));
    for (const double end : {-1.0, 1.0}) {
      for (int i = 0; i < columns; ++i) {
        for (int k = 0; k < rows; ++k) {
          double at[3], normal[3] = {};
          at[axis] = end * halves[axis];
          at[u] = halves[u] * ((2 * i + 1.0) / columns - 1);
          at[v] = halves[v] * ((2 * k + 1.0) / rows - 1);
          normal[axis] = end * side;
          add_point(middle + Vec3{at[0], at[1], at[2]}, {normal[0], normal[1], normal[2]}, spacing,
                    cloud);
        }
      }
    }
  }
}

// Adds a ball about the origin, by points on a spiral of equal areas; only those for which
// `is_seen(place)` is true.
template <class IsSeen>
void add_ball(double radius, double spacing, const IsSeen& is_seen, Cloud& cloud) {
  const double golden = 2.399963229728653;  // angle between points that follow each other
  const auto count = static_cast<int>(12.566370614 * radius * radius / (spacing * spacing));
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2 * i + 1.0) / count, across = std::sqrt(1 - z * z);
    const Vec3 n{across * std::cos(golden * i), across * std::sin(golden * i), z};
    if (is_seen(n)) add_point(radius * n, n, spacing, cloud);
  }
}

// Adds a torus about the z axis.
inline void add_torus(double large, double small, double spacing, Cloud& cloud) {
  const double turn = 6.283185307179586;
  const auto around = static_cast<int>(turn * small / spacing);
  for (int k = 0; k < around; ++k) {
    const double b = turn * k / around, radius = large + small * std::cos(b);
    const auto count = static_cast<int>(turn * radius / spacing);
    for (int i = 0; i < count; ++i) {
      const double a = turn * (i + 0.5 * (k % 2)) / count;
      const Vec3 n{std::cos(a) * std::cos(b), std::sin(a) * std::cos(b), std::sin(b)};
      add_point(Vec3{large * std::cos(a), large * std::sin(a), 0} + small * n, n, spacing, cloud);
    }
  }
}

inline double box_distance(Vec3 x, Vec3 half) {
  const Vec3 d{std::fabs(x.x) - half.x, std::fabs(x.y) - half.y, std::fabs(x.z) - half.z};
  const Vec3 out{std::fmax(d.x, 0), std::fmax(d.y, 0), std::fmax(d.z, 0)};
  return norm(out) + std::fmin(std::fmax(d.x, std::fmax(d.y, d.z)), 0);
}

}  // namespace vpm
