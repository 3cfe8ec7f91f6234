// Solid angles as seen from the origin: the terms of winding numbers, which say how often a surface
// encloses a place. Their sum over a surface about the place is kFullSolidAngle times that number.
#pragma once

#include <cmath>

#include "libvpm/core/host_device.h"
#include "libvpm/core/vec3.h"

namespace vpm {

inline constexpr double kFullSolidAngle = 4 * 3.14159265358979323846;

// Holds the signed solid angle of a triangle (van Oosterom, Strackee 1983, "The solid angle of a
// plane triangle"): positive where the origin is on its inner side.
class TriangleAngle {
 public:
  TriangleAngle(Vec3 a, Vec3 b, Vec3 c) {
    const double la = norm(a), lb = norm(b), lc = norm(c);
    lengths_ = la * lb * lc;
    above_ = dot(a, cross(b, c));
    below_ = lengths_ + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
  }
  double value() const { return 2 * std::atan2(above_, below_); }
  // True if the origin lies in the triangle's plane, exactly.
  bool is_flat() const { return above_ == 0; }
  // True if the origin lies on the triangle, to `tolerance` of its size: its angle is then half of
  // all directions, with a sign that rounding chose.
  bool holds_origin(double tolerance) const {
    return below_ < 0 && std::abs(above_) <= tolerance * lengths_;
  }

 private:
  double lengths_, above_, below_;
};

// Returns the solid angle of a small piece of surface at `place`, whose normal times its area is
// `area`; `squared` is the squared distance to take.
VPM_HD inline double dipole_angle(Vec3 area, Vec3 place, double squared) {
  return dot(area, place) / (squared * std::sqrt(squared));
}

}  // namespace vpm
