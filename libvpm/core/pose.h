// Rigid motions. A Pose maps tool coordinates to world coordinates: x_world = rotation * x +
// translation.
#pragma once

#include <array>
#include <string>

#include "libvpm/core/vec3.h"

namespace vpm {

struct Quaternion {
  double x = 0, y = 0, z = 0, w = 1;
};

// Rows of a rotation matrix; orthonormal with determinant +1 when made by the functions below.
struct Rotation {
  Vec3 row0{1, 0, 0}, row1{0, 1, 0}, row2{0, 0, 1};
};

[[gnu::always_inline]] VPM_HD constexpr Vec3 operator*(const Rotation& r, Vec3 v) {
  return {dot(r.row0, v), dot(r.row1, v), dot(r.row2, v)};
}
VPM_HD constexpr Rotation transpose(const Rotation& r) {
  return {{r.row0.x, r.row1.x, r.row2.x},
          {r.row0.y, r.row1.y, r.row2.y},
          {r.row0.z, r.row1.z, r.row2.z}};
}
VPM_HD constexpr Rotation operator*(const Rotation& a, const Rotation& b) {
  const Rotation columns = transpose(b);
  return transpose(Rotation{a * columns.row0, a * columns.row1, a * columns.row2});
}

struct Pose {
  Rotation rotation;
  Vec3 translation;
};

[[gnu::always_inline]] VPM_HD constexpr Vec3 operator*(const Pose& p, Vec3 v) {
  return p.rotation * v + p.translation;
}
VPM_HD constexpr Pose operator*(const Pose& a, const Pose& b) {
  return {a.rotation * b.rotation, a * b.translation};
}
VPM_HD constexpr Pose inverse(const Pose& p) {
  const Rotation back = transpose(p.rotation);
  return {back, -(back * p.translation)};
}

// `pose` seen from `frame`: inverse(frame) * pose, but the translations are subtracted first, so
// that a far world origin costs no digits.
VPM_HD constexpr Pose relative_to(const Pose& frame, const Pose& pose) {
  const Rotation back = transpose(frame.rotation);
  return {back * pose.rotation, back * (pose.translation - frame.translation)};
}

// Whether the rows are orthonormal to this deviation, and not mirrored. False for what is not
// finite.
inline bool is_rotation(const Rotation& r, double tolerance) {
  const Rotation gram = r * transpose(r);
  const double off = norm(gram.row0 - Vec3{1, 0, 0}) + norm(gram.row1 - Vec3{0, 1, 0}) +
                     norm(gram.row2 - Vec3{0, 0, 1});
  return off <= tolerance && dot(r.row0, cross(r.row1, r.row2)) > 0;
}

// Deviation from a unit quaternion or an orthonormal matrix up to which an input is taken for a
// rounded rotation and normalised (recorded camera poses reach 4e-4); beyond it the input is
// refused.
inline constexpr double kRotationTolerance = 0.02;
// Deviation that is mere decimal rounding and not worth a note.
inline constexpr double kRotationRounding = 1e-5;

// Deviation of rotations that were computed in double.
inline constexpr double kRotationExact = 1e-13;

// The rotation of a quaternion or a 3x3 matrix (row-major), normalised. `deviation` (may be null)
// receives how far the input was from a rotation. Throws Error(refused) for non-finite, zero,
// far-off or mirrored input.
Rotation rotation_from_quaternion(const Quaternion& q, double* deviation = nullptr);
Rotation rotation_from_matrix(const std::array<double, 9>& m, double* deviation = nullptr);
// The nearest rotation to one that is rounded (is_rotation, kRotationTolerance); itself where it is
// exact.
Rotation exact_rotation(const Rotation& rounded);
Quaternion quaternion_from_rotation(const Rotation& r);  // w >= 0

// Parses "tx,ty,tz,qx,qy,qz,qw". Throws Error: usage where it is not seven numbers, refused where
// they are no pose.
Pose pose_from_text(const std::string& text, double* deviation = nullptr);

}  // namespace vpm
