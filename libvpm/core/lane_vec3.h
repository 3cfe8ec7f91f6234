// Three-vectors by fours (core/lanes.h): operations in the order of core/vec3.h and core/pose.h.
// Not for device code.
#pragma once

#include "libvpm/core/lanes.h"
#include "libvpm/core/pose.h"

namespace vpm {

inline constexpr int kVec3Lanes = 4;
using LaneMask = std::int64_t __attribute__((vector_size(32)));  // -1 where it holds, else 0

[[gnu::always_inline]] inline bool any(const LaneMask& mask) {
  return (mask[0] | mask[1] | mask[2] | mask[3]) != 0;
}
[[gnu::always_inline]] inline Doubles square_root(const Doubles& a) {
  return Doubles{std::sqrt(a[0]), std::sqrt(a[1]), std::sqrt(a[2]), std::sqrt(a[3])};
}
[[gnu::always_inline]] inline Doubles absolute(const Doubles& a) {
  return a < 0 ? -a : a;
}
[[gnu::always_inline]] inline HalfInts truncated(const Doubles& a) {
  return __builtin_convertvector(a, HalfInts);
}
[[gnu::always_inline]] inline Doubles widen(const HalfInts& a) {
  return __builtin_convertvector(a, Doubles);
}
[[gnu::always_inline]] inline Doubles widen(const HalfFloats& a) {
  return __builtin_convertvector(a, Doubles);
}
// A mask of lanes of integers as one of lanes of doubles.
[[gnu::always_inline]] inline LaneMask widen_mask(const HalfInts& mask) {
  return __builtin_convertvector(mask, LaneMask);
}

// A three-vector in each lane; operations in the order of core/vec3.h and core/pose.h.
struct LaneVec3 {
  Doubles x, y, z;

  [[gnu::always_inline]] Vec3 of(int lane) const { return {x[lane], y[lane], z[lane]}; }
};
[[gnu::always_inline]] inline LaneVec3 lanes(const Vec3& a, const Vec3& b, const Vec3& c,
                                             const Vec3& d) {
  return {Doubles{a.x, b.x, c.x, d.x}, Doubles{a.y, b.y, c.y, d.y}, Doubles{a.z, b.z, c.z, d.z}};
}
[[gnu::always_inline]] inline LaneVec3 lanes(const Vec3f& a, const Vec3f& b, const Vec3f& c,
                                             const Vec3f& d) {
  return {widen(HalfFloats{a.x, b.x, c.x, d.x}), widen(HalfFloats{a.y, b.y, c.y, d.y}),
          widen(HalfFloats{a.z, b.z, c.z, d.z})};
}
[[gnu::always_inline]] inline LaneVec3 operator+(const LaneVec3& a, const LaneVec3& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
[[gnu::always_inline]] inline LaneVec3 operator-(const LaneVec3& a, const LaneVec3& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
[[gnu::always_inline]] inline LaneVec3 operator*(const Doubles& s, const LaneVec3& a) {
  return {s * a.x, s * a.y, s * a.z};
}
[[gnu::always_inline]] inline Doubles dot(const LaneVec3& a, const LaneVec3& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
[[gnu::always_inline]] inline Doubles dot(Vec3 a, const LaneVec3& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
[[gnu::always_inline]] inline Doubles squared_norm(const LaneVec3& a) {
  return dot(a, a);
}
[[gnu::always_inline]] inline LaneVec3 operator*(const Pose& p, const LaneVec3& a) {
  return {dot(p.rotation.row0, a) + p.translation.x, dot(p.rotation.row1, a) + p.translation.y,
          dot(p.rotation.row2, a) + p.translation.z};
}
[[gnu::always_inline]] inline LaneVec3 choose(const LaneMask& mask, const LaneVec3& a,
                                              const LaneVec3& b) {
  return {mask ? a.x : b.x, mask ? a.y : b.y, mask ? a.z : b.z};
}
[[gnu::always_inline]] inline LaneVec3 normalized_or_zero(const LaneVec3& a) {
  const Doubles length = square_root(squared_norm(a));
  const LaneMask has_direction = (length > 0) & (length < HUGE_VAL);
  return choose(has_direction, LaneVec3{a.x / length, a.y / length, a.z / length}, LaneVec3{});
}

}  // namespace vpm
