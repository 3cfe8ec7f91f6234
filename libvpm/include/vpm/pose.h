// Vectors, spheres and rigid motions. Lengths are metres; a pose maps tool (or camera) to world
// coordinates: x_world = rotation * x + translation.
#pragma once

#include <vpm/error.h>
#include <vpm/export.h>

#include <array>
#include <string>

namespace vpm {

struct Vec3 {
  double x = 0, y = 0, z = 0;
  friend constexpr bool operator==(const Vec3&, const Vec3&) = default;
};

// Vector as files and clouds store it.
struct Vec3f {
  float x = 0, y = 0, z = 0;
  friend constexpr bool operator==(const Vec3f&, const Vec3f&) = default;
};

struct Sphere {
  Vec3 center;
  double radius = 0;
  friend constexpr bool operator==(const Sphere&, const Sphere&) = default;
};

struct Quaternion {
  double x = 0, y = 0, z = 0, w = 1;
};

// Rotation matrix by rows; orthonormal with determinant +1 if made by the functions below.
struct Rotation {
  Vec3 row0{1, 0, 0}, row1{0, 1, 0}, row2{0, 0, 1};
};

struct Pose {
  Rotation rotation;
  Vec3 translation;  // m
};

// Returns the rotation of a quaternion or of a row-major 3x3 matrix, normalised. Stores in
// `deviation`, unless null, how far the input was from a rotation. Throws Error(refused) if the
// input is not finite, zero, mirrored, or off by more than 0.02.
VPM_API Rotation rotation_from_quaternion(const Quaternion& q, double* deviation = nullptr);
VPM_API Rotation rotation_from_matrix(const std::array<double, 9>& m, double* deviation = nullptr);

// Returns the quaternion with w >= 0.
VPM_API Quaternion quaternion_from_rotation(const Rotation& r);

// Parses "tx,ty,tz,qx,qy,qz,qw", metres and a unit quaternion. Throws Error(invalid_argument) if
// the text is not seven numbers, Error(refused) if the numbers are no pose. `deviation` as in
// rotation_from_quaternion.
VPM_API Pose pose_from_text(const std::string& text, double* deviation = nullptr);

}  // namespace vpm
