// The arithmetic of normals: from a window's sums to a unit vector. IEEE operations and square
// roots only, in a written order, so that every compiler and device gives the same bits. Inlined
// without exception, since a call inside a loop over pixels keeps compilers from making vector
// code.
//
// Real: float or double, or a vector of such (core/lanes.h).
#pragma once

#include <type_traits>

#include "libvpm/cloud/camera.h"
#include "libvpm/cloud/normal_limits.h"
#include "libvpm/core/division.h"

namespace vpm {

// Whole windows are summed in opposite pairs, from the middle outwards: first down each column,
// then across the columns. `distance`: of the pair from the middle.
//
// Of the inverse depth s: sums of s and v s in a column; of s, u s and v s in a window.
template <class Real>
[[gnu::always_inline]] VPM_HD inline void add_rows(std::type_identity_t<Real> below,
                                                   std::type_identity_t<Real> above, float distance,
                                                   Real& s, Real& vs) {
  s += below + above;
  vs += distance * (below - above);
}
template <class Real>
[[gnu::always_inline]] VPM_HD inline void add_columns(std::type_identity_t<Real> right,
                                                      std::type_identity_t<Real> left,
                                                      std::type_identity_t<Real> right_v,
                                                      std::type_identity_t<Real> left_v,
                                                      float distance, Real& s, Real& us, Real& vs) {
  s += right + left;
  us += distance * (right - left);
  vs += right_v + left_v;
}

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
  const Real scale = -reciprocal(square_root(x * x + y * y + z * z));
  return {static_cast<float>(x * scale), static_cast<float>(y * scale),
          static_cast<float>(z * scale)};
}

// What turns the sums of a whole window into the plane's slopes and its middle.
struct WholeWindow {
  float per_slope = 0, per_count = 0;

  WholeWindow() = default;
  explicit constexpr WholeWindow(int window) {
    const float count = static_cast<float>(window * window);
    // Sum of du^2 over a whole window: window^2 (window^2 - 1) / 12.
    per_slope = 12 / (count * (count - 1));
    per_count = 1 / count;
  }
  [[gnu::always_inline]] VPM_HD inline PlaneSlopes<float> plane(float s, float us, float vs,
                                                                float centre) const {
    const float unit = reciprocal(centre);
    return {us * per_slope * unit, vs * per_slope * unit, s * per_count * unit};
  }
};

// Whether a gated window keeps a pixel. `value` is its inverse depth, `expected` what the centre's
// surface has there, relative to the centre's and minus 1, as is `difference`.
template <class Real>
[[gnu::always_inline]] VPM_HD inline auto is_in_gate(Real value, Real difference, Real expected,
                                                     std::type_identity_t<Real> allowed) {
  const Real off = difference - expected;
  return (off <= allowed) & (off >= -allowed) & (value > 0.0F);
}

// Whether something that was measured is no part of the centre's surface, whatever its plane.
template <class Real>
[[gnu::always_inline]] VPM_HD inline auto is_beyond_gate(Real value, Real difference, Real gate) {
  return ((difference > gate) | (difference < -gate)) & (value > 0.0F);
}

// Sums over the pixels that are kept of 1, du, dv, their products, the difference and its products.
template <class Real>
struct SumsOfPlane {
  Real n{}, u{}, v{}, uu{}, uv{}, vv{}, e{}, ue{}, ve{};
};
using PlaneSums = SumsOfPlane<double>;

// The plane before it is rounded to floats; 0 where it is not found.
template <class Real>
struct FittedPlane {
  using Mask = decltype(Real() < Real());
  Mask found;
  Real a, b, c;
};

// Devices have none of the vectors.
template <class Real>
[[gnu::always_inline]] VPM_HD inline Real ratio(const Real& a, const Real& b) {
  if constexpr (std::is_same_v<Real, double>)
    return quotient(a, b);
  else
    return a / b;
}

