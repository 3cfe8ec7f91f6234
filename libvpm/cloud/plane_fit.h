// The arithmetic of normals: from a window's sums to a unit vector. IEEE operations and square
// roots only, in a written order, so that every compiler and device gives the same bits. Inlined
// without exception, since a call inside a loop over pixels keeps compilers from making vector
// code.
//
// Real: float or double, or a vector of such (core/lanes.h).
#pragma once

#include <type_traits>

#include "libvpm/cloud/camera.h"
#include "libvpm/cloud/window_span.h"

namespace vpm {

// Sums of the inverse depth s, and of it times the offset from the middle: in a column; in a
// window. They are made of differences from the centre, whose digits floats keep.
template <class Real>
struct PlaneColumn {
  Real s{}, vs{};
};
template <class Real>
struct PlaneWindow {
  Real s{}, us{}, vs{};
};

// Down a column, from its pixel beside the window's centre on. What stands there for pixels beyond
// the image is the same as that.
template <class Real>
struct PlaneRows {
  Real centre{}, off{}, v_off{};

  [[gnu::always_inline]] VPM_HD void add(const Real& below, const Real& above, float distance) {
    const Real b = below - centre, a = above - centre;
    off += b + a;
    add_times<Real>(distance, b - a, v_off);
  }
  template <class Down>
  [[gnu::always_inline]] VPM_HD PlaneColumn<Real> sums(const Down& down) const {
    return {off + static_cast<float>(down.count()) * centre, down.about_middle(v_off, off)};
  }
};
// at(dv): of the pixels that there are.
template <class Real, class Down, class At>
[[gnu::always_inline]] VPM_HD inline PlaneColumn<Real> sum_rows(const Down& down, int radius,
                                                                const At& at) {
  PlaneRows<Real> rows{.centre = at(0)};
  const auto held = [&](int dv) __attribute__((always_inline)) {
    return down.has(dv) ? at(dv) : rows.centre;
  };
#ifdef __CUDA_ARCH__
#pragma unroll
#endif
  for (int d = 1; d <= radius; ++d) rows.add(held(d), held(-d), static_cast<float>(d));
  return rows.sums(down);
}
// Across, likewise; the columns that stand there have no v s.
template <class Real>
struct PlaneColumns {
  Real centre, off{}, u_off{}, vs;

