// The arithmetic of normals by principal components: as plane_fit.h, from a window's sums to a unit
// vector.
#pragma once

#include "libvpm/cloud/camera.h"
#include "libvpm/cloud/window_span.h"

namespace vpm {

// Upper triangle of a symmetric 3x3 matrix.
template <class Real>
struct Symmetric3 {
  Real xx, xy, xz, yy, yz, zz;
};

// Newton steps to the smallest root of the characteristic polynomial. They double the digits once
// past the first few; with the two small eigenvalues as 1 to 2, four reach a float's, and these are
// enough for all that are not nearly the same.
inline constexpr int kEigenSteps = 8;

// For a matrix of trace 1 in floats: values of the polynomial that are rounding noise; squared
// length of the eigenvector before it is normalised, below which its direction may be off by more
// than 0.01, since the two small eigenvalues nearly coincide (points on a line).
inline constexpr float kRootNoise = 0x1p-60F, kEigenNoise = 1e-10F;

// x^3 - x^2 + minors x - determinant, whose smallest root is sought: the polynomial is concave and
// increasing up to there and a little beyond.
struct Characteristic {
  float minors, determinant;

  // The first step, from the smaller root of the quadratic that is left without the cube, which is
  // no less than the one sought.
  [[gnu::always_inline]] VPM_HD inline float begin() const {
    const float under = minors * minors - 4 * determinant;
    const float sum = minors + square_root(under > kLeastUnderRoot ? under : 0.0F);
    const float above = quotient(2 * determinant, sum > kRootNoise ? sum : 1.0F);
    const float root = determinant > kRootNoise ? above : 0.0F, value = at(root);
    return root - ((value > kRootNoise) | (value < -kRootNoise) ? step(root, value) : 0.0F);
  }
  // From there on no step passes the root; once one would, all are done.
  [[gnu::always_inline]] VPM_HD inline float next(float x) const {
    const float value = at(x);
    return x - (value < -kRootNoise ? step(x, value) : 0.0F);
  }

 private:
  static constexpr float kLeastUnderRoot = 0x1p-100F;  // of which the square root is exact