template <class Real>
[[gnu::always_inline]] VPM_HD inline FittedPlane<Real> fit_plane(const SumsOfPlane<Real>& s) {
  // Moments about the pixels' mean, times n: integers, exact in double.
  const Real uu = s.n * s.uu - s.u * s.u, uv = s.n * s.uv - s.u * s.v, vv = s.n * s.vv - s.v * s.v;
  const Real determinant = uu * vv - uv * uv;
  const auto found = static_cast<typename FittedPlane<Real>::Mask>(
      (s.n >= double{kMinSupport}) & (determinant >= kMinSpread * s.n * s.n * (uu + vv)));
  const Real ue = s.n * s.ue - s.u * s.e, ve = s.n * s.ve - s.v * s.e;
  const Real both = ratio(Real{} + 1.0, determinant * s.n);  // one division instead of two
  const Real unit = both * s.n, per_n = both * determinant;
  const Real a = (ue * vv - ve * uv) * unit;
  const Real b = (ve * uu - ue * uv) * unit;
  const Real c = (s.e - a * s.u - b * s.v) * per_n;
  return {found, found ? a : Real{}, found ? b : Real{}, found ? c : Real{}};
}

// Inverse depth relative to the centre's, minus 1: c + a du + b dv.
struct WindowPlane {
  bool found = false;  // false: too few pixels remain, or they lie on a line
  float a = 0, b = 0, c = 0;
};

[[gnu::always_inline]] VPM_HD inline WindowPlane plane_of_sums(const PlaneSums& s) {
  const FittedPlane<double> plane = fit_plane(s);
  return {plane.found, static_cast<float>(plane.a), static_cast<float>(plane.b),
          static_cast<float>(plane.c)};
}

// Zero where no plane was found. An extrapolated plane may pass behind the sensor's centre: it says
// nothing either.
[[gnu::always_inline]] VPM_HD inline Vec3f normal_of_window(const WindowPlane& plane, float fx,
                                                            float fy, float du_axis,
                                                            float dv_axis) {
  const float height = 1 + plane.c;
  const bool found = plane.found & (height > 0);
  const Vec3f n = normal_of_plane<float>({plane.a, plane.b, height}, fx, fy, du_axis, dv_axis);
  return {found ? n.x : 0, found ? n.y : 0, found ? n.z : 0};
}

// Upper triangle of a symmetric 3x3 matrix.
template <class Real>
struct Symmetric3 {
  Real xx, xy, xz, yy, yz, zz;
};

// Newton steps from below to the smallest root of the characteristic polynomial. They double the
// digits once past the first few; with the two small eigenvalues as 1 to 2, six reach a float's,
// and these are enough for all that are not nearly the same.
inline constexpr int kEigenSteps = 8;

// For a matrix of trace 1 in floats: values of the polynomial that are rounding noise; squared
// length of the eigenvector before it is normalised, below which its direction may be off by more
// than 0.01, since the two small eigenvalues nearly coincide (points on a line).
inline constexpr float kRootNoise = 0x1p-60F, kEigenNoise = 1e-10F;

// x^3 - x^2 + minors x - determinant, whose smallest root is sought from below. It is concave and
// increasing up to there, so no step of Newton's passes the root; once one would, all are done.
struct Characteristic {
  float minors, determinant;

  [[gnu::always_inline]] VPM_HD inline float at(float x) const {
    return ((x - 1) * x + minors) * x - determinant;
  }
  // `value`: at(x).
  [[gnu::always_inline]] VPM_HD inline float next(float x, float value) const {
    const float slope = (3 * x - 2) * x + minors;
    const float step = quotient(value, slope > kRootNoise ? slope : 1.0F);
    return x - (value < -kRootNoise ? step : 0.0F);
  }
};

