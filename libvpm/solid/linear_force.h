// Force of a depth that is linear over a piece of surface.
#pragma once

#include "libvpm/solid/face_planes.h"
#include "libvpm/solid/surface_moments.h"

namespace vpm {

struct ForceAndTorque {
  Vec3 force, torque;  // torque about the origin
};
inline ForceAndTorque operator*(double weight, const ForceAndTorque& f) {
  return {weight * f.force, weight * f.torque};
}

// Returns ∫ -d n dA and ∫ -d x cross n dA over a flat piece with this unit normal.
inline ForceAndTorque force_on_face(const DepthIntegral& of_depth, Vec3 normal) {
  return {-of_depth.volume * normal, -cross(of_depth.moment, normal)};
}

// Returns ∫ -d n dA and ∫ -d x cross n dA over a piece with these moments, where d is linear:
// `depth` at the place x. All in one frame.
inline ForceAndTorque linear_force(const ForceMoments& m, const Depth& depth, Vec3 x) {
  const Vec3 g = depth.gradient;
  const double at_origin = depth.value - dot(g, x);
  const SurfaceMoments& s = m.surface;
  const auto& q = m.by_product;
  const Vec3 force = at_origin * s.area + g.x * s.by_x + g.y * s.by_y + g.z * s.by_z;
  const Vec3 x_n = at_origin * s.by_x + g.x * q[0] + g.y * q[3] + g.z * q[4],
             y_n = at_origin * s.by_y + g.x * q[3] + g.y * q[1] + g.z * q[5],
             z_n = at_origin * s.by_z + g.x * q[4] + g.y * q[5] + g.z * q[2];
  return {-force, -Vec3{y_n.z - z_n.y, z_n.x - x_n.z, x_n.y - y_n.x}};
}

// Returns the same of a triangle.
inline ForceAndTorque linear_force(const std::array<Vec3, 3>& corners, const Depth& depth, Vec3 x) {
  const auto& [a, b, c] = corners;
  const auto at = [&](Vec3 corner) { return depth.value + dot(depth.gradient, corner - x); };
  const double p = at(a), q = at(b), r = at(c), sum = p + q + r;
  const Vec3 area = 0.5 * cross(b - a, c - a);
  const Vec3 moment = (p * a + q * b + r * c + sum * (a + b + c)) / 12;  // ∫ d x dA / |area|
  return {-sum / 3 * area, -cross(moment, area)};
}

}  // namespace vpm
