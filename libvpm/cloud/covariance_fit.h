// Arithmetic of normals by principal components: from a window's sums to a unit vector, under the
// rules of plane_fit.h.
#pragma once

#include "libvpm/cloud/camera.h"
#include "libvpm/cloud/window_span.h"

namespace vpm {

// Upper triangle of a symmetric 3x3 matrix.
template <class Real>
struct Symmetric3 {
  Real xx, xy, xz, yy, yz, zz;
};

// Limits Newton's steps to the smallest root of the characteristic polynomial. Each doubles the
// digits: floats need one step if the two small eigenvalues are as 1 to 8, three if as 1 to 2, and
// eight unless they nearly coincide.
inline constexpr int kEigenSteps = 8;

// Thresholds for a matrix of trace 1 in floats. Values of the polynomial below kRootNoise are
// rounding noise. Where the eigenvector's squared length, before it is normalised, is below
// kEigenNoise, the two small eigenvalues nearly coincide (points on a line), and its direction may
// be off by more than 0.01.
inline constexpr float kRootNoise = 0x1p-60F, kEigenNoise = 1e-10F;

// Characteristic polynomial x^3 - x^2 + minors x - determinant. It is concave and increasing up to
// a little beyond its smallest root, which is the one sought.
struct Characteristic {
  float minors, determinant;

  // Returns a first guess of the smallest root, which neglects the cube and terms of third order in
  // determinant / minors^2.
  [[gnu::always_inline]] VPM_HD inline float guess() const {
    const float rest = minors * minors - determinant;
    const float top = determinant > kRootNoise ? determinant * minors : 0.0F;
    return quotient(top, rest > kRootNoise ? rest : 1.0F);
  }
  // Returns Newton's step, to be subtracted from x. From the second step on, none passes the root
  // and none is positive.
  [[gnu::always_inline]] VPM_HD inline float step(float x) const {
    const float value = ((x - 1) * x + minors) * x - determinant;
    const float slope = (3 * x - 2) * x + minors;
    const bool is_noise = (value <= kRootNoise) & (value >= -kRootNoise);
    return quotient(is_noise ? 0.0F : value, slope > kRootNoise ? slope : 1.0F);
  }
  // True if floats hold nothing of the error that remains after this step, which is step^2 /
  // minors.
  [[gnu::always_inline]] VPM_HD inline bool is_last(float step) const {
    const float most = kLastStep * minors;
    return (step <= most) & (step >= -most);
  }