// A positive semidefinite matrix over its trace. What is known of it in floats then gives the
// direction of a plane's normal to some 1e-7, over what its second eigenvalue is of the trace.
[[gnu::always_inline]] VPM_HD inline Symmetric3<float> over_trace(const Symmetric3<double>& m) {
  const double trace = m.xx + m.yy + m.zz;
  const double unit = trace > 0 ? quotient(1, trace) : 0;
  const auto scaled = [&](double of) { return static_cast<float>(of * unit); };
  return {scaled(m.xx), scaled(m.xy), scaled(m.xz), scaled(m.yy), scaled(m.yz), scaled(m.zz)};
}
[[gnu::always_inline]] VPM_HD inline Characteristic characteristic_of(const Symmetric3<float>& m) {
  return {(m.xx * m.yy - m.xy * m.xy) + (m.xx * m.zz - m.xz * m.xz) + (m.yy * m.zz - m.yz * m.yz),
          m.xx * (m.yy * m.zz - m.yz * m.yz) - m.xy * (m.xy * m.zz - m.yz * m.xz) +
              m.xz * (m.xy * m.yz - m.yy * m.xz)};
}
[[gnu::always_inline]] VPM_HD inline float smallest_root(const Characteristic& polynomial) {
  float root = 0;
  for (int step = 0; step < kEigenSteps; ++step) {
    const float next = polynomial.next(root, polynomial.at(root));
    if (next == root) break;
    root = next;
  }
  return root;
}

