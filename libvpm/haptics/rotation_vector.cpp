#include "libvpm/haptics/rotation_vector.h"

#include <cmath>

namespace vpm {

Vec3 rotation_vector(const Rotation& r) {
  // Q.w >= 0, so half the angle is at most pi / 2.
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
