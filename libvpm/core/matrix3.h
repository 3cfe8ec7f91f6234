// General 3x3 matrices, by rows.
#pragma once

#include "libvpm/core/vec3.h"

namespace vpm {

struct Matrix3 {
  Vec3 row0, row1, row2;
};

constexpr Vec3 operator*(const Matrix3& m, Vec3 v) {
  return {dot(m.row0, v), dot(m.row1, v), dot(m.row2, v)};
}
// Returns the transpose of m times v.
constexpr Vec3 operator*(Vec3 v, const Matrix3& m) {
  return v.x * m.row0 + v.y * m.row1 + v.z * m.row2;
}
constexpr Matrix3& operator+=(Matrix3& a, const Matrix3& b) {
  a.row0 += b.row0, a.row1 += b.row1, a.row2 += b.row2;
  return a;
}
constexpr Matrix3 operator*(double s, const Matrix3& m) {
  return {s * m.row0, s * m.row1, s * m.row2};
}
constexpr Matrix3 outer_product(Vec3 a, Vec3 b) {
  return {a.x * b, a.y * b, a.z * b};
}
constexpr double trace(const Matrix3& m) {
  return m.row0.x + m.row1.y + m.row2.z;
}

}  // namespace vpm