  [[gnu::always_inline]] VPM_HD explicit PlaneColumns(const PlaneColumn<Real>& column)
      : centre(column.s), vs(column.vs) {}
  [[gnu::always_inline]] VPM_HD void add(const PlaneColumn<Real>& right,
                                         const PlaneColumn<Real>& left, float distance) {
    const Real r = right.s - centre, l = left.s - centre;
    off += r + l;
    add_times<Real>(distance, r - l, u_off);
    vs += right.vs + left.vs;
  }
  template <class Across>
  [[gnu::always_inline]] VPM_HD PlaneWindow<Real> sums(const Across& across) const {
    return {off + static_cast<float>(across.count()) * centre, across.about_middle(u_off, off), vs};
  }
};
// column(du): of those that there are.
template <class Real, class Across, class Column>
[[gnu::always_inline]] VPM_HD inline PlaneWindow<Real> sum_columns(const Across& across, int radius,
                                                                   const Column& column) {
  PlaneColumns<Real> sums(column(0));
  const auto held = [&](int du) __attribute__((always_inline)) {
    return across.has(du) ? column(du) : PlaneColumn<Real>{sums.centre, {}};
  };
#ifdef __CUDA_ARCH__
#pragma unroll
#endif
  for (int d = 1; d <= radius; ++d) sums.add(held(d), held(-d), static_cast<float>(d));
  return sums.sums(across);
}

// The normal towards the sensor of the plane whose inverse depth is a du + b dv + c at the offset
// (du, dv) from pixel (u, v): with u = fx X/Z + cx the plane is
// a fx X + b fy Y + (a (cx - u) + b (cy - v) + c) Z = 1.
struct PlaneSlopes {
  float a, b, c;
};

[[gnu::always_inline]] VPM_HD inline Vec3f normal_of_plane(const PlaneSlopes& plane, float fx,
                                                           float fy, float du_axis, float dv_axis) {
  const float x = plane.a * fx, y = plane.b * fy;
  const float z = plane.a * du_axis + plane.b * dv_axis + plane.c;
  const float scale = -reciprocal(square_root(x * x + y * y + z * z));
  return {x * scale, y * scale, z * scale};
}

// The slopes by a window's sums, and the height in its middle, relative to the inverse depth of its
// centre.
[[gnu::always_inline]] VPM_HD inline PlaneSlopes plane_of_sums(const WindowShape& shape,
                                                               const PlaneWindow<float>& sums,
                                                               float centre) {
  const float unit = reciprocal(centre);
  return {sums.us * shape.per_us * unit, sums.vs * shape.per_vs * unit,
          sums.s * shape.per_count * unit};
}
// Zero where the plane, wild without an edge gate, is behind the sensor at the centre of a window
// that the image's border cuts: it says nothing.
[[gnu::always_inline]] VPM_HD inline Vec3f normal_of_smooth_window(const WindowShape& shape,
                                                                   const PlaneSlopes& plane,
                                                                   float fx, float fy,
                                                                   float du_axis, float dv_axis) {
  const bool found = plane.c - (plane.a * shape.u + plane.b * shape.v) > 0;
  const Vec3f n = normal_of_plane(plane, fx, fy, du_axis - shape.u, dv_axis - shape.v);
  return {found ? n.x : 0, found ? n.y : 0, found ? n.z : 0};
}

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

// Columns of a gated window are added pairwise, eight at a time; those that it does not have are 0.
inline constexpr int kFoldedColumns = 8;
template <class Sums>
[[gnu::always_inline]] VPM_HD inline Sums fold(const Sums* c) {
  return ((c[0] + c[4]) + (c[2] + c[6])) + ((c[1] + c[5]) + (c[3] + c[7]));
}

// Sums over the pixels that are kept of 1, du, dv, their products, the difference and its products.
template <class Real>
struct SumsOfPlane {
  Real n{}, u{}, v{}, uu{}, uv{}, vv{}, e{}, ue{}, ve{};
};

// Inverse depth relative to the centre's, minus 1: c + a du + b dv; 0 where it is not found, since
// too few pixels remain, or they lie on a line.
template <class Real>
struct FittedPlane {
  using Mask = decltype(Real() < Real());
  Mask found{};
  Real a{}, b{}, c{};
};
using WindowPlane = FittedPlane<float>;

// Devices have none of the vectors.
template <class Real>
[[gnu::always_inline]] VPM_HD inline Real one_over(const Real& a) {
  if constexpr (std::is_same_v<Real, float>)
    return quotient(1.0F, a);
  else
    return 1.0F / a;
}

template <class Real>
[[gnu::always_inline]] VPM_HD inline FittedPlane<Real> fit_plane(const SumsOfPlane<Real>& s) {
  // Moments about the pixels' mean, times n: of points on a line, both products are the same.
  const Real uu = s.n * s.uu - s.u * s.u, uv = s.n * s.uv - s.u * s.v, vv = s.n * s.vv - s.v * s.v;
  const Real determinant = uu * vv - uv * uv;
  const auto found = static_cast<typename FittedPlane<Real>::Mask>(
      (s.n >= float{kMinSupport}) & (determinant >= kMinSpread * s.n * s.n * (uu + vv)));
  const Real ue = s.n * s.ue - s.u * s.e, ve = s.n * s.ve - s.v * s.e;
  const Real both = one_over<Real>(determinant * s.n);  // one division instead of two
  const Real unit = both * s.n, per_n = both * determinant;
  const Real a = (ue * vv - ve * uv) * unit;
  const Real b = (ve * uu - ue * uv) * unit;
  const Real c = (s.e - a * s.u - b * s.v) * per_n;
  return {found, found ? a : Real{}, found ? b : Real{}, found ? c : Real{}};
}

// Zero where no plane was found. An extrapolated plane may pass behind the sensor's centre: it says
// nothing either.
[[gnu::always_inline]] VPM_HD inline Vec3f normal_of_window(const WindowPlane& plane, float fx,
                                                            float fy, float du_axis,
                                                            float dv_axis) {
  const float height = 1 + plane.c;
  const bool found = plane.found & (height > 0);
  const Vec3f n = normal_of_plane({plane.a, plane.b, height}, fx, fy, du_axis, dv_axis);
  return {found ? n.x : 0, found ? n.y : 0, found ? n.z : 0};
}

}  // namespace vpm