// Eigenvector of an eigenvalue, of any length; zero where there is no single one.
[[gnu::always_inline]] VPM_HD inline Vec3f eigenvector(const Symmetric3<float>& m, float root) {
  const auto cross = [](const Vec3f& a, const Vec3f& b) __attribute__((always_inline)) {
    return Vec3f{a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
  };
  const auto squared_norm = [](const Vec3f& a) __attribute__((always_inline)) {
    return a.x * a.x + a.y * a.y + a.z * a.z;
  };
  const float dx = m.xx - root, dy = m.yy - root, dz = m.zz - root;
  const Vec3f ab = cross({dx, m.xy, m.xz}, {m.xy, dy, m.yz});
  const Vec3f ac = cross({dx, m.xy, m.xz}, {m.xz, m.yz, dz});
  const Vec3f bc = cross({m.xy, dy, m.yz}, {m.xz, m.yz, dz});
  const float ab2 = squared_norm(ab), ac2 = squared_norm(ac), bc2 = squared_norm(bc);
  const bool use_ac = ac2 > ab2;
  Vec3f best{use_ac ? ac.x : ab.x, use_ac ? ac.y : ab.y, use_ac ? ac.z : ab.z};
  float best2 = use_ac ? ac2 : ab2;
  const bool use_bc = bc2 > best2;
  best = {use_bc ? bc.x : best.x, use_bc ? bc.y : best.y, use_bc ? bc.z : best.z};
  best2 = use_bc ? bc2 : best2;
  const float keep = best2 > kEigenNoise ? 1.0F : 0.0F;
  return {best.x * keep, best.y * keep, best.z * keep};
}

// Moments of a window's points in the affine frame of its centre, p = z (du, dv, 1): there they
// are plain weighted sums of z and z^2.
template <class Real>
struct MomentsOf {
  Real n{}, x{}, y{}, z{}, xx{}, xy{}, xz{}, yy{}, yz{}, zz{};
};
using Moments = MomentsOf<double>;

// Of gated windows: sums of 1, z, v z, z^2, v z^2 and v^2 z^2 over what is kept of a column, from
// its least dv on; then over columns, from the least du on.
template <class Real>
struct KeptDepths {
  Real n{}, z{}, vz{}, z2{}, vz2{}, vvz2{};
};
template <class Real>
[[gnu::always_inline]] VPM_HD inline void add_depth(KeptDepths<Real>& column, const Real& depth,
                                                    double dv) {
  const Real square = depth * depth;
  column.z += depth, column.vz += dv * depth;
  column.z2 += square, column.vz2 += dv * square, column.vvz2 += dv * dv * square;
}
template <class Real>
[[gnu::always_inline]] VPM_HD inline void add_kept(MomentsOf<Real>& m,
                                                   const KeptDepths<Real>& column, double du) {
  m.n += column.n, m.x += du * column.z, m.y += column.vz, m.z += column.z;
  m.xx += du * du * column.z2, m.xy += du * column.vz2, m.xz += du * column.z2;
  m.yy += column.vvz2, m.yz += column.vz2, m.zz += column.z2;
}

// Of whole windows, in opposite pairs as above. Sums of z and v z, of z^2, v z^2 and v^2 z^2 in a
// column; the moments in a window.
template <class Real>
[[gnu::always_inline]] VPM_HD inline void add_depth_rows(Real below, Real above, double distance,
                                                         Real& z, Real& vz) {
  z += below + above;
  vz += distance * (below - above);
}
template <class Real>
[[gnu::always_inline]] VPM_HD inline void add_square_rows(Real below, Real above, double distance,
                                                          Real& z2, Real& vz2, Real& vvz2) {
  const Real b = below * below, a = above * above;
  z2 += b + a;
  vz2 += distance * (b - a);
  vvz2 += distance * distance * (b + a);
}
template <class Real>
[[gnu::always_inline]] VPM_HD inline void add_depth_columns(Real right, Real left, Real right_v,
                                                            Real left_v, double distance, Real& x,
                                                            Real& y, Real& z) {
  x += distance * (right - left);
  z += right + left;
  y += right_v + left_v;
}
template <class Real>
[[gnu::always_inline]] VPM_HD inline void add_square_columns(Real right, Real left, double distance,
                                                             Real& xx, Real& xz, Real& zz) {
  xx += distance * distance * (right + left);
  xz += distance * (right - left);
  zz += right + left;
}
// `right` and `left`: of v z^2; the others of v^2 z^2.
template <class Real>
[[gnu::always_inline]] VPM_HD inline void add_tilted_columns(Real right, Real left, Real right_vv,
                                                             Real left_vv, double distance,
                                                             Real& xy, Real& yz, Real& yy) {
  xy += distance * (right - left);
  yz += right + left;
  yy += right_vv + left_vv;
}

// Covariance in the camera's frame, over its trace, of what is seen about the pixel whose ray is
// (rx, ry, 1). `per_n`: 1 / m.n.
[[gnu::always_inline]] VPM_HD inline Symmetric3<float> covariance_of_moments(
    const Moments& m, double per_n, double per_fx, double per_fy, double rx, double ry) {
  // Covariance (times n) in the centre's frame ...
  const double xx = m.xx - m.x * m.x * per_n, xy = m.xy - m.x * m.y * per_n,
               xz = m.xz - m.x * m.z * per_n, yy = m.yy - m.y * m.y * per_n,
               yz = m.yz - m.y * m.z * per_n, zz = m.zz - m.z * m.z * per_n;
  // ... and in the camera's: (x/fx + rx z, y/fy + ry z, z).
  const double ax = per_fx * xz, ay = per_fy * yz;
  return over_trace({per_fx * per_fx * xx + 2 * rx * ax + rx * rx * zz,
                     per_fx * per_fy * xy + ry * ax + rx * ay + rx * ry * zz, ax + rx * zz,
                     per_fy * per_fy * yy + 2 * ry * ay + ry * ry * zz, ay + ry * zz, zz});
}

// The unit normal towards the sensor; `root`: the smallest of the covariance's characteristic.
[[gnu::always_inline]] VPM_HD inline Vec3f normal_of_covariance(const Symmetric3<float>& covariance,
                                                                float root, float rx, float ry) {
  const Vec3f n = eigenvector(covariance, root);
  const float away = n.x * rx + n.y * ry + n.z;
  const float length = square_root(n.x * n.x + n.y * n.y + n.z * n.z);
  const float scale = (away > 0 ? -1.0F : 1.0F) * reciprocal(length > 0 ? length : 1.0F);
  return {scale * n.x, scale * n.y, scale * n.z};
}
[[gnu::always_inline]] VPM_HD inline Vec3f normal_of_moments(const Moments& m, double per_n,
                                                             double per_fx, double per_fy,
                                                             double rx, double ry) {
  const Symmetric3<float> covariance = covariance_of_moments(m, per_n, per_fx, per_fy, rx, ry);
  return normal_of_covariance(covariance, smallest_root(characteristic_of(covariance)),
                              static_cast<float>(rx), static_cast<float>(ry));
}

}  // namespace vpm