  [[gnu::always_inline]] VPM_HD inline float at(float x) const {
    return ((x - 1) * x + minors) * x - determinant;
  }
  [[gnu::always_inline]] VPM_HD inline float step(float x, float value) const {
    const float slope = (3 * x - 2) * x + minors;
    return quotient(value, slope > kRootNoise ? slope : 1.0F);
  }
};

// A positive semidefinite matrix over its trace. What is known of it in floats then gives the
// direction of a plane's normal to some 1e-7, over what its second eigenvalue is of the trace.
template <class Real>
[[gnu::always_inline]] VPM_HD inline Symmetric3<float> over_trace(const Symmetric3<Real>& m) {
  const Real trace = m.xx + m.yy + m.zz;
  const Real unit = trace > 0 ? quotient(Real{1}, trace) : Real{};
  const auto scaled = [&](Real of) { return static_cast<float>(of * unit); };
  return {scaled(m.xx), scaled(m.xy), scaled(m.xz), scaled(m.yy), scaled(m.yz), scaled(m.zz)};
}
[[gnu::always_inline]] VPM_HD inline Characteristic characteristic_of(const Symmetric3<float>& m) {
  return {(m.xx * m.yy - m.xy * m.xy) + (m.xx * m.zz - m.xz * m.xz) + (m.yy * m.zz - m.yz * m.yz),
          m.xx * (m.yy * m.zz - m.yz * m.yz) - m.xy * (m.xy * m.zz - m.yz * m.xz) +
              m.xz * (m.xy * m.yz - m.yy * m.xz)};
}
[[gnu::always_inline]] VPM_HD inline float smallest_root(const Characteristic& polynomial) {
  float root = polynomial.begin();
  for (int step = 1; step < kEigenSteps; ++step) {
    const float next = polynomial.next(root);
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
  [[gnu::always_inline]] VPM_HD inline MomentsOf operator+(const MomentsOf& b) const {
    return {n + b.n,   x + b.x,   y + b.y,   z + b.z,   xx + b.xx,
            xy + b.xy, xz + b.xz, yy + b.yy, yz + b.yz, zz + b.zz};
  }
};
using Moments = MomentsOf<double>;

// About their mean, times n. `per_n`: 1 / m.n.
template <class Real>
[[gnu::always_inline]] VPM_HD inline Symmetric3<Real> centred(const MomentsOf<Real>& m,
                                                              Real per_n) {
  const Real x = m.x * per_n, y = m.y * per_n, z = m.z * per_n;
  return {m.xx - m.x * x, m.xy - m.x * y, m.xz - m.x * z,
          m.yy - m.y * y, m.yz - m.y * z, m.zz - m.z * z};
}

// The affine frame's axes in those of the camera, all by the same factor.
template <class Real>
struct PixelScale {
  Real x, y, z;
};
[[gnu::always_inline]] VPM_HD inline PixelScale<double> pixel_scale(const Intrinsics& k) {
  return {1 / k.fx, 1 / k.fy, 1};
}
// So that none of what is made by it leaves the range of floats, where z is relative to the
// centre's: x and y no more than 1.
[[gnu::always_inline]] VPM_HD inline PixelScale<float> pixel_scale_in_floats(const Intrinsics& k) {
  const double least = k.fx < k.fy ? k.fx : k.fy;
  return {static_cast<float>(least / k.fx), static_cast<float>(least / k.fy),
          static_cast<float>(least)};
}

// From the frame of the pixel whose ray is (rx, ry, 1) to the camera's, (x + rx z, y + ry z, z);
// over its trace.
template <class Real>
[[gnu::always_inline]] VPM_HD inline Symmetric3<float> covariance_in_camera(
    const Symmetric3<Real>& m, const PixelScale<Real>& scale, Real rx, Real ry) {
  const Real x = scale.x * scale.z * m.xz, y = scale.y * scale.z * m.yz,
             zz = scale.z * scale.z * m.zz, xz = x + rx * zz, yz = y + ry * zz;
  return over_trace<Real>({scale.x * scale.x * m.xx + rx * (x + xz),
                           scale.x * scale.y * m.xy + (ry * x + rx * yz), xz,
                           scale.y * scale.y * m.yy + ry * (y + yz), yz, zz});
}

// Of gated windows: sums of 1, z, v z, z^2, v z^2 and v^2 z^2 over what is kept of a column, from
// its least dv on; then over columns, in the order of their planes' sums.
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
[[gnu::always_inline]] VPM_HD inline MomentsOf<Real> moments_of_column(const KeptDepths<Real>& c,
                                                                       double du) {
  return {c.n, du * c.z, c.vz, c.z, du * du * c.z2, du * c.vz2, du * c.z2, c.vvz2, c.vz2, c.z2};
}

// Of windows that are not gated, in floats: sums of what depth differs from that of a pixel, w, so
// that its digits are kept, and of v^2 z^2.
//
// Of a column, about its pixel beside the window's centre.
template <class Real>
struct ColumnOffsets {
  Real w{}, vw{}, w2{}, vw2{}, vvz2{};
};
template <class Real>
[[gnu::always_inline]] VPM_HD inline void add_offset_rows(const Real& below, const Real& above,
                                                          const Real& reference, float distance,
                                                          ColumnOffsets<Real>& c) {
  const Real b = below - reference, a = above - reference, b2 = b * b, a2 = a * a;
  c.w += b + a, c.w2 += b2 + a2;
  add_times<Real>(distance, b - a, c.vw), add_times<Real>(distance, b2 - a2, c.vw2);
  add_times<Real>(distance * distance, below * below + above * above, c.vvz2);
}
// at(dv): the depth, from the window's centre on.
template <class Real, class At>
[[gnu::always_inline]] VPM_HD inline ColumnOffsets<Real> offsets_of_rows(Span down, const At& at) {
  ColumnOffsets<Real> c;
  const Real reference = at(0);
  for_pairs(
      down,
      [&](int dv) __attribute__((always_inline)) {
        c.w = at(dv) - reference;
        c.w2 = c.w * c.w;
      },
      [&](int below, int above, float distance) __attribute__((always_inline)) {
        add_offset_rows<Real>(at(below), at(above), reference, distance, c);
      });
  return c;
}
// About the window's centre instead. `offset`: how much the pixel beside it differs from that one.
template <class Real>
[[gnu::always_inline]] VPM_HD inline ColumnOffsets<Real> about_centre(const ColumnOffsets<Real>& c,
                                                                      const Real& offset,
                                                                      float rows) {
  const Real w = c.w + rows * offset;
  return {w, c.vw, c.w2 + offset * (c.w + w), c.vw2 + offset * (c.vw + c.vw), c.vvz2};
}

// Of a window. Begins with the middle one of an odd number of columns.
template <class Real>
struct WindowOffsets {
  Real w{}, uw{}, vw{}, uuw{}, uvw{}, w2{}, uw2{}, vw2{}, uuw2{}, uvw2{}, vvz2{};
};
template <class Real>
[[gnu::always_inline]] VPM_HD inline WindowOffsets<Real> begin_with(
    const ColumnOffsets<Real>& middle) {
  return {.w = middle.w, .vw = middle.vw, .w2 = middle.w2, .vw2 = middle.vw2, .vvz2 = middle.vvz2};
}
template <class Real>
[[gnu::always_inline]] VPM_HD inline void add_offset_columns(const ColumnOffsets<Real>& right,
                                                             const ColumnOffsets<Real>& left,
                                                             float distance,
                                                             WindowOffsets<Real>& sums) {
  const Real w = right.w + left.w, w2 = right.w2 + left.w2;
  const float square = distance * distance;
  sums.w += w, sums.w2 += w2;
  add_times<Real>(distance, right.w - left.w, sums.uw), add_times<Real>(square, w, sums.uuw);
  add_times<Real>(distance, right.w2 - left.w2, sums.uw2), add_times<Real>(square, w2, sums.uuw2);
  sums.vw += right.vw + left.vw, sums.vw2 += right.vw2 + left.vw2;
  add_times<Real>(distance, right.vw - left.vw, sums.uvw);
  add_times<Real>(distance, right.vw2 - left.vw2, sums.uvw2);
  sums.vvz2 += right.vvz2 + left.vvz2;
}
// column(du) is about the centre.
template <class Column>
[[gnu::always_inline]] VPM_HD inline WindowOffsets<float> offsets_of_columns(Span across,
                                                                             const Column& column) {
  WindowOffsets<float> sums;
  for_pairs(
      across, [&](int du) __attribute__((always_inline)) { sums = begin_with<float>(column(du)); },
      [&](int right, int left, float distance) __attribute__((always_inline)) {
        add_offset_columns<float>(column(right), column(left), distance, sums);
      });
  return sums;
}

// Moments where z is relative to the centre's, and minus 1 in z itself. `inverse`: the centre's.
template <class Real>
[[gnu::always_inline]] VPM_HD inline MomentsOf<Real> moments_of_offsets(
    const WindowOffsets<Real>& s, const Real& inverse, const WindowShape& shape) {
  return {shape.count,
          s.uw * inverse,
          s.vw * inverse,
          s.w * inverse,
          shape.squares + (s.uuw + s.uuw + s.uuw2 * inverse) * inverse,
          (s.uvw + s.uvw + s.uvw2 * inverse) * inverse,
          (s.uw + s.uw2 * inverse) * inverse,
          s.vvz2 * inverse * inverse,
          (s.vw + s.vw2 * inverse) * inverse,
          s.w2 * inverse * inverse};
}

// The same from either sums.
[[gnu::always_inline]] VPM_HD inline Symmetric3<float> covariance_of_moments(
    const Moments& m, const PixelScale<double>& scale, double rx, double ry) {
  return covariance_in_camera(centred(m, quotient(1.0, m.n)), scale, rx, ry);
}
[[gnu::always_inline]] VPM_HD inline Symmetric3<float> covariance_of_offsets(
    const WindowOffsets<float>& s, float inverse, const WindowShape& shape,
    const PixelScale<float>& scale, float rx, float ry) {
  return covariance_in_camera(centred(moments_of_offsets(s, inverse, shape), shape.per_count),
                              scale, rx, ry);
}
// Of a window that the image's border cuts: its frame is that of its middle.
[[gnu::always_inline]] VPM_HD inline Symmetric3<float> covariance_of_cut_window(
    const WindowOffsets<float>& s, float inverse, const WindowShape& shape,
    const PixelScale<float>& scale, float rx, float ry) {
  return covariance_of_offsets(s, inverse, shape, scale, rx + shape.u * quotient(scale.x, scale.z),
                               ry + shape.v * quotient(scale.y, scale.z));
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
[[gnu::always_inline]] VPM_HD inline Vec3f normal_of_covariance(const Symmetric3<float>& covariance,
                                                                float rx, float ry) {
  return normal_of_covariance(covariance, smallest_root(characteristic_of(covariance)), rx, ry);
}
}  // namespace vpm
