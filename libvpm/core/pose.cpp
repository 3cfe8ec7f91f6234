#include "libvpm/core/pose.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "libvpm/core/error.h"
#include "libvpm/core/number_list.h"

namespace vpm {
namespace {

// Refuses a rotation times a scale, with the scale. Does nothing for other matrices.
void refuse_scale(const Rotation& m) {
  const Rotation columns = transpose(m);
  const Rotation gram = columns * m;
  const double x = norm(columns.row0), y = norm(columns.row1), z = norm(columns.row2);
  if (std::abs(gram.row0.y) > kRotationTolerance * x * y ||
      std::abs(gram.row0.z) > kRotationTolerance * x * z ||
      std::abs(gram.row1.z) > kRotationTolerance * y * z)
    return;
  char scale[96];
  const bool is_uniform = std::max({x, y, z}) <= (1 + kRotationTolerance) * std::min({x, y, z});
  if (is_uniform)
    std::snprintf(scale, sizeof scale, "by %.4g", x);
  else
    std::snprintf(scale, sizeof scale, "its columns by %.4g, %.4g and %.4g", x, y, z);
  refuse("the 3x3 block is not a rotation alone but scales " + std::string(scale), "pose",
         "divide its columns by that, and scale the mesh instead if that is meant");
}

// Refuses a matrix that is off a rotation by `off`, and says why.
[[noreturn]] void refuse_matrix(const Rotation& m, double off) {
  if (!(determinant(m) > 0))
    refuse("the rotation matrix mirrors (its determinant is not positive)", "pose",
           "give a proper rotation");
  refuse_scale(m);
  refuse("the 3x3 block is " + std::to_string(off) + " away from a rotation matrix", "pose");
}

}  // namespace

Rotation rotation_from_quaternion(const Quaternion& q, double* deviation) {
  const double length = length_of(q);
  if (!std::isfinite(length)) refuse("the quaternion is not finite", "pose");
  if (!is_unit(length)) {
    refuse("the quaternion has length " + std::to_string(length) + " instead of 1", "pose",
           "give x,y,z,w of a unit quaternion");
  }
  if (deviation != nullptr) *deviation = std::abs(length - 1);
  return rotation_of(q, length);
}

Rotation rotation_from_matrix(const std::array<double, 9>& m, double* deviation) {
  for (const double value : m) {
    if (!std::isfinite(value)) refuse("the rotation matrix is not finite", "pose");
  }
  const Rotation given{{m[0], m[1], m[2]}, {m[3], m[4], m[5]}, {m[6], m[7], m[8]}};
  const double off = off_rotation(given);
  if (!is_near_rotation(given)) refuse_matrix(given, off);
  if (deviation != nullptr) *deviation = off;
  return nearest_rotation(given);
}

Quaternion quaternion_from_rotation(const Rotation& r) {
  const double xx = r.row0.x, yy = r.row1.y, zz = r.row2.z;
  const std::array<double, 4> squares{1 + xx - yy - zz, 1 - xx + yy - zz, 1 - xx - yy + zz,
                                      1 + xx + yy + zz};
  const auto largest = std::max_element(squares.begin(), squares.end()) - squares.begin();
  const double root = std::sqrt(squares[static_cast<std::size_t>(largest)]), half = 0.5 / root;
  const double a = (r.row2.y - r.row1.z) * half, b = (r.row0.z - r.row2.x) * half,
               c = (r.row1.x - r.row0.y) * half;
  const double xy = (r.row0.y + r.row1.x) * half, xz = (r.row0.z + r.row2.x) * half,
               yz = (r.row1.z + r.row2.y) * half;
  Quaternion q;
  if (largest == 0) q = {0.5 * root, xy, xz, a};
  if (largest == 1) q = {xy, 0.5 * root, yz, b};
  if (largest == 2) q = {xz, yz, 0.5 * root, c};
  if (largest == 3) q = {a, b, c, 0.5 * root};
  return q.w < 0 ? Quaternion{-q.x, -q.y, -q.z, -q.w} : q;
}

Pose pose_from_text(const std::string& text, double* deviation) {
  std::vector<double> n;
  try {
    n = numbers_from_text(text);
  } catch (const Error& fault) {
    throw Error(fault.kind(), fault.problem(), "pose", fault.hint());
  }
  if (n.size() != 7) {
    throw Error(ErrorKind::invalid_argument,
                "expected 7 numbers tx,ty,tz,qx,qy,qz,qw but found " + std::to_string(n.size()) +
                    " in '" + text + "'",
                "pose");
  }
  const Vec3 translation{n[0], n[1], n[2]};
  if (!is_finite(translation)) refuse("the translation is not finite", "pose");
  return {rotation_from_quaternion({n[3], n[4], n[5], n[6]}, deviation), translation};
}

Vec3 rotation_vector(const Rotation& r) {
  // Half the angle is at most pi / 2, since q.w >= 0.
  const Quaternion q = quaternion_from_rotation(r);
  const Vec3 axis{q.x, q.y, q.z};
  const double sine = norm(axis);
  if (sine == 0) return {};
  return (2 * std::atan2(sine, q.w) / sine) * axis;
}

Rotation rotation_from_vector(Vec3 v) {
  const double angle = norm(v);
  if (angle == 0) return {};
  const Vec3 axis = (std::sin(angle / 2) / angle) * v;
  return rotation_from_quaternion({axis.x, axis.y, axis.z, std::cos(angle / 2)});
}

Rotation interpolate(const Rotation& from, const Rotation& to, double part) {
  return rotation_from_vector(part * rotation_vector(to * transpose(from))) * from;
}

}  // namespace vpm
