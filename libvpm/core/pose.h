// Arithmetic of rigid motions (vpm/pose.h), for host and device.
#pragma once

#include "libvpm/core/vec3.h"

namespace vpm {

// Returns the vector turned by the rotation.
[[gnu::always_inline]] VPM_HD constexpr Vec3 operator*(const Rotation& r, Vec3 v) {
  return {dot(r.row0, v), dot(r.row1, v), dot(r.row2, v)};
}
// Returns the transpose, which is the inverse of a rotation.
VPM_HD constexpr Rotation transpose(const Rotation& r) {
  return {{r.row0.x, r.row1.x, r.row2.x},
          {r.row0.y, r.row1.y, r.row2.y},
          {r.row0.z, r.row1.z, r.row2.z}};
}
// Returns the rotation that turns by b, then by a.
VPM_HD constexpr Rotation operator*(const Rotation& a, const Rotation& b) {
  const Rotation columns = transpose(b);
  return transpose(Rotation{a * columns.row0, a * columns.row1, a * columns.row2});
}

// Returns the place that the pose maps v to.
[[gnu::always_inline]] VPM_HD constexpr Vec3 operator*(const Pose& p, Vec3 v) {
  return p.rotation * v + p.translation;
}
// Returns the pose that maps by b, then by a.
VPM_HD constexpr Pose operator*(const Pose& a, const Pose& b) {
  return {a.rotation * b.rotation, a * b.translation};
}
VPM_HD constexpr Pose inverse(const Pose& p) {
  const Rotation back = transpose(p.rotation);
  return {back, -(back * p.translation)};
}

// Returns inverse(frame) * pose. Subtracts the translations first, so that a far world origin costs
// no digits.
VPM_HD constexpr Pose relative_to(const Pose& frame, const Pose& pose) {
  const Rotation back = transpose(frame.rotation);
  return {back * pose.rotation, back * (pose.translation - frame.translation)};
}

// Returns the determinant.
VPM_HD constexpr double determinant(const Rotation& m) {
  return dot(m.row0, cross(m.row1, m.row2));
}

// True if the rows are orthonormal within the tolerance and right-handed. False if any entry is not
// finite.
VPM_HD inline bool is_rotation(const Rotation& r, double tolerance) {
  const Rotation gram = r * transpose(r);
  const double off = norm(gram.row0 - Vec3{1, 0, 0}) + norm(gram.row1 - Vec3{0, 1, 0}) +
                     norm(gram.row2 - Vec3{0, 0, 1});
  return off <= tolerance && determinant(r) > 0;
}

// Largest deviation from a unit quaternion or an orthonormal matrix that is taken for rounding and
// normalised away; recorded camera poses reach 4e-4. Input that deviates more is refused.
inline constexpr double kRotationTolerance = 0.02;
// Largest deviation that decimal rounding explains, so that no note is printed.
inline constexpr double kRotationRounding = 1e-5;

// Largest deviation from an orthonormal matrix that rotations have which were computed in double.
inline constexpr double kRotationExact = 1e-13;

// Returns the nearest rotation to m by Newton's iteration for the polar decomposition, m <- (m +
// m^-T) / 2. It converges quadratically from deviations up to kRotationTolerance.
VPM_HD inline Rotation nearest_rotation(Rotation m) {
  constexpr int kIterations = 8;
  for (int k = 0; k < kIterations; ++k) {
    const double d = determinant(m);
    const Rotation inverse_transpose{cross(m.row1, m.row2) / d, cross(m.row2, m.row0) / d,
                                     cross(m.row0, m.row1) / d};
    m = {0.5 * (m.row0 + inverse_transpose.row0), 0.5 * (m.row1 + inverse_transpose.row1),
         0.5 * (m.row2 + inverse_transpose.row2)};
  }
  return m;
}

// Returns the nearest rotation to one that is off by rounding (at most kRotationTolerance); returns
// it unchanged if it is exact to kRotationExact.
VPM_HD inline Rotation exact_rotation(const Rotation& rounded) {
  return is_rotation(rounded, kRotationExact) ? rounded : nearest_rotation(rounded);
}

VPM_HD inline double length_of(const Quaternion& q) {
  return square_root(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
}
// Returns the rotation of a quaternion of this length.
VPM_HD inline Rotation rotation_of(const Quaternion& q, double length) {
  const double x = q.x / length, y = q.y / length, z = q.z / length, w = q.w / length;
  return {{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
          {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
          {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
}

// Returns the largest magnitude of an entry of m m^T - 1, of a matrix whose entries are finite.
VPM_HD inline double off_rotation(const Rotation& m) {
  const Rotation gram = m * transpose(m);
  const double entries[] = {gram.row0.x - 1, gram.row1.y - 1, gram.row2.z - 1,
                            gram.row0.y,     gram.row0.z,     gram.row1.z};
  double most = 0;
  for (const double entry : entries) most = std::fmax(most, std::abs(entry));
  return most;
}

// True for the length of a quaternion that is taken for a unit quaternion. False if it is not
// finite.
VPM_HD inline bool is_unit(double length) {
  return std::abs(length - 1) <= kRotationTolerance;
}
// True for a matrix, of finite entries, that is taken for a rotation.
VPM_HD inline bool is_near_rotation(const Rotation& m) {
  return determinant(m) > 0 && off_rotation(m) <= kRotationTolerance;
}

// Returns the shortest rotation as a vector, axis times angle in [0, pi]. This and the next two use
// the C library's functions, so their results may differ in the last bits between machines.
Vec3 rotation_vector(const Rotation& r);
// Returns the rotation about `v` by its length, radians.
Rotation rotation_from_vector(Vec3 v);

// Returns the rotation at `part`, 0 to 1, of the shortest rotation from `from` to `to`.
Rotation interpolate(const Rotation& from, const Rotation& to, double part);

}  // namespace vpm