 private:
  static constexpr float kLastStep = 0x1p-12F;
};

// Finds the smallest roots of `Count` polynomials at once, each with the bits that it has alone.
// One loop for all lets compilers emit vector code and a GPU overlap two.
template <int Count>
[[gnu::always_inline]] VPM_HD inline void find_smallest_roots(const float (&minors)[Count],
                                                              const float (&determinants)[Count],
                                                              float (&roots)[Count]) {
  int is_moving[Count], are_moving = 1;
  for (int i = 0; i < Count; ++i) {
    roots[i] = Characteristic{minors[i], determinants[i]}.guess();
    is_moving[i] = 1;
  }
#ifdef __CUDA_ARCH__
#pragma unroll 1  // most loops end after one step
#endif
  for (int k = 0; k < kEigenSteps && are_moving != 0; ++k) {
    are_moving = 0;
    for (int i = 0; i < Count; ++i) {
      const Characteristic polynomial{minors[i], determinants[i]};
      const float by = polynomial.step(roots[i]);
      roots[i] -= is_moving[i] != 0 ? by : 0.0F;
      is_moving[i] &= polynomial.is_last(by) ? 0 : 1;
      are_moving |= is_moving[i];
    }
  }
}

// Returns a positive semidefinite matrix divided by its trace. In floats it then gives the normal
// of a plane to some 1e-6, divided by the second eigenvalue's part of the trace.
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

// Returns the unit eigenvector of the smallest eigenvalue `root`, towards the sensor; zero if there
// is no single one. Each row of the adjugate of m - root I is a multiple of it; the row with the
// greatest diagonal entry is the longest. No smallest eigenvalue exceeds `minors`, so a root above
// that is noise.
[[gnu::always_inline]] VPM_HD inline Vec3f normal_of_covariance(const Symmetric3<float>& m,
                                                                float minors, float root, float rx,
                                                                float ry) {
  const float x = m.xx - root, y = m.yy - root, z = m.zz - root;
  const float xx = y * z - m.yz * m.yz, yy = x * z - m.xz * m.xz, zz = x * y - m.xy * m.xy;
  const float xy = m.xz * m.yz - m.xy * z, xz = m.xy * m.yz - m.xz * y, yz = m.xy * m.xz - m.yz * x;
  const bool use_y = yy > xx, use_z = zz > (use_y ? yy : xx);
  const Vec3f n{use_z   ? xz
                : use_y ? xy
                        : xx,
                use_z   ? yz
                : use_y ? yy
                        : xy,
                use_z   ? zz
                : use_y ? yz
                        : xz};
  const float squared = n.x * n.x + n.y * n.y + n.z * n.z;
  const bool found = (squared > kEigenNoise) & (root <= minors) & (root >= -minors);
  const float away = n.x * rx + n.y * ry + n.z;
  const float unit = reciprocal(square_root(found ? squared : 1.0F));
  const float scale = found ? (away > 0 ? -unit : unit) : 0.0F;
  return {scale * n.x, scale * n.y, scale * n.z};
}
// Finds the normals of `Count` windows with central rays (rx[0], ry, 1), (rx[1], ry, 1), ... and
// calls take(i, normal) for each. covariance(i) returns a window's covariance over its trace.
template <int Count, class Covariance, class Take>
[[gnu::always_inline]] VPM_HD inline void find_normals_of(const Covariance& covariance,
                                                          const float* rx, float ry,
                                                          const Take& take) {
  float minors[Count], determinants[Count], roots[Count];
  for (int i = 0; i < Count; ++i) {
    const Characteristic polynomial = characteristic_of(covariance(i));
    minors[i] = polynomial.minors, determinants[i] = polynomial.determinant;
  }
  find_smallest_roots(minors, determinants, roots);
  for (int i = 0; i < Count; ++i)
    take(i, normal_of_covariance(covariance(i), minors[i], roots[i], rx[i], ry));
}
[[gnu::always_inline]] VPM_HD inline Vec3f normal_of_covariance(const Symmetric3<float>& covariance,
                                                                float rx, float ry) {
  Vec3f normal;
  find_normals_of<1>([&](int) { return covariance; }, &rx, ry,
                     [&](int, const Vec3f& found) { normal = found; });
  return normal;
}

// Moments of a window's points in the affine frame of its centre, p = z (du, dv, 1), where they are
// weighted sums of z and z^2.
template <class Real>
struct MomentsOf {
  Real n{}, x{}, y{}, z{}, xx{}, xy{}, xz{}, yy{}, yz{}, zz{};
  [[gnu::always_inline]] VPM_HD inline MomentsOf operator+(const MomentsOf& b) const {
    return {n + b.n,   x + b.x,   y + b.y,   z + b.z,   xx + b.xx,
            xy + b.xy, xz + b.xz, yy + b.yy, yz + b.yz, zz + b.zz};
  }
};
using Moments = MomentsOf<double>;

// Returns the second moments about the mean, times n; `per_n` is 1 / m.n.
template <class Real>
[[gnu::always_inline]] VPM_HD inline Symmetric3<Real> centred(const MomentsOf<Real>& m,
                                                              Real per_n) {
  const Real x = m.x * per_n, y = m.y * per_n, z = m.z * per_n;
  return {m.xx - m.x * x, m.xy - m.x * y, m.xz - m.x * z,
          m.yy - m.y * y, m.yz - m.y * z, m.zz - m.z * z};
}

// Scale from the affine frame's axes to the camera's, up to a common factor.
template <class Real>
struct PixelScale {
  Real x, y, z;
};
[[gnu::always_inline]] VPM_HD inline PixelScale<double> pixel_scale(const Intrinsics& k) {
  return {1 / k.fx, 1 / k.fy, 1};
}
// Returns the scale with x and y at most 1, so that no product leaves the range of floats when z is
// relative to the reference pixel's.
[[gnu::always_inline]] VPM_HD inline PixelScale<float> pixel_scale_in_floats(const Intrinsics& k) {
  const double least = k.fx < k.fy ? k.fx : k.fy;
  return {static_cast<float>(least / k.fx), static_cast<float>(least / k.fy),
          static_cast<float>(least)};
}

// Transforms a covariance from the affine frame of the pixel with ray (rx, ry, 1) to the camera's,
// (x + rx z, y + ry z, z), and divides it by its trace.
template <class Real>
[[gnu::always_inline]] VPM_HD inline Symmetric3<float> covariance_in_camera(
    const Symmetric3<Real>& m, const PixelScale<Real>& scale, Real rx, Real ry) {
  const Real x = scale.x * scale.z * m.xz, y = scale.y * scale.z * m.yz,
             zz = scale.z * scale.z * m.zz, xz = x + rx * zz, yz = y + ry * zz;
  return over_trace<Real>({scale.x * scale.x * m.xx + rx * (x + xz),
                           scale.x * scale.y * m.xy + (ry * x + rx * yz), xz,
                           scale.y * scale.y * m.yy + ry * (y + yz), yz, zz});
}

// Sums of 1, z, v z, z^2, v z^2 and v^2 z^2 over the kept pixels of a column of a gated window,
// added from the least dv on. Columns are then added in the order of fold().
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

// Sums down a column of an ungated window, in floats. To keep digits they hold w, the depth minus
// that of a reference pixel: here the column's pixel in the row of the window's centre. Offsets are
// from the window's centre.
template <class Real>
struct ColumnOffsets {
  Real w{}, vw{}, w2{}, vw2{}, vvz2{};
};
// Accumulates a column outwards from its reference pixel. Pixels beyond the image must be given as
// equal to the reference; they add nothing to v^2 z^2.
template <class Real>
struct OffsetRows {
  Real reference{};
  ColumnOffsets<Real> sums{};

