// The arithmetic of normals: from a window's sums to a unit vector. IEEE operations and square
// roots only, in a written order, so that every compiler and device gives the same bits. Inlined
// without exception, since a call inside a loop over pixels keeps compilers from making vector
// code.
#pragma once

#include "libvpm/cloud/camera.h"

namespace vpm {

// The normal towards the sensor of the plane whose inverse depth is a du + b dv + c at the offset
// (du, dv) from pixel (u, v): with u = fx X/Z + cx the plane is
// a fx X + b fy Y + (a (cx - u) + b (cy - v) + c) Z = 1.
template <class Real>
struct PlaneSlopes {
  Real a, b, c;
};

template <class Real>
[[gnu::always_inline]] VPM_HD inline Vec3f normal_of_plane(const PlaneSlopes<Real>& plane, Real fx,
                                                           Real fy, Real du_axis, Real dv_axis) {
  const Real x = plane.a * fx, y = plane.b * fy;
  const Real z = plane.a * du_axis + plane.b * dv_axis + plane.c;
  const Real scale = Real(-1) / std::sqrt(x * x + y * y + z * z);
  return {static_cast<float>(x * scale), static_cast<float>(y * scale),
          static_cast<float>(z * scale)};
}

// Upper triangle of a symmetric 3x3 matrix.
struct Symmetric3 {
  double xx, xy, xz, yy, yz, zz;
};

// Newton steps from below to the smallest root of the characteristic polynomial. They double the
// digits once past the first few; with the two small eigenvalues as 1 to 2, eight reach double
// precision.
inline constexpr int kEigenSteps = 8;

// Squared length of the eigenvector before it is normalised, for a matrix of trace 1, below which
// its direction is rounding noise: the two small eigenvalues coincide (points on a line).
inline constexpr double kEigenNoise = 1e-24;

// Newton's iteration for the smallest root of x^3 - x^2 + minors x - determinant, from `root` below
// it. The polynomial is concave and increasing up to there, so no step passes the root. Written
// without a loop so that compilers can put several pixels into one vector.
template <int Steps>
[[gnu::always_inline]] VPM_HD inline double smallest_root(double root, double minors,
                                                          double determinant) {
  if constexpr (Steps == 0) {
    return root;
  } else {
    const double value = ((root - 1) * root + minors) * root - determinant;
    const double slope = (3 * root - 2) * root + minors;
    const double step = value / (slope > 0 ? slope : 1.0);
    return smallest_root<Steps - 1>(root - (value < 0 ? step : 0.0), minors, determinant);
  }
}

// Eigenvector of the smallest eigenvalue of a positive semidefinite matrix, of any length; zero
// where there is no single one.
[[gnu::always_inline]] VPM_HD inline Vec3 smallest_eigenvector(const Symmetric3& m) {
  const double trace = m.xx + m.yy + m.zz;
  const double unit = trace > 0 ? 1 / trace : 0;
  const double xx = m.xx * unit, xy = m.xy * unit, xz = m.xz * unit;
  const double yy = m.yy * unit, yz = m.yz * unit, zz = m.zz * unit;
  const double minors = (xx * yy - xy * xy) + (xx * zz - xz * xz) + (yy * zz - yz * yz);
  const double determinant =
      xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz);
  const double root = smallest_root<kEigenSteps>(0, minors, determinant);
  const double dx = xx - root, dy = yy - root, dz = zz - root;
  const Vec3 ab = cross({dx, xy, xz}, {xy, dy, yz});
  const Vec3 ac = cross({dx, xy, xz}, {xz, yz, dz});
  const Vec3 bc = cross({xy, dy, yz}, {xz, yz, dz});
  const double ab2 = squared_norm(ab), ac2 = squared_norm(ac), bc2 = squared_norm(bc);
  const bool use_ac = ac2 > ab2;
  Vec3 best{use_ac ? ac.x : ab.x, use_ac ? ac.y : ab.y, use_ac ? ac.z : ab.z};
  double best2 = use_ac ? ac2 : ab2;
  const bool use_bc = bc2 > best2;
  best = {use_bc ? bc.x : best.x, use_bc ? bc.y : best.y, use_bc ? bc.z : best.z};
  best2 = use_bc ? bc2 : best2;
  const double keep = best2 > kEigenNoise ? 1.0 : 0.0;
  return {best.x * keep, best.y * keep, best.z * keep};
}

}  // namespace vpm
