// Three-vectors. Vec3 (double) is for computing; Vec3f (float) is for storage in files and clouds.
#pragma once

#include <vpm/pose.h>

#include <cmath>

#include "libvpm/core/division.h"
#include "libvpm/core/host_device.h"

namespace vpm {

VPM_HD constexpr Vec3 operator+(Vec3 a, Vec3 b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
VPM_HD constexpr Vec3 operator-(Vec3 a, Vec3 b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
VPM_HD constexpr Vec3 operator-(Vec3 a) {
  return {-a.x, -a.y, -a.z};
}
VPM_HD constexpr Vec3 operator*(double s, Vec3 a) {
  return {s * a.x, s * a.y, s * a.z};
}
VPM_HD constexpr Vec3 operator*(Vec3 a, double s) {
  return s * a;
}
VPM_HD constexpr Vec3 operator/(Vec3 a, double s) {
  return {a.x / s, a.y / s, a.z / s};
}
VPM_HD constexpr Vec3& operator+=(Vec3& a, Vec3 b) {
  return a = a + b;
}
VPM_HD constexpr Vec3& operator-=(Vec3& a, Vec3 b) {
  return a = a - b;
}

VPM_HD constexpr double dot(Vec3 a, Vec3 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
VPM_HD constexpr Vec3 cross(Vec3 a, Vec3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
VPM_HD constexpr double squared_norm(Vec3 a) {
  return dot(a, a);
}
VPM_HD inline double norm(Vec3 a) {
  return square_root(squared_norm(a));
}

// Returns a / |a|, or zero if a is zero or not finite.
VPM_HD inline Vec3 normalized_or_zero(Vec3 a) {
  const double length = norm(a);
  const bool has_direction = length > 0 && length < HUGE_VAL;
  const double by = has_direction ? length : 1;
  const Vec3 unit{quotient(a.x, by), quotient(a.y, by), quotient(a.z, by)};
  return has_direction ? unit : Vec3{};
}

VPM_HD constexpr Vec3 widen(Vec3f a) {
  return {a.x, a.y, a.z};
}
VPM_HD constexpr Vec3f narrow(Vec3 a) {
  return {static_cast<float>(a.x), static_cast<float>(a.y), static_cast<float>(a.z)};
}

inline bool is_finite(Vec3 a) {
  return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}
inline bool is_finite(Vec3f a) {
  return is_finite(widen(a));
}

}  // namespace vpm