  [[gnu::always_inline]] VPM_HD void add(const Real& below, const Real& above, bool has_below,
                                         bool has_above, float distance) {
    const Real b = below - reference, a = above - reference, b2 = b * b, a2 = a * a;
    sums.w += b + a, sums.w2 += b2 + a2;
    add_times<Real>(distance, b - a, sums.vw), add_times<Real>(distance, b2 - a2, sums.vw2);
    add_times<Real>(distance * distance,
                    (has_below ? below * below : Real{}) + (has_above ? above * above : Real{}),
                    sums.vvz2);
  }
};
// Sums a column; at(dv) returns the depth of each of its pixels inside the image.
template <class Real, class Down, class At>
[[gnu::always_inline]] VPM_HD inline ColumnOffsets<Real> sum_offset_rows(const Down& down,
                                                                         int radius, const At& at) {
  OffsetRows<Real> rows{.reference = at(0)};
  const auto held = [&](int dv) __attribute__((always_inline)) {
    return down.has(dv) ? at(dv) : rows.reference;
  };
#ifdef __CUDA_ARCH__
#pragma unroll
#endif
  for (int d = 1; d <= radius; ++d)
    rows.add(held(d), held(-d), down.has(d), down.has(-d), static_cast<float>(d));
  return rows.sums;
}
// Returns the column of a window's reference pixel. Two neighbouring pixels have the same one, so
// that they share the sums of columns.
[[gnu::always_inline]] VPM_HD inline int reference_of(int u) {
  return u & ~1;
}
// Returns the sums of a column about the window's reference pixel; `offset` is the depth of the
// column's own pixel minus the reference's.
template <class Real, class Down>
[[gnu::always_inline]] VPM_HD inline ColumnOffsets<Real> about_reference(
    const ColumnOffsets<Real>& c, const Real& offset, const Down& down) {
  const Real w = c.w + static_cast<float>(down.count()) * offset;
  const Real vw = down.with_greater(c.vw, offset);
  return {w, vw, c.w2 + offset * (c.w + w), c.vw2 + offset * (c.vw + vw), c.vvz2};
}

// Sums over an ungated window, about its reference pixel.
template <class Real>
struct WindowOffsets {
  Real w{}, uw{}, vw{}, uuw{}, uvw{}, w2{}, uw2{}, vw2{}, uuw2{}, uvw2{}, vvz2{};

  [[gnu::always_inline]] VPM_HD void add(const ColumnOffsets<Real>& right,
                                         const ColumnOffsets<Real>& left, float distance) {
    const Real one = right.w + left.w, two = right.w2 + left.w2;
    const float square = distance * distance;
    w += one, w2 += two;
    add_times<Real>(distance, right.w - left.w, uw), add_times<Real>(square, one, uuw);
    add_times<Real>(distance, right.w2 - left.w2, uw2), add_times<Real>(square, two, uuw2);
    vw += right.vw + left.vw, vw2 += right.vw2 + left.vw2;
    add_times<Real>(distance, right.vw - left.vw, uvw);
    add_times<Real>(distance, right.vw2 - left.vw2, uvw2);
    vvz2 += right.vvz2 + left.vvz2;
  }
};
// Sums a window; column(du) returns the sums of each column inside the image, about the reference
// pixel.
template <class Real, class Across, class Column>
[[gnu::always_inline]] VPM_HD inline WindowOffsets<Real> sum_offset_columns(const Across& across,
                                                                            int radius,
                                                                            const Column& column) {
  const auto held = [&](int du) __attribute__((always_inline)) {
    return across.has(du) ? column(du) : ColumnOffsets<Real>{};
  };
  const ColumnOffsets<Real> middle = column(0);
  WindowOffsets<Real> sums{
      .w = middle.w, .vw = middle.vw, .w2 = middle.w2, .vw2 = middle.vw2, .vvz2 = middle.vvz2};
#ifdef __CUDA_ARCH__
#pragma unroll
#endif
  for (int d = 1; d <= radius; ++d) sums.add(held(d), held(-d), static_cast<float>(d));
  return sums;
}

// Returns moments with z relative to the reference's depth (for z itself, minus 1); `inverse` is 1
// / that depth.
[[gnu::always_inline]] VPM_HD inline MomentsOf<float> moments_of_offsets(
    const WindowOffsets<float>& s, float inverse, const WindowShape& shape) {
  return {shape.count,
          shape.du + s.uw * inverse,
          shape.dv + s.vw * inverse,
          s.w * inverse,
          shape.dudu + (s.uuw + s.uuw + s.uuw2 * inverse) * inverse,
          shape.dudv + (s.uvw + s.uvw + s.uvw2 * inverse) * inverse,
          (s.uw + s.uw2 * inverse) * inverse,
          s.vvz2 * inverse * inverse,
          (s.vw + s.vw2 * inverse) * inverse,
          s.w2 * inverse * inverse};
}

// Return the covariance in camera axes over its trace, from moments of a gated window or from
// offsets of an ungated one.
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

}  // namespace vpm
